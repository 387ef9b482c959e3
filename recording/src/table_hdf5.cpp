// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/recording.hpp>

#include "hdf5.hpp"
#include "probe.hpp"
#include "table_formats.hpp"

namespace rths::recording {
namespace {

constexpr int kMostDimensions = 2;
constexpr hsize_t kMostValues = hsize_t{1} << 31U;  // of a dataset

Columns own_recording(const Reader& reader) {
  Columns columns{{"time", reader.time(), ""}};
  for (const auto& name : reader.names()) columns.push_back({name, reader.signal(name), ""});
  return columns;
}

bool is_number(hid_t dataset) {
  const Handle type{H5Dget_type(dataset), H5Tclose, "HDF5 type"};
  const auto kind = H5Tget_class(type.id());
  return kind == H5T_INTEGER || kind == H5T_FLOAT;
}

// Adds the columns of a dataset, which HDF5 stores row by row.
void add_dataset(hid_t file, const std::string& path, Columns& columns) {
  const Handle dataset{H5Dopen2(file, path.c_str(), H5P_DEFAULT), H5Dclose, "reading " + path};
  const Handle space{H5Dget_space(dataset.id()), H5Sclose, "reading " + path};
  const int dimensions = H5Sget_simple_extent_ndims(space.id());
  if (dimensions < 1 || dimensions > kMostDimensions || !is_number(dataset.id())) return;
  hsize_t size[kMostDimensions] = {0, 1};
  H5Sget_simple_extent_dims(space.id(), size, nullptr);
  if (size[1] != 0 && size[0] > kMostValues / size[1]) throw Error{path + " has too many values"};
  std::vector<double> stored(size[0] * size[1]);
  check(H5Dread(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, stored.data()),
        "reading " + path);
  // A single row is a column.
  if (size[0] == 1) std::swap(size[0], size[1]);
  std::vector<double> by_column(stored.size());
  for (hsize_t row = 0; row < size[0]; ++row)
    for (hsize_t c = 0; c < size[1]; ++c) by_column[c * size[0] + row] = stored[row * size[1] + c];
  add_array(columns, path, size[0], by_column);
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
    const Handle opened{H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                        file.string() + ": opening it as HDF5"};
    check(H5Ovisit(opened.id(), H5_INDEX_NAME, H5_ITER_NATIVE, collect, &paths),
          file.string() + ": listing the datasets");
    if (!is_recording(opened.id()))
      for (const auto& path : paths) add_dataset(opened.id(), path, columns);
  }
  return columns.empty() ? own_recording(Reader{file}) : columns;
}

}  // namespace

Columns read_hdf5_columns(const std::filesystem::path& file) {
  probe(file, [&] { static_cast<void>(read_hdf5_columns(file)); });
  return of_file(file, [&] { return columns_of(file); });
}

}  // namespace rths::recording
