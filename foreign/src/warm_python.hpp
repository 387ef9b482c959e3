// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "child.hpp"

namespace rths::foreign {

/// Interpreters of Python that have already loaded what a script imports: each run is a fork of
/// one. To load OpenSees takes longer than many of its runs.
class WarmPython {
 public:
  /// @param python  full path of the interpreter
  /// @param script  full path
  WarmPython(std::string python, std::string script);
  ~WarmPython();
  WarmPython(const WarmPython&) = delete;
  WarmPython& operator=(const WarmPython&) = delete;

  /// As `run_child` of this interpreter, several at the same time.
  /// @param arguments  script or "-c" and a text, and their arguments
  /// @returns none if there is no interpreter for it
  /// @throws Interrupted   @any_thread
  [[nodiscard]] std::optional<ChildEnding> run(const std::vector<std::string>& arguments,
                                               const std::filesystem::path& folder,
                                               double deadline);

 private:
  class Interpreter;

  std::string python_, script_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Interpreter>> idle_;
};

}  // namespace rths::foreign
