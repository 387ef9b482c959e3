// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/command_line/program.hpp>
#include <rths/session/diagnose.hpp>
#include <rths/session/run.hpp>

namespace rths::app {

/// Changes to an experiment file: dotted key, value.
using Changes = std::vector<std::pair<std::string, std::string>>;

struct RunArguments {
  session::RunSettings settings;
  bool json = false;
};
[[nodiscard]] int run(const RunArguments& arguments);

struct NodeArguments {
  std::string experiment, node, ring, recording;
  Changes changes;
};
[[nodiscard]] int node(const NodeArguments& arguments);

struct CheckArguments {
  std::string file;     ///< or "server"
  std::string address;  ///< of a server: HOST:PORT
  std::string config;   ///< file with the `config` of a plugin; empty: none
  bool udp = false;     ///< of a server, as the next two
  int dofs = 1;
  double amplitude = 0;  ///< of trials, in the server's units
  Changes changes;       ///< of an experiment
};
[[nodiscard]] int check(const CheckArguments& arguments);
[[nodiscard]] int check_plugin(const std::string& file, const std::string& config);
[[nodiscard]] int check_fmu(const std::string& file, const std::string& config);
[[nodiscard]] int check_server(const CheckArguments& arguments);

/// @param kept  folder for logs and recordings of failed tests
[[nodiscard]] int test(const std::string& file, const std::string& kept);

struct NewAdapterArguments {
  std::string name;              ///< of the adapter and its folder
  std::string language = "c";    ///< c, cpp or python
  std::string role = "machine";  ///< or controller
};
[[nodiscard]] int new_adapter(const NewAdapterArguments& arguments);

struct ReplayArguments {
  std::string library;       ///< of the plugin
  std::string recording;     ///< file, or folder of a run
  std::string config;        ///< file with the `config` of the plugin; empty: none
  std::string node = "xpc";  ///< whose monitors and parameters it has
};
/// Runs a plugin on the inputs of a recording and compares its outputs.
[[nodiscard]] int replay(const ReplayArguments& arguments);

/// Of the commands before a test: delay, identify, calibrate, pretest.
struct CommissioningArguments {
  std::vector<std::string> files;  ///< recordings, or folders of runs
  bool json = false;
  std::string out;  ///< TOML file for the constants; empty: none
  // delay
  std::string target = "command", measured = "displacement";  ///< roles, or names of signals
  double window = 2, search = 0.2;                            ///< [s]
  double least_rms = 5e-4;  ///< of the target's motion, in its unit
  // identify empty-table
  double load = std::numeric_limits<double>::quiet_NaN();  ///< [N]; NaN: that of the recordings
  std::string block = "observer", observer = "force_observer";
  std::string inverse = "inverse";  ///< block of `identify inverse`
  // calibrate
  std::vector<double> band{0.1, 3};  ///< [Hz]
  double feed_forward_share = 1.0 / 3;
  // pretest
  std::string machine;            ///< recording of the machine; empty: the virtual one
  std::vector<std::string> sets;  ///< key=value
};
/// Splits "key=value". @throws CLI::ValidationError
[[nodiscard]] Changes split_changes(const std::vector<std::string>& sets);
/// Adds the commands before a test.
void add_commissioning(CLI::App& app, CommissioningArguments& arguments, Chosen& chosen);

struct DumpArguments {
  std::string ring_or_recording;      ///< name of a ring, or file of a recording
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell
  std::string format = "text";        ///< text, json or csv
  bool once = false;                  ///< print current values only, not changes
  long count = 0;                     ///< stop after this many lines; 0: no limit
  long timeout_ms = 0;                ///< stop after this time; 0: never
};
[[nodiscard]] int dump(const DumpArguments& arguments);

struct WhoArguments {
  std::string ring;
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell
  std::string format = "text";        ///< text or json, one object per line
};
struct ExportArguments {
  std::string recording;              ///< file, or folder of a run
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell; empty: all
  double from = -std::numeric_limits<double>::infinity();  ///< first time [s]
  double to = std::numeric_limits<double>::infinity();     ///< last time [s]
  std::string format = "csv";                              ///< csv or mat
  std::string out;  ///< file; empty: name of the recording, in the current folder
};
/// Writes signals of a recording as a table with one row per time.
[[nodiscard]] int export_table(const ExportArguments& arguments);

/// Prints the last writer and write time of words.
[[nodiscard]] int who(const WhoArguments& arguments);

struct WatchArguments {
  std::string ring;
  long period_us = 50;  ///< between two scans
  long timeout_ms = 0;  ///< stop after this time; 0: never
};
/// Journals stores of clients that bypass the API; prints stores into other nodes' words.
[[nodiscard]] int watch(const WatchArguments& arguments);

struct BridgeArguments {
  std::string ring;
  std::string joint_name;  ///< of the ring on all hosts; empty: `ring`
  std::string map;         ///< of a new ring, removed at the end; empty: the ring exists
  std::string host;        ///< name of this host
  std::uint32_t domain = 0;
  std::string interface;           ///< empty: the network's default
  std::vector<std::string> peers;  ///< empty: found by multicast
  bool skips_unchanged = false;    ///< does not send writes that leave a word as it was
  long timeout_ms = 0;             ///< stop after this time; 0: never
};
/// Connects a ring with those of the same name on other hosts, over DDS.
[[nodiscard]] int bridge(const BridgeArguments& arguments);

struct SendArguments {
  std::string ring;
  std::vector<std::string> assignments;  ///< name=value; optional unit, default the map's
};
[[nodiscard]] int send(const SendArguments& arguments);

struct LoopArguments {
  std::string bearing;     ///< file, or name of a built-in bearing
  double amplitude = 0.2;  ///< [m]
  double frequency = 0.3;  ///< [Hz]
  int cycles = 3;          ///< at full amplitude
  double axial_load = 0;   ///< [N]; 0: weight per bearing of the example plant
  std::string svg, csv;    ///< files to write; empty: none
  Changes changes;
};
/// Drives a bearing through loops; prints a table per cycle, draws and writes the loop.
[[nodiscard]] int loop(const LoopArguments& arguments);

struct RingArguments {
  std::string source;  ///< scenario; of `show` also the name of a ring
  std::string out;     ///< file of the trace; empty: named after the scenario, in this folder
  std::optional<double> at_us;  ///< time of the picture [µs]; empty: the end
};
/// Writes every hop of a scenario as Chrome trace events.
[[nodiscard]] int ring_trace(const RingArguments& arguments);
/// Draws ring, nodes and registers of a scenario, or of a ring in shared memory.
[[nodiscard]] int ring_show(const RingArguments& arguments);

struct FaultArguments {
  std::string ring;
  std::vector<std::string> keys;  ///< key=value, as in a [[fault]] of an experiment
};
/// Causes a fault of the cards of a running replicated ring.
[[nodiscard]] int fault(const FaultArguments& arguments);

struct TermsArguments {
  std::vector<std::string> names;  ///< empty: all
  std::string format = "text";     ///< text, markdown, or json, one object per line
  std::string draw;                ///< folder for drawings; empty: print text
};
/// Prints or draws the catalogue of terms.
[[nodiscard]] int terms(const TermsArguments& arguments);

/// Becomes rths-bench, the program of the benchmarks beside this one, if the words are `bench …` or
/// complete such words. @throws Error if it is not there
void become_bench(const std::vector<std::string>& words);

struct DiagnoseArguments {
  session::DiagnoseSettings settings;
  bool progress = false;  ///< show the progress also off a terminal
  bool plans = false;     ///< print what the case can tell, without a diagnosis
  bool json = false;
};
/// Finds the physics that a simulation omits. @returns 0 for every verdict
[[nodiscard]] int diagnose(const DiagnoseArguments& arguments);

[[nodiscard]] int map_list();
[[nodiscard]] int map_check(const std::string& file);
[[nodiscard]] int map_gen(const std::string& file, const std::string& language);
[[nodiscard]] int report(const std::string& folder, const std::string& beside);
/// Ends the run on a ring in order.
[[nodiscard]] int stop(const std::string& ring);
struct DoctorArguments {
  std::string format = "text";          ///< text or json: a line per ring, and one about real time
  std::optional<std::uint32_t> domain;  ///< of DDS: examines the network instead
  std::string interface;
  std::vector<std::string> peers;
};
[[nodiscard]] int doctor(const DoctorArguments& arguments);
/// Interfaces of this host, gateways of the domain and their clocks; advice.
/// @returns 0 if a gateway answered, otherwise 1
[[nodiscard]] int doctor_of_network(const DoctorArguments& arguments);
/// Removes rings.
/// @param rings  empty: those that no process uses, without idle cards
[[nodiscard]] int clean(const std::vector<std::string>& rings);

/// Of the commands on rings.
struct RingCommandArguments {
  DumpArguments dump;
  WhoArguments who;
  WatchArguments watch;
  SendArguments send;
  BridgeArguments bridge;
  RingArguments ring;
  FaultArguments fault;
  DoctorArguments doctor;
  std::string stopped;               ///< name of a run's ring
  std::vector<std::string> removed;  ///< names of rings
};
/// Adds `dump`, `who`, `watch`, `send`, `bridge`, `ring`, `fault`, `stop`, `doctor` and `clean`.
void add_ring_commands(CLI::App& app, RingCommandArguments& arguments, Chosen& chosen);

/// Prints what is unusual about an experiment, a line each on standard error.
/// @throws Error if it is implausible
void check_sizes(const experiment::Experiment& experiment);

/// Version of the program, for recordings.
[[nodiscard]] std::string version();

}  // namespace rths::app
