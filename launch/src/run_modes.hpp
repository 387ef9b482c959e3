// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/adapter_runner.hpp>
#include <rths/broker/ring.hpp>
#include <rths/experiment/node.hpp>
#include <rths/launch/run.hpp>
#include <rths/recording/foreign_stores.hpp>
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

/// Content of /meta at the start of a recording.
[[nodiscard]] recording::NamedTexts describe_run(const Experiment& experiment, ClockKind clock,
                                                 const std::string& version);

/// The ring that a node joins: on a replicated ring, its own image.
[[nodiscard]] std::string ring_of(const Experiment& experiment, const std::string& ring,
                                  const std::string& node);

/// Longest time from a stop request to the exit of a node: the longest stop, and a second for the
/// recorder and for peers that stop later.
[[nodiscard]] Duration longest_stop(const Experiment& experiment);

/// Why a run is ended whose solver does not end it.
[[nodiscard]] std::string late_end(const Experiment& experiment, double now);

/// Removes the name of the ring at the end of a run, and the file of a recorder that died while it
/// created the file.
struct RunCleaning {
  const RunOptions& options;
  ~RunCleaning() {
    broker::remove_ring(options.ring);
    recording::remove_unfinished(options.recording);
  }
};

/// Wake-up latency of the host during a run: the largest of each interval.
struct HostLateness {
  double interval = 0;          ///< [s]
  std::vector<double> largest;  ///< [s]
};

struct RunEnd {
  std::string trouble;  ///< empty if none
  bool interrupted = false;
  bool stopped_early = false;  ///< by request, in order
  HostLateness lateness;
  std::map<std::string, adapters::StepTimes> times;     ///< by node; some or none
  std::vector<std::string> privileges;                  ///< missing privileges, one line per node
  std::string faults;                                   ///< of the cards, on purpose; empty if none
  std::vector<recording::ForeignStore> foreign_stores;  ///< of the words of this host
};
[[nodiscard]] RunEnd run_in_wall_time(const Experiment& experiment, const Assembly& assembly,
                                      const RunOptions& options);
[[nodiscard]] RunEnd run_in_virtual_time(const Experiment& experiment, Assembly& assembly,
                                         const RunOptions& options);

/// Names the faults of the cards in the result of a run; a run that ended early gives them as its
/// cause.
void add_faults(const std::vector<std::string>& events, RunEnd& result);

/// Makes a node await the steps of others on its host: a controller those of a simulated machine,
/// and the machine those of the controller if their time waits. None on cards, whose words are
/// under way for a while.
void await_others(const Experiment& experiment, const NodePlan& plan,
                  adapters::AdapterRunner& runner, broker::Ring& ring);
/// The nodes that it awaits.
[[nodiscard]] std::vector<const NodePlan*> awaited_by(const Experiment& experiment,
                                                      const NodePlan& plan);

/// Steps of a node in the longest run of an experiment, slow-downs included.
[[nodiscard]] std::size_t steps_of(const Experiment& experiment, const NodePlan& plan);

/// Gives the calling thread real-time scheduling alone. @returns 0, or the error number
int prefer_realtime(int priority);

/// Priorities within a run: the host probe has the highest; those of the nodes are in NodeSettings.
inline constexpr int kProbePriority = 70;
inline constexpr int kGatewayPriority = 20;  ///< of a test on several hosts

/// Name of the ring of a run, and the file of its recording.
struct RunPlace {
  std::string ring;
  std::filesystem::path recording;
};

/// Runs the process that stands for a foreign node: starts its program, or asks the user to, and is
/// ready when the program is on the ring. Watches the program, its peers and the launcher; ends the
/// program after the retreat of the others.
/// @returns exit code of the process   @throws Error if the program does not join the ring   @setup
[[nodiscard]] int run_foreign_node(const Experiment& experiment, const NodePlan& plan,
                                   broker::Ring& ring, const RunPlace& place);

/// State of a test on one host. The launchers of several hosts run one test together through words
/// that cross hosts like all words of the ring.
enum class HostState : std::uint32_t {
  Absent,    ///< not started
  Starting,  ///< its nodes, or those of other hosts, are not ready
  Ready,     ///< has all nodes of the test on its ring
  Going,     ///< of the leading host: has set the time zero
  Stopping,  ///< brings its nodes to rest
  Completed,
  Failed,
  StoppedEarly  ///< brings its nodes to rest on request, before the end of the test
};

/// Longwords of a launcher: state, time zero (2), fingerprint (2), length of the text, text.
inline constexpr std::uint32_t kLauncherLongwords = 64;

[[nodiscard]] inline std::string launcher_partition(const std::string& host) {
  return "launcher." + host;
}
[[nodiscard]] inline std::string launcher_node(const std::string& host) {
  return "launcher_" + host;
}
/// One word: the number of steps of the node in virtual time, and whether it has ended.
[[nodiscard]] inline std::string turn_partition(const std::string& node) { return "turn." + node; }

}  // namespace rths::launch
