// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "support/files.hpp"

namespace rths::test {

/// A change of a text: what is found, what replaces it.
using Change = std::pair<std::string, std::string>;

/// modelDescription.xml of the lag, whose library is `name`. Every change must apply.
[[nodiscard]] std::string lag_description(int version, const std::string& name,
                                          const std::vector<Change>& changes = {});

/// An unpacked FMU below a folder.
/// @param library  copied as the FMU's binary for this computer; empty: none
[[nodiscard]] std::filesystem::path write_fmu(const TemporaryFolder& folder,
                                              const std::string& description,
                                              const std::filesystem::path& library, int version);

/// Packs a folder as an .fmu file beside it.
/// @param extra  name of one more file in it
[[nodiscard]] std::filesystem::path pack_fmu(const std::filesystem::path& folder,
                                             const std::string& extra = "");

/// Library of the lag with one definition, such as "fails_step".
[[nodiscard]] std::filesystem::path lag_library(int version, const std::string& name);
/// An unpacked FMU of the lag with one definition.
[[nodiscard]] std::filesystem::path lag_fmu(const TemporaryFolder& folder, int version,
                                            const std::string& name,
                                            const std::vector<Change>& changes = {});

}  // namespace rths::test
