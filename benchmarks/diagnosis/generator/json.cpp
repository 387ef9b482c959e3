// SPDX-License-Identifier: Apache-2.0
#include "json.hpp"

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>

namespace trial {

void Json::next(std::string_view key) {
  if (!is_first_) text_ += ',';
  is_first_ = false;
  if (!closing_.empty()) text_ += '\n' + std::string(2 * closing_.size(), ' ');
  if (!key.empty()) text_ += '"' + std::string(key) + "\": ";
}

void Json::open(std::string_view key) {
  next(key);
  text_ += '{';
  closing_.push_back('}');
  is_first_ = true;
}

void Json::open_list(std::string_view key) {
  next(key);
  text_ += '[';
  closing_.push_back(']');
  is_first_ = true;
}

void Json::close() {
  text_ += closing_.back();
  closing_.pop_back();
  is_first_ = false;
  if (closing_.empty()) text_ += '\n';
}

void Json::number(double value) {
  constexpr int kDigits = 9;
  if (!std::isfinite(value)) {
    text_ += "null";
    return;
  }
  std::array<char, 32> buffer{};
  // Integers keep all their digits.
  constexpr double kLargestWhole = 1e15;
  const bool is_whole = value == std::trunc(value) && std::abs(value) < kLargestWhole;
  const auto end = is_whole ? std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                            static_cast<std::int64_t>(value))
                            : std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                            std::chars_format::general, kDigits);
  text_.append(buffer.data(), end.ptr);
}

void Json::add(std::string_view key, std::string_view text) {
  next(key);
  text_ += '"' + std::string(text) + '"';
}

void Json::add(std::string_view key, double value) {
  next(key);
  number(value);
}

void Json::add(std::string_view key, bool yes) {
  next(key);
  text_ += yes ? "true" : "false";
}

void Json::add(std::string_view key, const std::vector<std::size_t>& numbers) {
  add(key, std::vector<double>(numbers.begin(), numbers.end()));
}

void Json::add(std::string_view key, const std::vector<double>& numbers) {
  next(key);
  text_ += '[';
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (i > 0) text_ += ", ";
    number(numbers[i]);
  }
  text_ += ']';
}

}  // namespace trial
