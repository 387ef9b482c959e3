// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/ground_motion.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <sstream>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths::sim {
namespace {

constexpr int kAt2HeaderLines = 4;
constexpr double kTimeTolerance = 1e-3;  // of a step: precision of three printed decimals

std::istringstream open(const std::filesystem::path& file) {
  return std::istringstream{read_file(file, kMostTextBytes)};
}

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t line,
                       const std::string& problem) {
  throw Error{file.string() + ":" + std::to_string(line) + ": " + problem};
}

std::vector<double> parse_numbers(const std::string& line, const std::filesystem::path& file,
                                  std::size_t line_number) {
  std::vector<double> numbers;
  const char* at = line.data();
  const char* end = at + line.size();
  const auto is_separator = [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) || c == ',' || c == ';';
  };
  while (true) {
    at = std::find_if_not(at, end, is_separator);
    if (at == end) return numbers;
    const char* word_end = std::find_if(at, end, is_separator);
    double value = 0;
    const char* digits = *at == '+' ? at + 1 : at;
    const auto [stopped, problem] = std::from_chars(digits, word_end, value);
    if (problem != std::errc{} || stopped != word_end || !std::isfinite(value))
      fail(file, line_number, "'" + std::string{at, word_end} + "' is not a number");
    numbers.push_back(value);
    at = word_end;
  }
}

bool is_heading(const std::string& line) {
  const auto first = std::find_if_not(line.begin(), line.end(), [](char c) {
    return std::isspace(static_cast<unsigned char>(c)) || c == '"';
  });
  return first == line.end() || *first == '#' || *first == '%' ||
         std::isalpha(static_cast<unsigned char>(*first));
}

std::string in_capitals(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

// "NPTS=   4000, DT=   .0050 SEC": the number after a keyword, with any spacing.
double number_after(const std::string& line, const std::string& keyword,
                    const std::filesystem::path& file, std::size_t line_number) {
  const auto found = line.find(keyword);
  const auto digits =
      found == std::string::npos ? found : line.find_first_of("+-.0123456789", found);
  if (digits == std::string::npos)
    fail(file, line_number, keyword + " not found, expected 'NPTS= n, DT= s SEC'");
  const auto end = line.find_first_not_of("+-.0123456789eE", digits);
  return parse_numbers(line.substr(digits, end - digits), file, line_number).front();
}

// "NPTS , DT = 4000 , .0050" has both numbers after one sign.
void read_at2_header(const std::string& line, const std::filesystem::path& file, std::size_t number,
                     std::size_t& count, double& time_step) {
  std::string step = line;
  const auto sign = line.find('=');
  if (sign != std::string::npos && sign == line.rfind('=') && line.find("DT") < sign) {
    const auto comma = line.find(',', sign);
    if (comma != std::string::npos) step = "DT " + line.substr(comma + 1);
  }
  count = static_cast<std::size_t>(number_after(line, "NPTS", file, number));
  time_step = number_after(step, "DT", file, number);
}

void check_spacing(const std::vector<double>& times, const std::vector<std::size_t>& lines,
                   const std::filesystem::path& file) {
  if (times.size() < 2) throw Error{file.string() + ": fewer than two samples"};
  const double step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  if (!(step > 0)) fail(file, lines.back(), "time does not increase");
  for (std::size_t i = 1; i < times.size(); ++i)
    if (std::abs(times[i] - times.front() - static_cast<double>(i) * step) >
        std::max(kTimeTolerance * step, 6e-4))
      fail(file, lines[i], "time is not equally spaced");
}

// The heading of a column; empty if it has none.
std::string field_of(const std::string& headings, int column) {
  std::size_t begin = 0;
  for (int i = 0; i < column; ++i) {
    begin = headings.find_first_of(",;\t", begin);
    if (begin == std::string::npos) return "";
    ++begin;
  }
  return headings.substr(begin, headings.find_first_of(",;\t\r", begin) - begin);
}

double between(const std::vector<double>& values, double position) noexcept {
  if (!(position >= 0) || position > static_cast<double>(values.size()) - 1) return 0;
  const auto i = std::min(static_cast<std::size_t>(position), values.size() - 2);
  const double fraction = position - static_cast<double>(i);
  return (1 - fraction) * values[i] + fraction * values[i + 1];
}

}  // namespace

Eigen::Vector2d GroundMotion::at(double time) const noexcept {
  const double position = time / time_step;
  return {between(long_acceleration, position), between(lat_acceleration, position)};
}

double GroundMotion::vertical_at(double time) const noexcept {
  return vert_acceleration.empty() ? 0 : between(vert_acceleration, time / time_step);
}

bool is_at2(const std::filesystem::path& file) {
  if (in_capitals(file.extension().string()) == ".AT2") return true;
  std::istringstream stream = open(file);
  std::string line;
  for (int i = 0; i < kAt2HeaderLines; ++i)
    if (!std::getline(stream, line)) return false;
  line = in_capitals(line);
  return line.find("NPTS") != std::string::npos && line.find("DT") != std::string::npos;
}

RecordComponent read_at2(const std::filesystem::path& file) {
  std::istringstream stream = open(file);
  RecordComponent record;
  std::size_t expected = 0;
  std::string line;
  std::size_t line_number = 0;
  while (std::getline(stream, line)) {
    ++line_number;
    constexpr std::string_view kUnit = "UNITS OF";
    if (line_number < kAt2HeaderLines) {
      const std::string capitals = in_capitals(line);
      if (const auto unit = capitals.find(kUnit); unit != std::string::npos)
        record.heading = line.substr(unit + kUnit.size());
      continue;
    }
    if (line_number == kAt2HeaderLines) {
      read_at2_header(in_capitals(line), file, line_number, expected, record.time_step);
      if (!(record.time_step > 0))
        fail(file, line_number,
             fmt::format("DT is {:g} s, expected a positive time", record.time_step));
      continue;
    }
    for (const double value : parse_numbers(line, file, line_number))
      record.values.push_back(value);
  }
  if (record.values.size() != expected || expected < 2)
    fail(file, line_number,
         std::to_string(record.values.size()) +
             " values found, expected NPTS = " + std::to_string(expected));
  return record;
}

RecordComponent read_column(const std::filesystem::path& file, int column) {
  std::istringstream stream = open(file);
  RecordComponent record;
  std::vector<double> times;
  std::vector<std::size_t> lines;
  std::string line;
  for (std::size_t line_number = 1; std::getline(stream, line); ++line_number) {
    if (is_heading(line)) {
      if (times.empty()) record.heading = field_of(line, column);
      continue;
    }
    const auto numbers = parse_numbers(line, file, line_number);
    if (static_cast<int>(numbers.size()) <= column)
      fail(file, line_number,
           std::to_string(numbers.size()) + " columns found, expected column " +
               std::to_string(column) + " (0 is time)");
    times.push_back(numbers[0]);
    lines.push_back(line_number);
    record.values.push_back(numbers[static_cast<std::size_t>(column)]);
  }
  check_spacing(times, lines, file);
  record.time_step = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
  return record;
}

GroundMotion read_motion(const std::filesystem::path& file, const std::array<int, 3>& columns,
                         double scale) {
  GroundMotion motion;
  const auto read = [&](int column) {
    RecordComponent component = read_column(file, column);
    motion.time_step = component.time_step;
    for (double& value : component.values) value *= scale * kStandardGravity;
    return component.values;
  };
  motion.long_acceleration = read(columns[0]);
  motion.lat_acceleration = read(columns[1]);
  motion.vert_acceleration = read(columns[2]);
  return motion;
}

}  // namespace rths::sim
