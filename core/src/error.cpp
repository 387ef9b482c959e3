// SPDX-License-Identifier: Apache-2.0
#include <rths/core/error.hpp>

#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>

namespace rths {
namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const auto& line : lines) text += (text.empty() ? "" : "\n") + printable(line);
  return text;
}

}  // namespace

Error::Error(const std::string& line) : std::runtime_error{printable(line)} {}

Error::Error(const std::vector<std::string>& lines) : std::runtime_error{joined(lines)} {}

// The control characters beyond ASCII are two bytes in UTF-8: 0xC2, then 0x80 to 0x9F.
std::string printable(std::string_view text) {
  constexpr unsigned char kDelete = 0x7F, kLead = 0xC2, kFirst = 0x80, kLast = 0x9F;
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    if (byte == '\n') {
      result += "\\n";
    } else if (byte < ' ' || byte == kDelete) {
      result += fmt::format("\\x{:02x}", byte);
    } else if (byte == kLead && next >= kFirst && next <= kLast) {
      result += fmt::format("\\x{:02x}", next);
      ++i;
    } else {
      result += text[i];
    }
  }
  return result;
}

void assertion_failed(const char* claim, const char* file, int line) noexcept {
  std::fprintf(stderr, "%s:%d: assertion failed: %s\n", file, line, claim);
  std::abort();
}

void Require::operator()(bool holds, std::string_view name, double value,
                         std::string_view expected) const {
  if (!holds)
    throw Error{fmt::format("{}: {} is {:g}, expected {}", subject, name, value, expected)};
}

}  // namespace rths
