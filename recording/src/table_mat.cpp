// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <numeric>
#include <span>

#include <fmt/format.h>
#include <matio.h>

#include <rths/core/error.hpp>

#include "hdf5.hpp"
#include "probe.hpp"
#include "table_formats.hpp"

namespace rths::recording {
namespace {

constexpr int kDeepest = 6;  // nested structures and cells

struct CloseFile {
  void operator()(mat_t* file) const { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const { Mat_VarFree(variable); }
};

template <class T>
void append(const matvar_t& variable, std::vector<double>& values) {
  const std::size_t count = variable.nbytes / sizeof(T);
  const auto* data = static_cast<const T*>(variable.data);
  for (std::size_t i = 0; i < count; ++i) values.push_back(static_cast<double>(data[i]));
}

/// A class of numbers, and what appends those of a variable.
struct NumberClass {
  matio_classes type;
  void (*append)(const matvar_t&, std::vector<double>&);
};
constexpr NumberClass kNumberClasses[] = {
    {MAT_C_DOUBLE, append<double>},      {MAT_C_SINGLE, append<float>},
    {MAT_C_INT8, append<std::int8_t>},   {MAT_C_UINT8, append<std::uint8_t>},
    {MAT_C_INT16, append<std::int16_t>}, {MAT_C_UINT16, append<std::uint16_t>},
    {MAT_C_INT32, append<std::int32_t>}, {MAT_C_UINT32, append<std::uint32_t>},
    {MAT_C_INT64, append<std::int64_t>}, {MAT_C_UINT64, append<std::uint64_t>}};

std::vector<double> numbers_of(const matvar_t& variable) {
  std::vector<double> values;
  if (variable.data == nullptr || variable.isComplex != 0) return values;
  for (const auto& known : kNumberClasses)
    if (variable.class_type == known.type) known.append(variable, values);
  return values;
}

std::size_t elements_of(const matvar_t& variable) {
  return std::accumulate(variable.dims, variable.dims + variable.rank, std::size_t{1},
                         std::multiplies<>{});
}

void add_variable(const std::string& name, matvar_t& variable, int depth, Columns& columns);

// Elements of an array of structures have an index, as in MATLAB: rec.Y(2).Data.
void add_structures(const std::string& name, matvar_t& variable, int depth, Columns& columns) {
  const std::size_t fields = Mat_VarGetNumberOfFields(&variable), count = elements_of(variable);
  const char* const* names = Mat_VarGetStructFieldnames(&variable);
  for (std::size_t element = 0; element < count; ++element)
    for (std::size_t i = 0; i < fields; ++i)
      if (matvar_t* field = Mat_VarGetStructFieldByIndex(&variable, i, element))
        add_variable(fmt::format("{}{}.{}", name, count > 1 ? fmt::format("({})", element + 1) : "",
                                 names[i]),
                     *field, depth + 1, columns);
}

void add_cells(const std::string& name, matvar_t& variable, int depth, Columns& columns) {
  for (std::size_t i = 0; i < elements_of(variable); ++i)
    if (matvar_t* cell = Mat_VarGetCell(&variable, static_cast<int>(i)))
      add_variable(fmt::format("{}{{{}}}", name, i + 1), *cell, depth + 1, columns);
}

void add_variable(const std::string& name, matvar_t& variable, int depth, Columns& columns) {
  if (variable.class_type == MAT_C_STRUCT && depth < kDeepest)
    return add_structures(name, variable, depth, columns);
  if (variable.class_type == MAT_C_CELL && depth < kDeepest)
    return add_cells(name, variable, depth, columns);
  const auto values = numbers_of(variable);
  std::vector<std::size_t> sizes(variable.dims, variable.dims + variable.rank);
  std::erase(sizes, std::size_t{1});
  if (values.empty() || sizes.size() > 2) return;
  add_matrix(columns, name, sizes.empty() ? 1 : sizes[0], values);
}

bool is_object(const matvar_t& variable) {
  return variable.class_type == MAT_C_OBJECT || variable.class_type == MAT_C_OPAQUE ||
         variable.class_type == MAT_C_FUNCTION;
}

}  // namespace

bool is_mat(const std::filesystem::path& file) {
  std::array<char, 20> head{};
  if (!std::filesystem::is_regular_file(file)) return false;
  std::ifstream stream{file, std::ios::binary};
  stream.read(head.data(), head.size());
  for (const char* version : {"MATLAB 5.0 MAT-file", "MATLAB 7.3 MAT-file"})
    if (std::memcmp(head.data(), version, 19) == 0) return true;
  // Version 4 has no signature. Its first word is a type below 5000, unlike that of any text.
  std::uint32_t words[5];
  std::memcpy(words, head.data(), sizeof words);
  return stream.gcount() == 20 && words[0] < 5000 && words[3] <= 1 && words[4] > 0 &&
         words[4] < 64 && words[1] > 0 && words[2] > 0;
}

Columns read_mat_columns(const std::filesystem::path& file) {
  probe(file, [&] { static_cast<void>(read_mat_columns(file)); });
  silence_hdf5();
  const std::unique_ptr<mat_t, CloseFile> opened{Mat_Open(file.c_str(), MAT_ACC_RDONLY)};
  if (!opened) throw Error{file.string() + ": cannot be read as a MAT file"};
  Columns columns;
  std::string objects, unreadable;
  std::size_t count = 0;
  char* const* const names = Mat_GetDir(opened.get(), &count);
  for (const std::string name : std::span{names, names == nullptr ? 0 : count}) {
    const std::unique_ptr<matvar_t, FreeVariable> variable{Mat_VarRead(opened.get(), name.c_str())};
    if (!variable) {
      unreadable += fmt::format(" '{}'", name);
      continue;
    }
    add_variable(name, *variable, 0, columns);
    if (is_object(*variable)) objects += fmt::format(" '{}'", name);
  }
  if (columns.empty() && !unreadable.empty())
    throw Error{fmt::format(
        "{}: the variables{} cannot be read; expected those that MATLAB writes (in version 7.3, "
        "each has the attribute MATLAB_class)",
        file.string(), unreadable)};
  if (columns.empty() && !objects.empty())
    throw Error{
        fmt::format("{}: holds objects that only MATLAB reads, such as time series:{}; "
                    "expected arrays or structures",
                    file.string(), objects)};
  return columns;
}

}  // namespace rths::recording
