// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <rths/foreign/simulation.hpp>

namespace rths::foreign {

/// Runs of one simulation: several at the same time, up to a number that the user allows. A run
/// whose results are still kept is not made again; those of the oldest runs are dropped.
class Runs {
 public:
  /// @param most  runs, at most
  Runs(std::unique_ptr<Simulation> simulation, std::size_t most);

  /// Results in the order of the requests, which does not depend on the number of processors.
  /// @throws Error if the runs are spent; Interrupted   @any_thread
  [[nodiscard]] std::vector<RunOutputs> results(const std::vector<RunInputs>& wanted);
  [[nodiscard]] RunOutputs result(const RunInputs& wanted) { return results({wanted})[0]; }

  /// Makes a run again.
  /// @throws Error if the run fails, or its outputs are other ones   @setup
  void check_repeats(const RunInputs& wanted);

  [[nodiscard]] std::size_t made() const { return made_; }
  [[nodiscard]] std::size_t most() const { return most_; }
  [[nodiscard]] double seconds() const { return seconds_; }  ///< of all runs together

 private:
  void run_all(const std::vector<const RunInputs*>& missing, std::vector<RunOutputs>& made);

  std::unique_ptr<Simulation> simulation_;
  std::size_t most_, made_ = 0;
  double seconds_ = 0;
  std::mutex mutex_;
  std::map<std::string, RunOutputs> known_;  ///< by the hash of the inputs
  std::deque<std::string> order_;            ///< of their hashes, oldest first
  std::size_t kept_ = 0;                     ///< numbers in `known_`
};

/// Runs at the same time: one for each processor of this process.
[[nodiscard]] std::size_t processors();

}  // namespace rths::foreign
