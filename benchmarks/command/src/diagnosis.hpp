// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace rths::bench {

/// Options of the blind trial, which is a program in Python.
struct DiagnosisOptions {
  int cases = 400;                    ///< of all families together
  std::vector<std::string> families;  ///< empty: all
  std::optional<std::uint64_t> seed;  ///< none: from the commit
  std::string out;     ///< folder of cases and verdicts; empty: out/bench/diagnosis-<seed>
  std::string data;    ///< folder of recordings; empty: ../shared/data
  std::string python;  ///< with OpenSees and NumPy; empty: none
  bool peers = true;   ///< also runs SINDy and FROLS on the cases
  std::optional<int> peer_cases;   ///< the first cases, which the peers get; none: all
  std::optional<double> required;  ///< share of the detectable cases that must be right
  std::filesystem::path programs;  ///< folder of `rths`
};

/// Becomes the program that makes cases with concealed effects, diagnoses them and scores the
/// verdicts. It exits with 0 if all detectable cases are right, 1 if one is wrong, 2 if one could
/// not be made or diagnosed, or if fewer than the required share are right.
/// @param results  file; empty: none
/// @throws Error if it cannot start, or results may not be written to the file
[[noreturn]] void become_trial(const DiagnosisOptions& options, const std::string& results);

}  // namespace rths::bench
