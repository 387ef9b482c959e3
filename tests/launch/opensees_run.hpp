// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths {

using Rows = std::vector<std::vector<double>>;

/// Reads a CSV file without a heading.
[[nodiscard]] Rows read_rows(const std::filesystem::path& file);

/// Root mean square of the difference over that of the reference about its mean.
[[nodiscard]] double nrmse(const Rows& ours, const Rows& reference, std::size_t column);

/// Runs of an experiment with the real OpenSees as the solver.
class OpenSeesRun : public test::WithOpenSees<> {
 protected:
  struct ExperimentOptions {
    std::string partners;          ///< [node.…] tables of the other nodes
    std::filesystem::path script;  ///< empty: the test starts OpenSees
    std::string arguments;
    std::string axes = R"(["long"])";
    std::string map = "srmd";
    std::string element = {};  ///< lines of its table; empty: `axes` are its degrees of freedom
    std::string node = {};     ///< further lines of the node's table
  };
  /// Writes an experiment with a bilinear bearing, which all programs solve exactly.
  /// @returns its file
  [[nodiscard]] std::string experiment(const ExperimentOptions& options, double step = 0.01) const;
  [[nodiscard]] test::Finished run(const std::string& experiment, const std::string& clock) const;
  /// Response of the same script with OpenSees' own bearing.
  [[nodiscard]] Rows own_response(const std::string& bearing) const;
  [[nodiscard]] std::filesystem::path out() const { return folder_.path() / "out"; }
  [[nodiscard]] std::string plant_arguments() const;
  [[nodiscard]] Rows ring_response() const { return read_rows(out() / "run.csv"); }

  /// Of the experiment and of the analyses of `kPlant` and of the frame [s]; steps of 10 ms.
  int duration_ = test::is_long() ? 30 : 7;
  [[nodiscard]] std::size_t steps() const { return 100 * static_cast<std::size_t>(duration_); }
  static constexpr const char* kRecord = "petrolia_1992_riodell_freefield.csv";
  static constexpr const char* kPlant = "examples/opensees/isolated_plant.py";
  static constexpr const char* kMast = "tests/opensees/mast.py";
  static constexpr const char* kIdeal =
      "[node.xpc]\nadapter = \"ideal_machine\"\n[node.recorder]\nadapter = \"recorder\"\n";
  static constexpr const char* kMachine =
      "[node.srmd]\nadapter = \"srmd\"\n[node.xpc]\nadapter = \"simulink_like\"\n"
      "diagram = \"hybrid_controller\"\n[node.recorder]\nadapter = \"recorder\"\n";
  static constexpr const char* kBoth = R"(["long", "lat"])";
  test::TemporaryFolder folder_;
  std::uint16_t port_ = test::free_port();
};

}  // namespace rths
