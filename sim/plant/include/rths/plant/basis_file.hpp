// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include <rths/plant/basis.hpp>

namespace rths::plant {

/// Format version of the file of a basis. Bump it when its content or its meaning changes.
inline constexpr int kBasisFormat = 2;

/// The basis of a file; none if there is no such file, or if it is damaged or of another key.
/// @setup
[[nodiscard]] std::optional<Basis> read_basis(const std::filesystem::path& file,
                                              const std::string& key);
/// Replaces a file as a whole. @returns whether it could be written   @setup
bool write_basis(const std::filesystem::path& file, const std::string& key, const Basis& basis);

/// The basis of the file in a folder that belongs to a key; otherwise makes and keeps it.
/// @param folder  none: nothing is kept   @setup
[[nodiscard]] Basis basis_for(const std::optional<std::filesystem::path>& folder,
                              const std::string& key, const std::function<Basis()>& make);

}  // namespace rths::plant
