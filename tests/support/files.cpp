// SPDX-License-Identifier: Apache-2.0
#include "files.hpp"

#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>

namespace rths::test {

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "rths_test_XXXXXX").string();
  path_ = mkdtemp(pattern.data());
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::filesystem::path TemporaryFolder::write(const std::string& name,
                                             const std::string& content) const {
  const auto file = path_ / name;
  std::ofstream{file, std::ios::binary} << content;
  return file;
}

std::filesystem::path source_tree() { return RTHS_SOURCE_TREE; }
std::filesystem::path build_tree() { return RTHS_BUILD_TREE; }

std::string content_of(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  return {std::istreambuf_iterator<char>{stream}, {}};
}

}  // namespace rths::test
