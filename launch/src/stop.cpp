// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <csignal>
#include <fstream>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/launch/run.hpp>

#include "interrupt.hpp"
#include "launcher.hpp"

namespace rths::launch {
namespace {

// Whether a process handles the stop signal. Only the launcher of a run does; the signal would end
// any other program that has created a ring.
bool handles_stop(int process) {
  std::ifstream status{fmt::format("/proc/{}/status", process)};
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("SigCgt:"))
      return (std::stoull(line.substr(line.find_first_not_of("\t ", 7)), nullptr, 16) >>
                  (kStopSignal - 1) &
              1U) != 0;
  return false;
}

}  // namespace

const broker::Occupant* launcher_of(const broker::RingReport& report) {
  const auto launcher = std::find_if(
      report.occupants.begin(), report.occupants.end(), [](const broker::Occupant& occupant) {
        return occupant.node == "creator" && occupant.alive &&
               !(occupant.has_pid_here && !handles_stop(occupant.pid));
      });
  return launcher == report.occupants.end() ? nullptr : &*launcher;
}

broker::RingReport inspect_run(const std::string& ring) {
  auto report = broker::inspect_ring(ring);
  if (!report)
    throw Error{fmt::format("there is no ring '{}': expected the ring of a running test", ring)};
  if (!report->usable) throw Error{report->trouble};
  return std::move(*report);
}

broker::Occupant known_launcher(const broker::RingReport& report) {
  const broker::Occupant* launcher = launcher_of(report);
  if (launcher == nullptr)
    throw Error{
        fmt::format("ring '{}' has no launcher: expected the ring of a running test", report.name)};
  return *launcher;
}

int request_stop(const std::string& ring) {
  const broker::Occupant launcher = known_launcher(inspect_run(ring));
  if (!launcher.has_pid_here)
    throw Error{fmt::format("the run on ring '{}' has {}: ask it to end in that namespace", ring,
                            launcher.process)};
  if (kill(launcher.pid, kStopSignal) != 0)
    throw Error{
        fmt::format("process {} cannot be asked to end the run on ring '{}'", launcher.pid, ring)};
  return launcher.pid;
}

}  // namespace rths::launch
