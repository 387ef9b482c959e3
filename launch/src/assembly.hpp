// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/experiment/node.hpp>
#include <rths/launch/run.hpp>
#include <rths/replicated/images.hpp>

namespace rths::launch {

/// An adapter with its node and schedule.
struct Station {
  NodePlan plan;
  std::unique_ptr<adapters::Adapter> adapter;
};

/// The stations of a test and the map of its ring: the laboratory's words, then the monitors and
/// parameters of each station.
struct Assembly {
  memmap::Map map;
  std::vector<Station> stations;
  std::optional<replicated::CardOptions> cards;  ///< of fidelity "replicated"; empty: "shared"
};

/// File of the recording, and the content of its /meta and /config.
struct RecordingPlan {
  std::filesystem::path file;
  recording::NamedTexts meta;
  recording::NamedTexts texts;  ///< needed in the process that writes the recording only
};

/// Builds all adapters of an experiment. Every process of a run does so and gets the same map.
/// @throws Error   @setup
[[nodiscard]] Assembly assemble(const Experiment& experiment, ClockKind clock,
                                const RecordingPlan& recording);

/// Node that writes the parameters. No process of a run joins as this node; `rths send` does.
inline constexpr const char* kOperator = "operator";

}  // namespace rths::launch
