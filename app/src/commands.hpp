// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace rths::app {

/// What a command's process ends with.
enum ExitCode { kOk = 0, kConditionNotMet = 1, kFailure = 2, kUsage = 3 };

/// Changes to an experiment file: dotted key, value.
using Changes = std::vector<std::pair<std::string, std::string>>;

struct RunArguments {
  std::string experiment;
  bool virtual_time = false;
  std::string out;   ///< folder; empty: out/<name of the experiment>
  std::string ring;  ///< empty: the experiment's name
  Changes changes;
};
[[nodiscard]] int run(const RunArguments& arguments);

struct NodeArguments {
  std::string experiment, node, ring, recording;
  Changes changes;
};
[[nodiscard]] int node(const NodeArguments& arguments);

[[nodiscard]] int check(const std::string& file);

struct DumpArguments {
  std::string source;                 ///< name of a ring, or a recording
  std::vector<std::string> patterns;  ///< of signal names: * and ? as in a shell
  std::string format = "text";        ///< text, json or csv
  bool once = false;                  ///< a ring's values now, instead of its changes
  long count = 0;                     ///< lines after which to end; 0: no limit
  long timeout_ms = 0;                ///< end after this long; 0: never
};
[[nodiscard]] int dump(const DumpArguments& arguments);

/// Who wrote the words of a ring last, and when.
[[nodiscard]] int who(const std::string& ring, const std::vector<std::string>& patterns);

struct WatchArguments {
  std::string ring;
  long period_us = 50;  ///< between two looks
  long timeout_ms = 0;  ///< end after this long; 0: never
};
/// Journals what plain clients store, and tells of stores into words that are not theirs.
[[nodiscard]] int watch(const WatchArguments& arguments);

struct SendArguments {
  std::string ring;
  std::vector<std::string> assignments;  ///< name=value, with a unit if it is not the map's
};
[[nodiscard]] int send(const SendArguments& arguments);

struct BenchArguments {
  int cycles = 9;
  std::uint32_t round_trips = 50'000;
  std::uint64_t seed = 1;
  std::vector<std::string> rows;  ///< empty: all
  std::string keep;               ///< folder of finished cycles; empty: none
  bool json = false;
};
/// 0 if every gate holds, 1 if this machine cannot tell, 2 if a gate does not hold.
[[nodiscard]] int bench_ring(const BenchArguments& arguments);
[[nodiscard]] std::vector<std::string> bench_rows();

struct BearingBenchArguments {
  int passes = 9;
  int steps = 30'000;    ///< of each pass
  std::string opensees;  ///< Python that has OpenSees; empty: the one of the tests, if there is one
  bool json = false;
};
/// 0 if every goal is met, 1 if this machine cannot tell, 2 if a goal is missed.
[[nodiscard]] int bench_bearings(const BearingBenchArguments& arguments);

[[nodiscard]] int map_check(const std::string& file);
[[nodiscard]] int map_gen(const std::string& file, const std::string& language);
[[nodiscard]] int report(const std::string& folder);
[[nodiscard]] int doctor();
[[nodiscard]] int clean();

/// The program's version, for recordings.
[[nodiscard]] std::string version();

}  // namespace rths::app
