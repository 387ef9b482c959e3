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
  std::vector<std::string> improvements;  ///< files that a diagnosis wrote, for the model
  bool diagnoses = true;                  ///< if there is a second earthquake to prove it on
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

struct LoopArguments {
  std::string bearing;     ///< file, or name of one that comes along
  double amplitude = 0.2;  ///< [m]
  double frequency = 0.3;  ///< [Hz]
  int cycles = 3;          ///< full ones
  double axial_load = 0;   ///< [N]; 0: a bearing's share of the example plant
  std::string svg, csv;    ///< files to write; empty: none
  Changes changes;
};
/// Drives a bearing through a loop, tells its numbers and draws it.
[[nodiscard]] int loop(const LoopArguments& arguments);

struct TermsArguments {
  std::vector<std::string> names;  ///< empty: all
  bool markdown = false;
  std::string draw;  ///< folder to draw them into; empty: text instead
};
/// The catalogue of terms.
[[nodiscard]] int terms(const TermsArguments& arguments);

struct BearingBenchArguments {
  int passes = 9;
  int steps = 30'000;    ///< of each pass
  std::string opensees;  ///< Python that has OpenSees; empty: the one of the tests, if there is one
  bool json = false;
};
/// 0 if every goal is met, 1 if this machine cannot tell, 2 if a goal is missed.
[[nodiscard]] int bench_bearings(const BearingBenchArguments& arguments);

struct OpenseesBenchArguments {
  int cycles = 9;
  int round_trips = 2'000;  ///< of each kind in each cycle
  bool json = false;
};
/// 0 if the way there and back holds, 1 if this machine cannot tell, 2 if it does not.
[[nodiscard]] int bench_opensees(const OpenseesBenchArguments& arguments);

struct DiagnoseArguments {
  std::string source;                ///< folder of a case, or a recording
  std::string out;                   ///< folder; empty: out/diagnosis/<name of the case>
  std::string against;               ///< what another simulation predicted; empty: the model does
  std::vector<std::string> without;  ///< terms that may not be named
  std::uint64_t seed = 1;            ///< of draws of noise and of resampling
};
/// Finds the physics that a simulation left out; 0 whatever the verdict is.
[[nodiscard]] int diagnose(const DiagnoseArguments& arguments);

[[nodiscard]] int map_check(const std::string& file);
[[nodiscard]] int map_gen(const std::string& file, const std::string& language);
[[nodiscard]] int report(const std::string& folder);
[[nodiscard]] int doctor();
[[nodiscard]] int clean();

/// The program's version, for recordings.
[[nodiscard]] std::string version();

}  // namespace rths::app
