// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>
#include <vector>

#include <rths/core/error.hpp>

namespace rths::report {

/// Files that replace earlier ones together, when all of them are complete. Until then, and after
/// an error, the earlier files are unchanged.
class Replacements {
 public:
  Replacements() = default;
  Replacements(const Replacements&) = delete;
  Replacements& operator=(const Replacements&) = delete;
  ~Replacements() {
    std::error_code ignored;
    for (const auto& file : files_) std::filesystem::remove(part_of(file), ignored);
  }

  /// @throws Error if the file cannot be written
  void add(const std::filesystem::path& file, const std::string& text) {
    files_.push_back(file);
    errno = 0;
    std::ofstream stream{part_of(file), std::ios::binary};
    stream << text;
    stream.close();
    if (!stream) fail(file, {errno, std::generic_category()});
  }

  /// An earlier file that has no successor, if it exists.
  void remove(const std::filesystem::path& file) { removed_.push_back(file); }

  /// @throws Error if a file cannot be replaced
  void commit() {
    std::error_code error;
    for (const auto& file : removed_) std::filesystem::remove(file, error);
    for (const auto& file : files_) {
      std::filesystem::rename(part_of(file), file, error);
      if (error) fail(file, error);
    }
    files_.clear();
  }

 private:
  static std::filesystem::path part_of(std::filesystem::path file) { return file += ".part"; }
  [[noreturn]] static void fail(const std::filesystem::path& file, const std::error_code& reason) {
    throw Error{file.string() + ": cannot be written" +
                (reason ? ": " + reason.message() : std::string{})};
  }

  std::vector<std::filesystem::path> files_, removed_;
};

/// An earlier file is replaced when the new one is complete.
/// @throws Error if the file cannot be written
inline void write_file(const std::filesystem::path& file, const std::string& text) {
  Replacements one;
  one.add(file, text);
  one.commit();
}

}  // namespace rths::report
