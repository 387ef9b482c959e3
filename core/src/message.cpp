// SPDX-License-Identifier: Apache-2.0
#include <rths/core/message.hpp>

#include <cstdio>

namespace rths {

void write_message(const std::string& text) noexcept {
  static_cast<void>(std::fwrite(text.data(), 1, text.size(), stderr));
}

}  // namespace rths
