// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/recording/recording.hpp>

#include "hdf5.hpp"
#include "replaced_file.hpp"

namespace rths::recording {
namespace {

constexpr hsize_t kRowsPerBlock = 4096;
constexpr unsigned kLevel = 1;  // of 9: level 6 saves a twentieth and takes twice the time
constexpr int kMostDimensions = 2;

void copy_attribute(hid_t from, hid_t to, hsize_t index) {
  const Handle source{
      H5Aopen_by_idx(from, ".", H5_INDEX_NAME, H5_ITER_INC, index, H5P_DEFAULT, H5P_DEFAULT),
      H5Aclose, "opening an attribute"};
  std::string name(static_cast<std::size_t>(H5Aget_name(source.id(), 0, nullptr)), '\0');
  H5Aget_name(source.id(), name.size() + 1, name.data());
  const Handle type{H5Aget_type(source.id()), H5Tclose, "HDF5 type"};
  const Handle space{H5Aget_space(source.id()), H5Sclose, "HDF5 space"};
  const Handle copy{H5Acreate2(to, name.c_str(), type.id(), space.id(), H5P_DEFAULT, H5P_DEFAULT),
                    H5Aclose, "creating attribute " + name};
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.id()));
  if (count == 0) return;
  std::vector<char> values(count * H5Tget_size(type.id()));
  check(H5Aread(source.id(), type.id(), values.data()), "reading attribute " + name);
  const herr_t written = H5Awrite(copy.id(), type.id(), values.data());
  if (H5Tis_variable_str(type.id()) > 0)
    H5Dvlen_reclaim(type.id(), space.id(), H5P_DEFAULT, values.data());
  check(written, "writing attribute " + name);
}

void copy_attributes(hid_t from, hid_t to) {
  const int count = H5Aget_num_attrs(from);
  for (int i = 0; i < count; ++i) copy_attribute(from, to, static_cast<hsize_t>(i));
}

// Tables that grew by rows are compressed column by column; other datasets are small.
Handle properties_of(const Handle& source) {
  Handle properties{H5Dget_create_plist(source.id()), H5Pclose, "HDF5 properties"};
  // Without times in the objects, identical runs give identical files.
  check(H5Pset_obj_track_times(properties.id(), false), "HDF5 properties");
  if (H5Pget_layout(properties.id()) != H5D_CHUNKED) return properties;
  constexpr hsize_t kChunk[kMostDimensions] = {kRowsPerBlock, 1};
  const int rank = H5Pget_chunk(properties.id(), 0, nullptr);
  check(H5Pset_chunk(properties.id(), rank, kChunk), "HDF5 chunks");
  check(H5Pset_shuffle(properties.id()), "HDF5 shuffle");
  check(H5Pset_deflate(properties.id(), kLevel), "HDF5 compression");
  return properties;
}

void copy_values(const Handle& source, const Handle& copy, const Handle& type,
                 const Handle& space) {
  hsize_t size[kMostDimensions] = {1, 1};
  const int rank = H5Sget_simple_extent_dims(space.id(), size, nullptr);
  std::vector<char> values(std::min(size[0], kRowsPerBlock) * size[1] * H5Tget_size(type.id()));
  if (values.empty()) return;
  for (hsize_t row = 0; row < size[0]; row += kRowsPerBlock) {
    const hsize_t start[kMostDimensions] = {row, 0};
    const hsize_t count[kMostDimensions] = {std::min(size[0] - row, kRowsPerBlock), size[1]};
    if (rank > 0)
      check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, count, nullptr),
            "selecting rows");
    const Handle block{rank > 0 ? H5Screate_simple(rank, count, nullptr) : H5Screate(H5S_SCALAR),
                       H5Sclose, "HDF5 space"};
    check(H5Dread(source.id(), type.id(), block.id(), space.id(), H5P_DEFAULT, values.data()),
          "reading a dataset");
    check(H5Dwrite(copy.id(), type.id(), block.id(), space.id(), H5P_DEFAULT, values.data()),
          "writing a dataset (is the disk full?)");
  }
}

void copy_dataset(hid_t from, hid_t to, const std::string& path) {
  const Handle source{H5Dopen2(from, path.c_str(), H5P_DEFAULT), H5Dclose, "opening " + path};
  const Handle type{H5Dget_type(source.id()), H5Tclose, "HDF5 type"};
  const Handle space{H5Dget_space(source.id()), H5Sclose, "HDF5 space"};
  const Handle copy{H5Dcreate2(to, path.c_str(), type.id(), space.id(), H5P_DEFAULT,
                               properties_of(source).id(), H5P_DEFAULT),
                    H5Dclose, "creating " + path};
  copy_attributes(source.id(), copy.id());
  copy_values(source, copy, type, space);
}

void copy_group(hid_t from, hid_t to, const std::string& path) {
  const Handle source{H5Gopen2(from, path.c_str(), H5P_DEFAULT), H5Gclose, "opening " + path};
  const Handle copy{path == "."
                        ? H5Gopen2(to, ".", H5P_DEFAULT)
                        : H5Gcreate2(to, path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                    H5Gclose, "creating " + path};
  copy_attributes(source.id(), copy.id());
}

struct Object {
  std::string path;
  H5O_type_t type;
};

// Groups come before their members.
herr_t collect_object(hid_t, const char* path, const H5O_info_t* info, void* objects) {
  static_cast<std::vector<Object>*>(objects)->push_back({path, info->type});
  return 0;
}

std::size_t rows_of(const Handle& file) {
  const Handle time{H5Dopen2(file.id(), "time", H5P_DEFAULT), H5Dclose, "opening time"};
  const Handle space{H5Dget_space(time.id()), H5Sclose, "HDF5 space"};
  return static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.id()));
}

// @returns the number of rows of the closed recording
std::size_t copy_compressed(const std::filesystem::path& from, const std::filesystem::path& to) {
  const Handle source{open_to_read(from, H5F_ACC_RDONLY), H5Fclose, "opening it (was it closed?)"};
  const Handle access = without_lock();
  const Handle copy{H5Fcreate(to.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose,
                    "creating " + to.string()};
  std::vector<Object> objects;
  check(H5Ovisit(source.id(), H5_INDEX_NAME, H5_ITER_INC, collect_object, &objects),
        "listing the objects");
  for (const auto& object : objects)
    object.type == H5O_TYPE_DATASET ? copy_dataset(source.id(), copy.id(), object.path)
                                    : copy_group(source.id(), copy.id(), object.path);
  check(H5Fflush(copy.id(), H5F_SCOPE_GLOBAL), "writing (is the disk full?)");
  return rows_of(source);
}

}  // namespace

void compress(const std::filesystem::path& file) {
  silence_hdf5();
  try {
    replace_file(file, kCopying, [&](const std::filesystem::path& copy) {
      const std::size_t rows = copy_compressed(file, copy);
      if (Reader{copy}.rows() != rows) throw Error{"the copy lacks rows"};
      write_through(copy);
    });
  } catch (const Error& error) {
    throw Error{fmt::format("{} (it stays uncompressed)", error.what())};
  }
}

}  // namespace rths::recording
