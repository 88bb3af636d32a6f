#include "scene/atomic_file.hpp"

#include <fstream>
#include <sstream>
#include <stdexcept>

namespace sprung {

AtomicFile::AtomicFile(std::filesystem::path place) : place_(std::move(place)), part_(place_) {
  part_ += ".part";
}

AtomicFile::~AtomicFile() {
  std::error_code error;
  if (!committed_) std::filesystem::remove(part_, error);
}

void AtomicFile::commit() {
  std::error_code error;
  std::filesystem::rename(part_, place_, error);
  if (error)
    throw std::runtime_error(place_.string() + ": cannot be put in place (" + error.message() +
                             ")");
  committed_ = true;
}

void write_text_file(const std::filesystem::path& file, const std::string& text) {
  AtomicFile target(file);
  std::ofstream stream(target.part(), std::ios::binary);
  stream << text;
  stream.close();
  if (!stream)
    throw std::runtime_error(file.string() +
                             ": cannot be written; check the folder's permissions and free space");
  target.commit();
}

std::string read_text_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (stream) text << stream.rdbuf();
  if (!stream) throw std::runtime_error(file.string() + ": is missing or cannot be read");
  return text.str();
}

}  // namespace sprung
