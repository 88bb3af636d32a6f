#pragma once
/// The little of HDF5 that records need, with errors as exceptions that name the file. Private to
/// the library; the types of HDF5 do not appear outside it.

#include "scene/atomic_file.hpp"

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace sprung::hdf5 {

/// Owns one HDF5 identifier.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  Handle(Handle&& other) noexcept;
  Handle& operator=(Handle&& other) noexcept;
  ~Handle() { reset(); }
  hid_t get() const { return id_; }
  bool valid() const { return id_ >= 0; }
  /// False if HDF5 reports that closing failed.
  bool reset();

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Keeps HDF5 from printing its own error stack while it lives.
class QuietErrors {
 public:
  QuietErrors();
  ~QuietErrors();
  QuietErrors(const QuietErrors&) = delete;
  QuietErrors& operator=(const QuietErrors&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

using Shape = std::vector<hsize_t>;

/// A new file at its ".part" place; commit() closes it and moves it to its own. Objects are named
/// by their path in the file ("/series/tip"); groups on the way are made. Two files of the same
/// content are the same bytes: no times are stored.
class Output {
 public:
  explicit Output(const std::filesystem::path& file);
  void group(const std::string& path);
  void write(const std::string& path, std::span<const double> values, const Shape& shape);
  void write(const std::string& path, std::span<const std::int64_t> values, const Shape& shape);
  void write(const std::string& path, std::span<const std::uint8_t> values, const Shape& shape);
  void attribute(const std::string& path, const std::string& name, double value);
  void attribute(const std::string& path, const std::string& name, const std::string& text);
  void attribute(const std::string& path, const std::string& name,
                 const std::vector<std::string>& texts);
  void attribute(const std::string& path, const std::string& name,
                 const std::vector<std::int64_t>& values);
  /// A text of fixed length, as some readers ask for.
  void fixed_attribute(const std::string& path, const std::string& name, const std::string& text);
  /// A second name, `path`, of the dataset `target` of this file.
  void alias(const std::string& path, const std::string& target);
  /// A link at `path` to the root of the file `target`, given relative to this file's folder.
  void link(const std::string& path, const std::string& target);
  void commit();

 private:
  void write(const std::string& path, hid_t type, const void* values, std::size_t count,
             const Shape& shape);
  void write_attribute(const std::string& path, const std::string& name, const Handle& type,
                       const Handle& space, const void* values);
  [[noreturn]] void fail(const std::string& what) const;

  QuietErrors quiet_;
  AtomicFile target_;
  Handle file_;
};

/// An existing file, for reading. Throws std::runtime_error naming the file if it is missing or
/// damaged.
class Input {
 public:
  explicit Input(const std::filesystem::path& file);
  bool has(const std::string& path) const;
  /// Names in a group, ascending; links that lead nowhere included.
  std::vector<std::string> names(const std::string& group) const;
  bool is_group(const std::string& path) const;
  bool is_integer(const std::string& path) const;
  Shape shape(const std::string& path) const;
  std::vector<double> doubles(const std::string& path) const;
  std::vector<std::int64_t> integers(const std::string& path) const;
  double number(const std::string& path, const std::string& attribute) const;
  std::vector<std::string> texts(const std::string& path, const std::string& attribute) const;
  [[noreturn]] void fail(const std::string& what) const;

 private:
  Handle dataset(const std::string& path) const;
  Handle attribute(const std::string& path, const std::string& name) const;

  QuietErrors quiet_;
  std::filesystem::path name_;
  Handle file_;
};

}  // namespace sprung::hdf5
