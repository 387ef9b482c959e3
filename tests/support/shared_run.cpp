// SPDX-License-Identifier: Apache-2.0
#include "shared_run.hpp"

#include <fstream>

#include "files.hpp"

namespace rths::test {

namespace fs = std::filesystem;

SharedRun::SharedRun(const std::string& name)
    : path_{build_tree() / "shared_runs" / name}, standard_output_{path_.string() + ".out"} {}

Finished SharedRun::make(const std::vector<std::string>& options) const {
  constexpr double kDeadline = 110;  // shorter than ctest's [s]
  fs::remove_all(path_);
  fs::remove(standard_output_);
  fs::create_directories(path_.parent_path());
  std::vector<std::string> arguments{
      "run",     (source_tree() / "examples" / kSharedExample).string(),
      "--clock", "virtual",
      "--out",   path_.string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const Finished finished = run_rths(arguments, kDeadline);
  if (finished.exit_code == 0) std::ofstream{standard_output_} << finished.out;
  return finished;
}

bool SharedRun::is_made() const { return fs::exists(standard_output_); }

std::string SharedRun::standard_output() const { return content_of(standard_output_); }

}  // namespace rths::test
