// SPDX-License-Identifier: Apache-2.0
#include <rths/launch/running_test.hpp>

#include <fcntl.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>

#include "launcher.hpp"

namespace rths::launch {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr auto kStart = std::chrono::seconds{5};  // of the nodes of a test, usually one second
constexpr auto kNap = std::chrono::milliseconds{50};

// Whether an open file of a process is open for writing.
bool is_written(int process, const std::string& descriptor) {
  std::ifstream info{fmt::format("/proc/{}/fdinfo/{}", process, descriptor)};
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("flags:"))
      return (std::stoul(line.substr(6), nullptr, 8) & static_cast<unsigned>(O_ACCMODE)) !=
             static_cast<unsigned>(O_RDONLY);
  return false;
}

// The HDF5 file that a process writes, if it has its name already.
std::optional<fs::path> recording_of(const broker::Occupant& occupant, const std::string& ring) {
  std::error_code problem;
  const fs::directory_iterator open{fmt::format("/proc/{}/fd", occupant.pid), problem};
  if (problem && problem != std::errc::no_such_file_or_directory)
    throw Error{
        fmt::format("{} of ring '{}' ({}): its files cannot be seen ({}), expected a "
                    "process of this user",
                    occupant.node, ring, occupant.process, problem.message())};
  for (const auto& link : open) {
    const fs::path file = fs::read_symlink(link.path(), problem);
    if (problem || !is_written(occupant.pid, link.path().filename().string())) continue;
    if (recording::is_hdf5(file) && file.extension() != ".new") return file;
  }
  return std::nullopt;
}

std::optional<RunningTest> recorded_test(const broker::RingReport& report, int launcher) {
  for (const auto& occupant : report.occupants) {
    if (!occupant.alive || !occupant.has_pid_here || occupant.pid == launcher) continue;
    if (auto file = recording_of(occupant, report.name))
      return RunningTest{launcher, occupant.pid, std::move(*file)};
  }
  return std::nullopt;
}

}  // namespace

int launcher_on(const std::string& ring) {
  const auto report = broker::inspect_ring(ring);
  const broker::Occupant* launcher = report && report->usable ? launcher_of(*report) : nullptr;
  return launcher == nullptr ? 0 : launcher->pid;
}

RunningTest find_running_test(const std::string& ring) {
  for (const auto until = steady_clock::now() + kStart;; std::this_thread::sleep_for(kNap)) {
    const auto report = inspect_run(ring);
    const broker::Occupant launcher = known_launcher(report);
    if (!launcher.has_pid_here)
      throw Error{fmt::format("the run on ring '{}' has {}, expected a run in this PID namespace",
                              ring, launcher.process)};
    if (auto test = recorded_test(report, launcher.pid)) return std::move(*test);
    if (steady_clock::now() > until)
      throw Error{
          fmt::format("ring '{}' has no recorder on this host: expected a test that writes "
                      "its recording here",
                      ring)};
  }
}

}  // namespace rths::launch
