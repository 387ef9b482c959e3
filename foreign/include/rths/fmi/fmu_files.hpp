// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include <rths/fmi/model_description.hpp>

namespace rths::fmi {

/// Files of an FMU. A packed FMU is unpacked into a temporary folder, which is removed with this
/// object. The object of another process removes one that a killed process left behind.
class FmuFiles {
 public:
  /// @param file  an .fmu file, or a folder with its content
  /// @throws Error if it cannot be unpacked   @setup
  explicit FmuFiles(const std::filesystem::path& file);
  ~FmuFiles();
  FmuFiles(const FmuFiles&) = delete;
  FmuFiles& operator=(const FmuFiles&) = delete;

  [[nodiscard]] const std::filesystem::path& folder() const { return folder_; }

 private:
  void remove() noexcept;

  std::filesystem::path folder_;
  std::filesystem::path lock_file_;  ///< beside a temporary folder; empty: none
  int lock_ = -1;
};

/// The description of a packed or unpacked FMU.
/// @throws Error if it has none, or as parse_description   @setup
[[nodiscard]] ModelDescription read_description(const std::filesystem::path& file);

/// The FMU's library for this computer.
/// @throws Error if it has none   @setup
[[nodiscard]] std::filesystem::path library_in(const std::filesystem::path& folder,
                                               const ModelDescription& description);

}  // namespace rths::fmi
