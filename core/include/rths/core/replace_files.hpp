// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace rths {

/// Files that replace earlier ones together, when all of them are complete. Until then, and after
/// an error, the earlier files are unchanged.
class Replacements {
 public:
  Replacements() = default;
  ~Replacements();
  Replacements(const Replacements&) = delete;
  Replacements& operator=(const Replacements&) = delete;

  /// @throws Error with the reason if the file cannot be written   @setup
  void add(const std::filesystem::path& file, const std::string& text);

  /// An earlier file that has no successor, if it exists.
  void remove(const std::filesystem::path& file) { removed_.push_back(file); }

  /// @throws Error with the reason if a file cannot be replaced   @setup
  void commit();

 private:
  std::vector<std::filesystem::path> files_, removed_;
};

/// An earlier file is replaced when the new one is complete.
/// @throws Error with the reason if the file cannot be written   @setup
void replace_file(const std::filesystem::path& file, const std::string& text);

}  // namespace rths
