// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/temporary_folder.hpp>

#include <cstdlib>
#include <system_error>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths::bench {

TemporaryFolder::TemporaryFolder(const std::string& purpose) {
  std::string name = (temporary_folder() / ("rths_" + purpose + "_XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) throw Error{name + ": the folder cannot be created"};
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace rths::bench
