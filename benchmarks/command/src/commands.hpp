// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/bench/bearing_bench.hpp>
#include <rths/bench/bridge_bench.hpp>
#include <rths/bench/card_bench.hpp>
#include <rths/bench/force_bench.hpp>
#include <rths/bench/opensees_bench.hpp>
#include <rths/bench/ring_bench.hpp>
#include <rths/bench/solver_bench.hpp>
#include <rths/bench/srmd_bench.hpp>
#include <rths/bench/vertical_bench.hpp>
#include <rths/command_line/program.hpp>

#include "diagnosis.hpp"

namespace rths::bench {

/// Values of all options.
struct Arguments {
  bool json = false;  ///< one JSON document instead of text
  std::string file;   ///< for the results of a long benchmark; empty: none
  RingOptions ring;
  BearingOptions bearings;
  SolverOptions solver;
  SrmdOptions srmd;
  CardOptions card;
  OpenSeesOptions opensees;
  BridgeOptions bridge;
  DiagnosisOptions diagnosis;
  ForceOptions force;
  VerticalOptions vertical;
};

/// The commands and the one that the command line chooses.
struct Commands {
  CLI::App& bench;
  Arguments& arguments;
  app::Chosen& chosen;
};

/// Adds all benchmarks. @param to  outlives the parser
void add_benchmarks(Commands& to);

}  // namespace rths::bench
