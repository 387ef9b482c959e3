// SPDX-License-Identifier: Apache-2.0
#include "assemble.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace rths::report {
namespace {

std::string base64(std::span<const std::byte> bytes) {
  const std::size_t count = bytes.size();
  const auto number = [&](std::size_t i) { return std::to_integer<std::uint32_t>(bytes[i]); };
  constexpr char kBase64[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((count + 2) / 3 * 4);
  for (std::size_t i = 0; i < count; i += 3) {
    std::uint32_t group = number(i) << 16;
    if (i + 1 < count) group |= number(i + 1) << 8;
    if (i + 2 < count) group |= number(i + 2);
    text += kBase64[group >> 18 & 63];
    text += kBase64[group >> 12 & 63];
    text += i + 1 < count ? kBase64[group >> 6 & 63] : '=';
    text += i + 2 < count ? kBase64[group & 63] : '=';
  }
  return text;
}

}  // namespace

Json packed(const std::vector<double>& values, double scale) {
  std::vector<float> floats;
  floats.reserve(values.size());
  for (const double value : values) floats.push_back(static_cast<float>(value * scale));
  return base64(std::as_bytes(std::span{floats}));
}

std::size_t stride_of(std::size_t count, std::size_t most) {
  return std::max<std::size_t>(1, (count + most - 1) / most);
}

std::vector<double> thinned(const std::vector<double>& values, std::size_t most) {
  const std::size_t stride = stride_of(values.size(), most);
  std::vector<double> result;
  for (std::size_t i = 0; i < values.size(); i += stride) result.push_back(values[i]);
  return result;
}

std::string assemble(const PageSections& sections, const Json& data) {
  return web::assemble(sections, data.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace rths::report
