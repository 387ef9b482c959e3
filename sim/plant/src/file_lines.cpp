// SPDX-License-Identifier: Apache-2.0
#include "file_lines.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::plant {

FileLines::FileLines(std::filesystem::path file)
    : file_{std::move(file)}, content_{read_text(file_)}, lines_{lines_of(content_)} {}

std::optional<std::string_view> FileLines::next() {
  if (next_ >= lines_.size()) return std::nullopt;
  return lines_[next_++];
}

std::string_view FileLines::text() const {
  return next_ == 0 ? std::string_view{} : lines_[next_ - 1];
}

Index FileLines::whole(std::string_view cell, std::string_view what, Index least,
                       Index most) const {
  const auto found = number_of(cell);
  if (!found || *found != std::floor(*found) || *found < static_cast<double>(least) ||
      *found > static_cast<double>(most))
    fail(fmt::format("{} is '{}', expected a whole number from {} to {}", what, cell, least, most));
  return static_cast<Index>(*found);
}

double FileLines::number(std::string_view cell, std::string_view what) const {
  const auto found = number_of(cell);
  if (!found || !std::isfinite(*found))
    fail(fmt::format("{} is '{}', expected a finite number", what, cell));
  return *found;
}

void FileLines::fail_at(std::size_t line, const std::string& what) const {
  throw Error{fmt::format("{}:{}: {}", file_.string(), std::max<std::size_t>(line, 1), what)};
}

void FileLines::fail_at_end(const std::string& what) const { fail_at(lines_.size(), what); }

}  // namespace rths::plant
