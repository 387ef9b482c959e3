// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/excerpt.hpp>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>

#include "replaced_file.hpp"

namespace rths::recording {
namespace {

constexpr std::size_t kBlock = 1 << 16;  // [bytes] written at once

std::vector<std::size_t> rows_between(const std::vector<double>& time, double from, double to) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < time.size(); ++row)
    if (time[row] >= from && time[row] <= to) rows.push_back(row);
  if (!rows.empty()) return rows;
  if (time.empty()) throw Error{"the recording has no rows"};
  throw Error{fmt::format("no row from {} to {} s, expected times from {} to {} s", from, to,
                          time.front(), time.back())};
}

std::vector<double> taken(const std::vector<double>& values, const std::vector<std::size_t>& rows) {
  std::vector<double> result;
  result.reserve(rows.size());
  // After a crash, a column can be shorter than the time.
  for (const auto row : rows) result.push_back(row < values.size() ? values[row] : std::nan(""));
  return result;
}

std::string header_of(const Excerpt& excerpt) {
  std::string header = "time [s]";
  for (std::size_t i = 0; i < excerpt.names.size(); ++i)
    header += fmt::format(",{} [{}]", excerpt.names[i], excerpt.units[i]);
  return header + '\n';
}

void append_row(const Excerpt& excerpt, std::size_t row, fmt::memory_buffer& text) {
  auto out = std::back_inserter(text);
  fmt::format_to(out, "{:.9f}", excerpt.time[row]);
  for (const auto& column : excerpt.values) {
    if (std::isnan(column[row]))
      fmt::format_to(out, ",NaN");
    else
      fmt::format_to(out, ",{:.9g}", column[row]);
  }
  text.push_back('\n');
}

}  // namespace

Excerpt make_excerpt(const Reader& reader, const std::vector<std::string>& names, double from,
                     double to) {
  const auto rows = rows_between(reader.time(), from, to);
  Excerpt excerpt{taken(reader.time(), rows), names, {}, {}};
  for (const auto& name : names) {
    excerpt.values.push_back(taken(reader.signal(name), rows));
    excerpt.units.push_back(reader.unit(name));
  }
  return excerpt;
}

void write_csv(const Excerpt& excerpt, const std::filesystem::path& file) {
  replace_file(file, unused_ending(file), [&](const std::filesystem::path& part) {
    errno = 0;
    std::ofstream stream{part, std::ios::binary};
    stream << header_of(excerpt);
    fmt::memory_buffer text;
    for (std::size_t row = 0; row < excerpt.time.size() && stream; ++row) {
      append_row(excerpt, row, text);
      if (text.size() < kBlock && row + 1 < excerpt.time.size()) continue;
      stop_if_interrupted();
      stream.write(text.data(), static_cast<std::streamsize>(text.size()));
      text.clear();
    }
    stream.close();
    if (!stream) throw Error{fmt::format("cannot be written: {}", std::strerror(errno))};
  });
}

}  // namespace rths::recording
