// SPDX-License-Identifier: Apache-2.0
#include <memory>
#include <optional>
#include <vector>

#include <rths/recording/recording.hpp>

#include "hdf5.hpp"
#include "probe.hpp"
#include "table_formats.hpp"

namespace rths::recording {
namespace {

constexpr std::size_t kMostDimensions = 2;
constexpr hsize_t kMostValues = hsize_t{1} << 31U;  // of a dataset

Columns own_recording(const Reader& reader) {
  Columns columns{{"time", reader.time(), ""}};
  for (const auto& name : reader.names()) columns.push_back({name, reader.signal(name), ""});
  return columns;
}

bool is_number(hid_t type) {
  const auto kind = H5Tget_class(type);
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

/// A dataset, or a member of its compounds, with this many values per element.
struct Member {
  std::string name;  ///< empty: the dataset is no compound
  hsize_t width = 1;
};

// The memory type of a member alone. Numbers, and lists of them, can be read.
Handle type_in_memory(const Member& member) {
  Handle number{H5Tcopy(H5T_NATIVE_DOUBLE), H5Tclose, "HDF5 type"};
  if (member.width > 1)
    number = Handle{H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, &member.width), H5Tclose, "HDF5 type"};
  if (member.name.empty()) return number;
  Handle compound{H5Tcreate(H5T_COMPOUND, member.width * sizeof(double)), H5Tclose, "HDF5 type"};
  check(H5Tinsert(compound.id(), member.name.c_str(), 0, number.id()), "HDF5 type");
  return compound;
}

std::optional<hsize_t> width_of(hid_t type) {
  if (is_number(type)) return 1;
  if (H5Tget_class(type) != H5T_ARRAY || H5Tget_array_ndims(type) != 1) return std::nullopt;
  const Handle element{H5Tget_super(type), H5Tclose, "HDF5 type"};
  hsize_t width = 0;
  H5Tget_array_dims2(type, &width);
  return is_number(element.id()) && width > 0 ? std::optional{width} : std::nullopt;
}

std::vector<Member> members_of(hid_t dataset) {
  const Handle type{H5Dget_type(dataset), H5Tclose, "HDF5 type"};
  std::vector<Member> members;
  if (is_number(type.id())) members.push_back({});
  if (H5Tget_class(type.id()) != H5T_COMPOUND) return members;
  for (unsigned i = 0; i < static_cast<unsigned>(H5Tget_nmembers(type.id())); ++i) {
    const Handle member{H5Tget_member_type(type.id(), i), H5Tclose, "HDF5 type"};
    const std::unique_ptr<char, herr_t (*)(void*)> name{H5Tget_member_name(type.id(), i),
                                                        H5free_memory};
    if (const auto width = width_of(member.id()); width && name)
      members.push_back({name.get(), *width});
  }
  return members;
}

// Sizes other than 1, the last of which HDF5 stores in sequence. More than two: no table.
std::vector<hsize_t> sizes_of(hid_t dataset, const std::string& path) {
  const Handle space{H5Dget_space(dataset), H5Sclose, "reading " + path};
  const int dimensions = H5Sget_simple_extent_ndims(space.id());
  if (dimensions < 1) return {0, 0, 0};
  std::vector<hsize_t> sizes(static_cast<std::size_t>(dimensions));
  H5Sget_simple_extent_dims(space.id(), sizes.data(), nullptr);
  std::erase(sizes, hsize_t{1});
  return sizes;
}

// Adds the columns of a dataset, which HDF5 stores row by row.
void add_dataset(hid_t file, const std::string& path, Columns& columns) {
  const Handle dataset{H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "reading " + path};
  const auto sizes = sizes_of(dataset.id(), path);
  if (sizes.size() > kMostDimensions) return;
  for (const auto& member : members_of(dataset.id())) {
    hsize_t rows = sizes.empty() ? 1 : sizes[0], width = sizes.size() < 2 ? 1 : sizes[1];
    if (member.width > 1 && width > 1) continue;
    width *= member.width;
    if (width != 0 && rows > kMostValues / width) throw Error{path + " has too many values"};
    std::vector<double> stored(rows * width), by_column(rows * width);
    check(H5Dread(dataset.id(), type_in_memory(member).id(), H5S_ALL, H5S_ALL, H5P_DEFAULT,
                  stored.data()),
          "reading " + path);
    for (hsize_t row = 0; row < rows; ++row)
      for (hsize_t c = 0; c < width; ++c) by_column[c * rows + row] = stored[row * width + c];
    add_matrix(columns, member.name.empty() ? path : path + "." + member.name, rows, by_column);
  }
}

// Recordings of runs have these two groups.
bool is_recording(hid_t file) {
  return H5Lexists(file, "signals", H5P_DEFAULT) > 0 && H5Lexists(file, "meta", H5P_DEFAULT) > 0;
}

herr_t collect(hid_t, const char* name, const H5O_info_t* info, void* paths) {
  if (info->type == H5O_TYPE_DATASET)
    static_cast<std::vector<std::string>*>(paths)->emplace_back(name);
  return 0;
}

Columns columns_of(const std::filesystem::path& file) {
  silence_hdf5();
  std::vector<std::string> paths;
  Columns columns;
  {
    const Handle opened{open_to_read(file, H5F_ACC_RDONLY), H5Fclose,
                        file.string() + ": opening it as HDF5"};
    check(H5Ovisit(opened.id(), H5_INDEX_NAME, H5_ITER_NATIVE, collect, &paths),
          file.string() + ": listing the datasets");
    if (!is_recording(opened.id()))
      for (const auto& path : paths) add_dataset(opened.id(), path, columns);
  }
  return columns.empty() ? own_recording(Reader{file}) : columns;
}

}  // namespace

bool is_foreign_hdf5(const std::filesystem::path& file) {
  return in_child(file, [&] {
    silence_hdf5();
    const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    return opened >= 0 && !is_recording(opened);
  });
}

Columns read_hdf5_columns(const std::filesystem::path& file) {
  probe(file, [&] { static_cast<void>(read_hdf5_columns(file)); });
  return of_file(file, [&] { return columns_of(file); });
}

}  // namespace rths::recording
