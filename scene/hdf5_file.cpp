#include "scene/hdf5_file.hpp"

#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace sprung::hdf5 {
namespace {

std::size_t element_count(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
}

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  return type;
}

Handle link_properties() {
  Handle properties(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  H5Pset_create_intermediate_group(properties.get(), 1);
  return properties;
}

}  // namespace

Handle::Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}

Handle& Handle::operator=(Handle&& other) noexcept {
  std::swap(id_, other.id_);
  std::swap(close_, other.close_);
  return *this;
}

bool Handle::reset() {
  const hid_t id = std::exchange(id_, -1);
  return id < 0 || close_(id) >= 0;
}

QuietErrors::QuietErrors() {
  H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

QuietErrors::~QuietErrors() {
  H5Eset_auto2(H5E_DEFAULT, function_, data_);
}

Output::Output(const std::filesystem::path& file)
    : target_(file),
      file_(H5Fcreate(target_.part().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose) {
  if (!file_.valid()) fail("cannot be created");
}

void Output::fail(const std::string& what) const {
  throw std::runtime_error(target_.place().string() + ": " + what +
                           "; check the folder's permissions and free space");
}

void Output::group(const std::string& path) {
  const Handle links = link_properties();
  const Handle group(H5Gcreate2(file_.get(), path.c_str(), links.get(), H5P_DEFAULT, H5P_DEFAULT),
                     H5Gclose);
  if (!group.valid()) fail("cannot hold the group " + path);
}

void Output::write(const std::string& path, std::span<const double> values, const Shape& shape) {
  write(path, H5T_NATIVE_DOUBLE, values.data(), values.size(), shape);
}

void Output::write(const std::string& path, std::span<const std::int64_t> values,
                   const Shape& shape) {
  write(path, H5T_NATIVE_INT64, values.data(), values.size(), shape);
}

void Output::write(const std::string& path, std::span<const std::uint8_t> values,
                   const Shape& shape) {
  write(path, H5T_NATIVE_UINT8, values.data(), values.size(), shape);
}

void Output::write(const std::string& path, hid_t type, const void* values, std::size_t count,
                   const Shape& shape) {
  if (element_count(shape) != count)
    throw std::logic_error(path + ": " + std::to_string(count) + " values do not fill their shape");
  const Handle links = link_properties();
  const Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  H5Pset_obj_track_times(properties.get(), false);
  const Handle space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                     H5Sclose);
  Handle data(H5Dcreate2(file_.get(), path.c_str(), type, space.get(), links.get(),
                         properties.get(), H5P_DEFAULT),
              H5Dclose);
  if (!data.valid()) fail("cannot hold " + path);
  if (count > 0 && H5Dwrite(data.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
    fail("cannot be written (" + path + ")");
  if (!data.reset()) fail("cannot be written (" + path + ")");
}

void Output::write_attribute(const std::string& path, const std::string& name, const Handle& type,
                             const Handle& space, const void* values) {
  const Handle object(H5Oopen(file_.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
  const Handle attribute(
      H5Acreate2(object.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose);
  if (!attribute.valid() || H5Awrite(attribute.get(), type.get(), values) < 0)
    fail("cannot hold the attribute " + name + " of " + path);
}

void Output::attribute(const std::string& path, const std::string& name, double value) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type(H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose);
  write_attribute(path, name, type, space, &value);
}

void Output::attribute(const std::string& path, const std::string& name, const std::string& text) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const char* pointer = text.c_str();
  write_attribute(path, name, text_type(), space, &pointer);
}

void Output::attribute(const std::string& path, const std::string& name,
                       const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const auto& text : texts) pointers.push_back(text.c_str());
  const hsize_t count = pointers.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  write_attribute(path, name, text_type(), space, pointers.data());
}

void Output::attribute(const std::string& path, const std::string& name,
                       const std::vector<std::int64_t>& values) {
  const hsize_t count = values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), H5Sclose);
  const Handle type(H5Tcopy(H5T_NATIVE_INT64), H5Tclose);
  write_attribute(path, name, type, space, values.data());
}

void Output::fixed_attribute(const std::string& path, const std::string& name,
                             const std::string& text) {
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), text.size());
  write_attribute(path, name, type, space, text.data());
}

void Output::alias(const std::string& path, const std::string& target) {
  const Handle links = link_properties();
  // A soft link: h5dump does not find a dataset of two hard names across an external link.
  if (H5Lcreate_soft(target.c_str(), file_.get(), path.c_str(), links.get(), H5P_DEFAULT) < 0)
    fail("cannot hold the link " + path);
}

void Output::link(const std::string& path, const std::string& target) {
  const Handle links = link_properties();
  if (H5Lcreate_external(target.c_str(), "/", file_.get(), path.c_str(), links.get(), H5P_DEFAULT) <
      0)
    fail("cannot hold the link " + path);
}

void Output::commit() {
  if (H5Fflush(file_.get(), H5F_SCOPE_GLOBAL) < 0 || !file_.reset()) fail("cannot be written");
  target_.commit();
}

Input::Input(const std::filesystem::path& file) : name_(file) {
  std::error_code error;
  if (!std::filesystem::exists(file, error))
    throw std::runtime_error(file.string() + ": is missing");
  file_ = Handle(H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
  if (!file_.valid()) throw std::runtime_error(file.string() + ": is damaged, or not an HDF5 file");
}

void Input::fail(const std::string& what) const {
  throw std::runtime_error(name_.string() +
                           ": is damaged, or not written by this program: " + what);
}

bool Input::has(const std::string& path) const {
  return H5Lexists(file_.get(), path.c_str(), H5P_DEFAULT) > 0;
}

std::vector<std::string> Input::names(const std::string& path) const {
  const Handle group(H5Gopen2(file_.get(), path.c_str(), H5P_DEFAULT), H5Gclose);
  if (!group.valid()) fail("no group " + path);
  std::vector<std::string> names;
  const H5L_iterate_t collect = [](hid_t, const char* name, const H5L_info_t*,
                                   void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->push_back(name);
    return 0;
  };
  if (H5Literate(group.get(), H5_INDEX_NAME, H5_ITER_INC, nullptr, collect, &names) < 0)
    fail("the group " + path + " cannot be read");
  return names;
}

bool Input::is_group(const std::string& path) const {
  const Handle object(H5Oopen(file_.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
  return object.valid() && H5Iget_type(object.get()) == H5I_GROUP;
}

Handle Input::dataset(const std::string& path) const {
  Handle data(H5Dopen2(file_.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  if (!data.valid()) fail("no array " + path);
  return data;
}

bool Input::is_integer(const std::string& path) const {
  const Handle data = dataset(path);
  const Handle type(H5Dget_type(data.get()), H5Tclose);
  return H5Tget_class(type.get()) == H5T_INTEGER;
}

Shape Input::shape(const std::string& path) const {
  const Handle data = dataset(path);
  const Handle space(H5Dget_space(data.get()), H5Sclose);
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) fail("the array " + path + " has no shape");
  Shape shape(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return shape;
}

std::vector<double> Input::doubles(const std::string& path) const {
  std::vector<double> values(element_count(shape(path)));
  const Handle data = dataset(path);
  if (H5Dread(data.get(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail("the array " + path + " cannot be read");
  return values;
}

std::vector<std::int64_t> Input::integers(const std::string& path) const {
  std::vector<std::int64_t> values(element_count(shape(path)));
  const Handle data = dataset(path);
  if (H5Dread(data.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
    fail("the array " + path + " cannot be read");
  return values;
}

Handle Input::attribute(const std::string& path, const std::string& name) const {
  Handle attribute(
      H5Aopen_by_name(file_.get(), path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!attribute.valid()) fail("no attribute " + name + " of " + path);
  return attribute;
}

double Input::number(const std::string& path, const std::string& name) const {
  const Handle at = attribute(path, name);
  double value = 0.0;
  if (H5Aread(at.get(), H5T_NATIVE_DOUBLE, &value) < 0)
    fail("the attribute " + name + " of " + path + " cannot be read");
  return value;
}

std::vector<std::string> Input::texts(const std::string& path, const std::string& name) const {
  const Handle at = attribute(path, name);
  const Handle space(H5Aget_space(at.get()), H5Sclose);
  const auto count = H5Sget_simple_extent_npoints(space.get());
  if (count < 0) fail("the attribute " + name + " of " + path + " has no shape");
  std::vector<char*> pointers(static_cast<std::size_t>(count), nullptr);
  const Handle type = text_type();
  if (H5Aread(at.get(), type.get(), pointers.data()) < 0)
    fail("the attribute " + name + " of " + path + " cannot be read");
  std::vector<std::string> texts(pointers.begin(), pointers.end());
  H5Dvlen_reclaim(type.get(), space.get(), H5P_DEFAULT, pointers.data());
  return texts;
}

}  // namespace sprung::hdf5
