#pragma once
/// Files that appear whole or not at all.

#include <filesystem>
#include <string>

namespace sprung {

/// A file under construction: written at part(), moved to its place by commit(). Without commit(),
/// the destructor removes what was written, and a file that stood at the place before is untouched.
class AtomicFile {
 public:
  explicit AtomicFile(std::filesystem::path place);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  const std::filesystem::path& place() const { return place_; }
  const std::filesystem::path& part() const { return part_; }
  /// Throws std::runtime_error naming the file.
  void commit();

 private:
  std::filesystem::path place_;
  std::filesystem::path part_;
  bool committed_ = false;
};

/// Writes `text` to `file` atomically. Throws std::runtime_error naming the file.
void write_text_file(const std::filesystem::path& file, const std::string& text);

/// The whole text of `file`. Throws std::runtime_error naming the file.
std::string read_text_file(const std::filesystem::path& file);

}  // namespace sprung
