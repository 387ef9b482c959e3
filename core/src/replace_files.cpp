// SPDX-License-Identifier: Apache-2.0
#include <rths/core/replace_files.hpp>

#include <cerrno>
#include <fstream>
#include <system_error>

#include <rths/core/error.hpp>

namespace rths {
namespace {

namespace fs = std::filesystem;

fs::path part_of(fs::path file) { return file += ".part"; }

[[noreturn]] void fail(const fs::path& file, const std::error_code& reason) {
  throw Error{file.string() + ": cannot be written" + (reason ? ": " + reason.message() : "")};
}

}  // namespace

Replacements::~Replacements() {
  std::error_code ignored;
  for (const auto& file : files_) fs::remove(part_of(file), ignored);
}

void Replacements::add(const fs::path& file, const std::string& text) {
  files_.push_back(file);
  errno = 0;
  std::ofstream stream{part_of(file), std::ios::binary};
  stream << text;
  stream.close();
  if (!stream) fail(file, {errno, std::generic_category()});
}

void Replacements::commit() {
  std::error_code error;
  for (const auto& file : removed_) fs::remove(file, error);
  for (const auto& file : files_) {
    fs::rename(part_of(file), file, error);
    if (error) fail(file, error);
  }
  files_.clear();
}

void replace_file(const fs::path& file, const std::string& text) {
  Replacements one;
  one.add(file, text);
  one.commit();
}

}  // namespace rths
