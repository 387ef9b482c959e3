// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>

#include <rths/recording/recording.hpp>

namespace rths::recording {
namespace {

// Missing values, which are not numbers, are equal too.
bool have_same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

}  // namespace

bool hold_same_signals(const Reader& a, const Reader& b) {
  const auto names = a.names();
  return a.rows() > 0 && names == b.names() && have_same_bits(a.time(), b.time()) &&
         std::all_of(names.begin(), names.end(), [&](const std::string& name) {
           return have_same_bits(a.signal(name), b.signal(name));
         });
}

}  // namespace rths::recording
