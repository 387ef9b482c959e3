// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace rths {

/// SHA-256 (FIPS 180-4) in hexadecimal digits, as sha256sum prints it.   @setup
[[nodiscard]] std::string sha256(std::string_view bytes);
/// Of the content of a file. @throws Error as read_file   @setup
[[nodiscard]] std::string sha256_of(const std::filesystem::path& file);

}  // namespace rths
