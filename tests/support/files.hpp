// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace rths::test {

/// A temporary folder that is removed at the end of the test.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Writes a file into the folder. @returns its path
  std::filesystem::path write(const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

/// Root of the source tree.
[[nodiscard]] std::filesystem::path source_tree();
/// Root of the build that runs this test.
[[nodiscard]] std::filesystem::path build_tree();
[[nodiscard]] std::string content_of(const std::filesystem::path& file);
/// Message of the exception that `action` throws; empty without one.
template <class Action>
[[nodiscard]] std::string error_of(Action action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

}  // namespace rths::test
