// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/launch/experiment.hpp>

namespace rths::launch {

/// An adapter and where and when it runs.
struct Station {
  NodePlan plan;
  std::unique_ptr<adapters::Adapter> adapter;
};

/// Everything that takes part in a test: the stations, and the ring's map with a place for each of
/// their monitors and parameters behind the laboratory's own words.
struct Assembly {
  memmap::Map map;
  std::vector<Station> stations;
};

/// Where a run's recording goes, and what is written into its /meta.
struct RecordingPlan {
  std::filesystem::path file;
  recording::NamedTexts meta;
};

/// Builds all adapters of an experiment. Every process of a run does so and so finds the same map.
/// @throws Error   @setup
[[nodiscard]] Assembly assemble(const Experiment& experiment, ClockKind clock,
                                const RecordingPlan& recording);

/// Node of the map that may write parameters; nobody's program, a person's hand.
inline constexpr const char* kOperator = "operator";

}  // namespace rths::launch
