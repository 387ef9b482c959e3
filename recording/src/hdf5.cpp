// SPDX-License-Identifier: Apache-2.0
#include "hdf5.hpp"

namespace rths::recording {
namespace {

Handle text_type(std::size_t size) {
  Handle type{H5Tcopy(H5T_C_S1), H5Tclose, "HDF5 text type"};
  check(H5Tset_size(type.id(), size), "HDF5 text size");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "HDF5 text encoding");
  return type;
}

// HDF5 has no empty fixed-length text; one zero byte represents it.
std::size_t stored_size(const std::string& text) { return text.empty() ? 1 : text.size(); }

std::string trimmed(std::string text) {
  text.resize(text.find_last_not_of('\0') + 1);
  return text;
}

// Bytes of one text of fixed length.
std::size_t text_size(const Handle& type, const Handle& space, const std::string& name) {
  if (H5Tget_class(type.id()) != H5T_STRING || H5Tis_variable_str(type.id()) != 0 ||
      H5Sget_simple_extent_npoints(space.id()) != 1)
    throw Error{name + " is no text of fixed length"};
  return H5Tget_size(type.id());
}

}  // namespace

Handle without_lock() {
  Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "HDF5 properties"};
  check(H5Pset_file_locking(access.id(), false, true), "HDF5 properties");
  return access;
}

// A reader in SWMR mode reads metadata that a writer may be changing again, after a pause that
// doubles from 1 ns each time.
hid_t open_to_read(const std::filesystem::path& file, unsigned flags) {
  constexpr unsigned kAttempts = 28;  // a quarter of a second
  const Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "HDF5 properties"};
  const Handle lockless = without_lock();
  for (const Handle* properties : {&access, &lockless}) {
    if ((flags & H5F_ACC_SWMR_READ) != 0)
      check(H5Pset_metadata_read_attempts(properties->id(), kAttempts), "HDF5 properties");
    const hid_t opened = H5Fopen(file.c_str(), flags, properties->id());
    if (opened >= 0) return opened;
  }
  return -1;
}

void write_text_attribute(hid_t object, const std::string& name, const std::string& text) {
  const Handle type = text_type(stored_size(text));
  const Handle space{H5Screate(H5S_SCALAR), H5Sclose, "HDF5 space"};
  const Handle attribute{
      H5Acreate2(object, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      "creating attribute " + name};
  check(H5Awrite(attribute.id(), type.id(), text.c_str()), "writing attribute " + name);
}

void write_text_list_attribute(hid_t object, const std::string& name,
                               const std::vector<std::string>& texts) {
  Handle type{H5Tcopy(H5T_C_S1), H5Tclose, "HDF5 text type"};
  check(H5Tset_size(type.id(), H5T_VARIABLE), "HDF5 text size");
  check(H5Tset_cset(type.id(), H5T_CSET_UTF8), "HDF5 text encoding");
  const hsize_t count = texts.size();
  const Handle space{H5Screate_simple(1, &count, nullptr), H5Sclose, "HDF5 space"};
  const Handle attribute{
      H5Acreate2(object, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose,
      "creating attribute " + name};
  if (texts.empty()) return;
  std::vector<const char*> pointers;
  for (const auto& text : texts) pointers.push_back(text.c_str());
  check(H5Awrite(attribute.id(), type.id(), pointers.data()), "writing attribute " + name);
}

void write_text_dataset(hid_t group, const std::string& name, const std::string& text) {
  const Handle type = text_type(stored_size(text));
  const Handle space{H5Screate(H5S_SCALAR), H5Sclose, "HDF5 space"};
  const Handle dataset{
      H5Dcreate2(group, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, "creating dataset " + name};
  check(H5Dwrite(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.c_str()),
        "writing dataset " + name);
}

std::string read_text_attribute(hid_t object, const std::string& name) {
  const Handle attribute{H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                         "reading attribute " + name};
  const Handle type{H5Aget_type(attribute.id()), H5Tclose, "reading attribute " + name};
  const Handle space{H5Aget_space(attribute.id()), H5Sclose, "reading attribute " + name};
  std::string text(text_size(type, space, name), '\0');
  check(H5Aread(attribute.id(), type.id(), text.data()), "reading attribute " + name);
  return trimmed(text);
}

std::vector<std::string> read_text_list_attribute(hid_t object, const std::string& name) {
  const Handle attribute{H5Aopen(object, name.c_str(), H5P_DEFAULT), H5Aclose,
                         "reading attribute " + name};
  const Handle space{H5Aget_space(attribute.id()), H5Sclose, "reading attribute " + name};
  const Handle type{H5Aget_type(attribute.id()), H5Tclose, "reading attribute " + name};
  if (H5Tis_variable_str(type.id()) <= 0)
    throw Error{"attribute " + name + " is no list of texts of variable length"};
  std::vector<char*> pointers(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.id())));
  if (pointers.empty()) return {};
  check(H5Aread(attribute.id(), type.id(), pointers.data()), "reading attribute " + name);
  std::vector<std::string> texts;
  for (const char* text : pointers) texts.emplace_back(text == nullptr ? "" : text);
  H5Dvlen_reclaim(type.id(), space.id(), H5P_DEFAULT, pointers.data());
  return texts;
}

std::string read_text_dataset(hid_t group, const std::string& name) {
  const Handle dataset{H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose,
                       "reading dataset " + name};
  const Handle type{H5Dget_type(dataset.id()), H5Tclose, "reading dataset " + name};
  const Handle space{H5Dget_space(dataset.id()), H5Sclose, "reading dataset " + name};
  std::string text(text_size(type, space, name), '\0');
  check(H5Dread(dataset.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, text.data()),
        "reading dataset " + name);
  return trimmed(text);
}

}  // namespace rths::recording
