// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/command_line/write_file.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/recording/excerpt.hpp>
#include <rths/recording/recording.hpp>
#include <rths/session/folder.hpp>

#include "command.hpp"
#include "patterns.hpp"

namespace rths::app {
namespace {

struct DumpArguments {
  std::string ring_or_recording;      ///< name of a ring, or file of a recording
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell
  std::string format = "text";        ///< text, json or csv
  bool once = false;                  ///< print current values only, not changes
  long count = 0;                     ///< stop after this many lines; 0: no limit
  long timeout_ms = 0;                ///< stop after this time; 0: never
};

using std::chrono::milliseconds;
using std::chrono::steady_clock;

constexpr milliseconds kScanPeriod{1};

/// Prints values in the requested format up to the requested number of lines. Seven digits are
/// the precision of a word of the ring.
class Printer {
 public:
  explicit Printer(const DumpArguments& arguments) : arguments_{arguments} {
    if (arguments.format == "csv") fmt::print("time_s,signal,value,unit\n");
  }
  void print(double time, const std::string& name, double value, const std::string& unit) {
    if (enough()) return;
    ++lines_;
    if (arguments_.format == "json")
      fmt::print("{{\"time_s\": {:.9f}, \"signal\": \"{}\", \"value\": {}, \"unit\": \"{}\"}}\n",
                 time, name, std::isfinite(value) ? fmt::format("{:.7g}", value) : "null", unit);
    else if (arguments_.format == "csv")
      fmt::print("{:.9f},{},{:.7g},{}\n", time, name, value, unit);
    else
      fmt::print("({:.9f}) {} = {:.7g} {}\n", time, name, value, unit == "1" ? "" : unit);
  }
  [[nodiscard]] bool enough() const { return arguments_.count > 0 && lines_ >= arguments_.count; }

 private:
  const DumpArguments& arguments_;
  long lines_ = 0;
};

/// A watched word and its last value.
struct Watched {
  const memmap::SignalEntry* entry;
  memmap::Codec codec;
  std::optional<std::uint32_t> last;
};

// Prints words that changed since the last scan, in the map's units.
void print_changes(const broker::Node& node, std::vector<Watched>& watched, double time,
                   Printer& printer) {
  for (auto& word : watched) {
    const std::uint32_t now = node.read(word.entry->signal->offset);
    if (word.last == now) continue;
    word.last = now;
    printer.print(time, word.entry->name, word.codec.from_si(word.codec.decode(now)),
                  word.entry->signal->unit);
  }
}

int dump_ring(const DumpArguments& arguments) {
  broker::Ring ring = broker::Ring::attach(arguments.ring_or_recording);
  const broker::Node node = ring.observe();
  std::vector<Watched> watched;
  for (const auto* entry : selected_signals(ring, arguments.ring_or_recording, arguments.patterns))
    watched.push_back({entry, memmap::Codec{*entry->signal}, std::nullopt});
  Printer printer{arguments};
  const auto begun = steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(steady_clock::now() - begun); };
  do {
    print_changes(node, watched, elapsed().count(), printer);
    std::fflush(stdout);
    if (arguments.once || printer.enough() || std::ferror(stdout) != 0) return kOk;
    std::this_thread::sleep_for(kScanPeriod);
  } while (arguments.timeout_ms == 0 || elapsed() < milliseconds{arguments.timeout_ms});
  // Fewer changes than requested: the condition is not met.
  return arguments.count > 0 ? kConditionNotMet : kOk;
}

/// A signal of a recording.
struct Column {
  std::string name, unit;
  std::vector<double> values;
};

// The unit in which `rths dump` prints the word on the ring. Others are recorded in SI alone.
Column in_map_unit(Column column, const memmap::Map& map) {
  const auto found = map.find_signal(column.name);
  if (!found) return column;
  const memmap::Signal& signal = *map.entry(*found).signal;
  const memmap::Codec codec{signal};
  for (double& value : column.values) value = codec.from_si(value);
  column.unit = signal.unit;
  return column;
}

int dump_recording(const DumpArguments& arguments) {
  for (const auto& [is_given, option] :
       {std::pair{arguments.once, "--once"}, std::pair{arguments.timeout_ms > 0, "--timeout"}})
    if (is_given)
      throw Error{
          fmt::format("{}: found {} with a recording, which does not change, expected a ring",
                      arguments.ring_or_recording, option)};
  const recording::Reader reader{session::recording_in(arguments.ring_or_recording)};
  std::vector<Column> columns;
  for (const auto& name : selected(reader.names(), arguments.patterns, arguments.ring_or_recording))
    columns.push_back(in_map_unit({name, reader.unit(name), reader.signal(name)}, reader.map()));
  Printer printer{arguments};
  for (std::size_t row = 0; row < reader.rows() && !printer.enough(); ++row)
    for (const auto& column : columns)
      if (row < column.values.size())
        printer.print(reader.time()[row], column.name, column.values[row], column.unit);
  return kOk;
}

int dump(const DumpArguments& arguments) {
  return std::filesystem::exists(arguments.ring_or_recording) ? dump_recording(arguments)
                                                              : dump_ring(arguments);
}

struct ExportArguments {
  std::string recording;              ///< file, or folder of a run
  std::vector<std::string> patterns;  ///< signal names; * and ? as in a shell; empty: all
  double from = -std::numeric_limits<double>::infinity();  ///< first time [s]
  double to = std::numeric_limits<double>::infinity();     ///< last time [s]
  std::string format = "csv";                              ///< csv or mat
  std::string out;  ///< file; empty: name of the recording, in the current folder
};

int export_table(const ExportArguments& arguments) {
  const std::filesystem::path source = session::recording_in(arguments.recording);
  const recording::Reader reader{source};
  const std::filesystem::path target =
      arguments.out.empty() ? source.stem().string() + "." + arguments.format : arguments.out;
  std::error_code ignored;
  if (std::filesystem::equivalent(source, target, ignored))
    throw Error{target.string() + ": is the recording itself, expected another file (--out)"};
  check_result_file(target);
  const Interruptible interruptible;
  const auto excerpt =
      recording::make_excerpt(reader, selected(reader.names(), arguments.patterns, source.string()),
                              arguments.from, arguments.to);
  if (arguments.format == "mat")
    recording::write_mat(excerpt, target);
  else
    recording::write_csv(excerpt, target);
  fmt::print("table     {}\n{} rows of {} signals, {:.3f} to {:.3f} s\n", target.string(),
             excerpt.time.size(), excerpt.names.size(), excerpt.time.front(), excerpt.time.back());
  return kOk;
}

}  // namespace

void add_dump(CommandLine& line) {
  auto [command, a] =
      line.add("dump", "Print the words of a ring, or the rows of a recording", dump);
  command->add_option("source", a.ring_or_recording, "Name of a ring, or file of a recording")
      ->required();
  command->add_option("signals", a.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--format", a.format)->check(CLI::IsMember({"text", "json", "csv"}));
  command->add_flag("--once", a.once, "Print current values of a ring, not changes");
  command->add_option("-n,--count", a.count, "Stop after this number of lines")
      ->check(not_negative());
  command->add_option("-T,--timeout", a.timeout_ms, "Stop after this time [ms]")
      ->check(not_negative());
}

void add_export(CommandLine& line) {
  auto [command, a] =
      line.add("export", "Write signals of a recording as a table: one row per time, SI units",
               export_table);
  command->add_option("recording", a.recording, "Recording, or folder of a run")->required();
  command->add_option("--signals", a.patterns, "Signal names; * and ? as in a shell [all]");
  command->add_option("--from", a.from, "First time [s]");
  command->add_option("--to", a.to, "Last time [s]");
  command->add_option("--format", a.format)->check(CLI::IsMember({"csv", "mat"}));
  command->add_option("--out", a.out, "File [name of the recording, in this folder]");
}

}  // namespace rths::app
