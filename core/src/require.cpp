// SPDX-License-Identifier: Apache-2.0
#include <rths/core/require.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths {

void Require::operator()(bool holds, std::string_view name, double value,
                         std::string_view expected) const {
  if (!holds)
    throw Error{fmt::format("{}: {} is {:g}, expected {}", subject, name, value, expected)};
}

}  // namespace rths
