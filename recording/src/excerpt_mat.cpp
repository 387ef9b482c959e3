// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/excerpt.hpp>

#include <cerrno>
#include <cstring>
#include <memory>
#include <utility>

#include <fmt/format.h>
#include <matio.h>

#include <rths/core/error.hpp>

#include "replaced_file.hpp"

namespace rths::recording {
namespace {

constexpr std::size_t kLargestVariable = (1ULL << 31) - 1;  // [bytes], of version 5
constexpr const char* kHeader = "MATLAB 5.0 MAT-file, written by rths";

struct Close {
  void operator()(mat_t* file) const { Mat_Close(file); }
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};
using MatFile = std::unique_ptr<mat_t, Close>;
using Variable = std::unique_ptr<matvar_t, Close>;

void write(const MatFile& file, const Variable& variable) {
  if (!variable || Mat_VarWrite(file.get(), variable.get(), MAT_COMPRESSION_ZLIB) != 0)
    throw Error{"cannot be written"};
}

// By value, because the library takes pointers to data that are not constant.
void write_matrix(const MatFile& file, const char* name, std::size_t rows,
                  std::vector<double> by_column) {
  std::size_t size[] = {rows, by_column.size() / rows};
  write(file, Variable{Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, size, by_column.data(),
                                     MAT_F_DONT_COPY_DATA)});
}

void write_cells(const MatFile& file, const char* name, std::vector<std::string> texts) {
  std::size_t size[] = {texts.size(), 1};
  Variable cells{Mat_VarCreate(name, MAT_C_CELL, MAT_T_CELL, 2, size, nullptr, 0)};
  for (std::size_t i = 0; cells && i < texts.size(); ++i) {
    std::size_t length[] = {1, texts[i].size()};
    Mat_VarSetCell(cells.get(), static_cast<int>(i),
                   Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, length, texts[i].data(), 0));
  }
  write(file, cells);
}

// The library does not report a full disk.
void check_complete(const std::filesystem::path& path, std::size_t rows) {
  const MatFile file{Mat_Open(path.c_str(), MAT_ACC_RDONLY)};
  const Variable last{file ? Mat_VarRead(file.get(), "time") : nullptr};
  if (!last || last->data == nullptr || last->nbytes != rows * sizeof(double))
    throw Error{"cannot be written (is the disk full?)"};
}

}  // namespace

void write_mat(const Excerpt& excerpt, const std::filesystem::path& file) {
  const std::size_t rows = excerpt.time.size();
  const std::size_t bytes = rows * excerpt.values.size() * sizeof(double);
  if (bytes > kLargestVariable)
    throw Error{
        fmt::format("{}: would have {:.1f} GB, a MAT file has at most 2; select signals or "
                    "a shorter time",
                    file.string(), static_cast<double>(bytes) * 1e-9)};
  replace_file(file, unused_ending(file), [&](const std::filesystem::path& part) {
    {
      errno = 0;
      const MatFile opened{Mat_CreateVer(part.c_str(), kHeader, MAT_FT_MAT5)};
      if (!opened) throw Error{fmt::format("cannot be written: {}", std::strerror(errno))};
      std::vector<double> values;
      values.reserve(rows * excerpt.values.size());
      for (const auto& column : excerpt.values)
        values.insert(values.end(), column.begin(), column.end());
      write_matrix(opened, "values", rows, std::move(values));
      write_cells(opened, "names", excerpt.names);
      write_cells(opened, "units", excerpt.units);
      write_matrix(opened, "time", rows, excerpt.time);
    }
    check_complete(part, rows);
  });
}

}  // namespace rths::recording
