// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/message.hpp>
#include <rths/launch/run.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/session/folder.hpp>
#include <rths/testkit/play.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct PlayArguments {
  std::string recording;  ///< file, or folder of a run
  testkit::PlaySettings settings;
};

constexpr int kPlayPriority = 40;  // of a solver

int play(const PlayArguments& a) {
  testkit::PlaySettings settings = a.settings;
  settings.recording = session::recording_in(a.recording);
  const Interruptible interruptible;
  if (const auto missing = launch::make_realtime(kPlayPriority); !missing.empty())
    write_message(fmt::format("rths: {}: gaps may be inexact\n", missing));
  const auto played = testkit::play(settings, is_interrupted);
  fmt::print("{} writes on ring '{}'\n", played.writes, settings.ring);
  if (played.gap_errors.size() > 1)
    fmt::print("gaps between rows: {:.2f} % off at the median, {:.2f} % at the 99th percentile\n",
               100 * maths::quantile(played.gap_errors, 0.5),
               100 * maths::quantile(played.gap_errors, 0.99));
  if (played.ticks > 0)
    fmt::print("{} of {} ticks came before all their words were written\n", played.late_ticks,
               played.ticks);
  if (played.is_complete) return kOk;
  write_message("rths: interrupted before the end of the recording\n");
  return kConditionNotMet;
}

struct RecordArguments {
  std::string ring, file;  ///< empty file: named after the ring, in this folder
  std::optional<double> longest;
  double row = 1e-3;
};

int record(const RecordArguments& a) {
  const std::string file = a.file.empty() ? a.ring + ".h5" : a.file;
  const Interruptible interruptible;
  const WallClock clock;
  const TimePoint begun = clock.now();
  const auto recorded = testkit::record_ring(a.ring, file, a.row, [&] {
    return is_interrupted() || (a.longest && clock.now() - begun > from_seconds(*a.longest));
  });
  fmt::print("recording {}\n{} rows, {} changes of words, {} lost\n", file, recorded.rows,
             recorded.writes, recorded.missing);
  if (!recorded.foreign_store.empty())
    write_message(fmt::format("rths: {}\n", recorded.foreign_store));
  return recorded.missing == 0 && recorded.foreign_store.empty() ? kOk : kConditionNotMet;
}

}  // namespace

void add_play(CommandLine& line) {
  auto [command, a] =
      line.add("play", "Write the recorded words of nodes to a ring, as these nodes", play);
  a.settings.ring = "play";
  command->add_option("recording", a.recording, "Recording, or folder of a run")->required();
  command->add_option("--as", a.settings.nodes, "Nodes whose words are written: srmd,opf")
      ->required()
      ->delimiter(',');
  command
      ->add_option("--ring", a.settings.ring,
                   "Name of a ring in use, or of one to make with the map of the recording")
      ->capture_default_str();
  auto* rate =
      command->add_option("--rate", a.settings.rate, "Wall time over recorded time: 2 is slower")
          ->check(CLI::Range(1e-3, 1e3))
          ->capture_default_str();
  command
      ->add_option("--counter", a.settings.counter,
                   "Write the words of a tick before this counter of another node reaches it, "
                   "instead of at their times: monitor.xpc.host.step")
      ->excludes(rate);
  repeatable(command->add_option("--fault", a.settings.faults,
                                 "Fault of the writes: \"kind=flip signal=srmd.long.force.fbk "
                                 "bit=31 at_s=2 for_s=0.1\"; kind drop or delay, too"));
  command
      ->add_option("--await", a.settings.awaited,
                   "Begin when these nodes are on the ring, such as xpc")
      ->delimiter(',');
  command
      ->add_option("--await-s", a.settings.longest_wait,
                   "Longest wait for these nodes, and for each tick of the counter")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
}

void add_record(CommandLine& line) {
  auto [command, a] =
      line.add("record", "Record every write to a ring, until it ends or Ctrl-C", record);
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command->add_option("-o,--out", a.file, "New file [name of the ring, in this folder]");
  command->add_option("--for", a.longest, "End after this time [s]")->check(not_negative());
  command
      ->add_option("--row-s", a.row, "Changes of different words within this time share a row [s]")
      ->check(CLI::Range(1e-6, 1.0))
      ->capture_default_str();
}

}  // namespace rths::app
