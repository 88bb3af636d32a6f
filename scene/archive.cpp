#include "scene/hdf5_file.hpp"
#include "scene/record.hpp"

namespace sprung {

void write_archive(const std::filesystem::path& file, const Archive& archive) {
  hdf5::Output output(file);
  for (const auto& [name, array] : archive)
    std::visit([&](const auto& values) { output.write(name, values, {values.size()}); }, array);
  output.commit();
}

namespace {

void read_group(const hdf5::Input& input, const std::string& group, Archive& archive) {
  for (const auto& name : input.names(group)) {
    const std::string path = group == "/" ? "/" + name : group + "/" + name;
    if (input.is_group(path))
      read_group(input, path, archive);
    else if (input.is_integer(path))
      archive[path.substr(1)] = input.integers(path);
    else
      archive[path.substr(1)] = input.doubles(path);
  }
}

}  // namespace

Archive read_archive(const std::filesystem::path& file) {
  const hdf5::Input input(file);
  Archive archive;
  read_group(input, "/", archive);
  return archive;
}

}  // namespace sprung
