// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <mutex>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/dds/gateway.hpp>

#include "commands.hpp"

namespace rths::app {
namespace {

volatile std::sig_atomic_t bridge_ends = 0;  // NOLINT: for the signal handler
extern "C" void end_bridge(int) { bridge_ends = 1; }

std::string text_of(const dds::GatewayCounts& c) {
  return fmt::format(
      "sent {} updates in {} frames, received {}; {} missing and asked for again, {} repeated, {} "
      "snapshots, {} images differed, {} bad frames, {} times behind a journal, held off {:.1f} ms",
      c.updates_sent, c.frames_sent, c.updates_received, c.gaps, c.repeated, c.snapshots,
      c.mismatches, c.bad_frames, c.lapped, 1e-6 * static_cast<double>(c.hold_off_ns));
}

}  // namespace

int bridge(const BridgeArguments& arguments) {
  struct sigaction action {};
  action.sa_handler = end_bridge;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  std::mutex output;
  const auto report = [&](const std::string& line) {
    const std::lock_guard lock{output};
    fmt::print(stderr, "rths: {}\n", line);
  };
  dds::CycloneOptions network;
  network.domain = arguments.domain;
  network.interface = arguments.interface;
  network.peers = arguments.peers;
  network.ring = arguments.joint_name.empty() ? arguments.ring : arguments.joint_name;
  dds::GatewayOptions options;
  options.host = arguments.host;
  options.report = report;
  options.skips_unchanged = arguments.skips_unchanged;
  const dds::Gateway gateway{arguments.ring, dds::make_cyclone_carrier(network), options};
  fmt::print("ring '{}' is open to domain {} as '{}'\n", arguments.ring, arguments.domain,
             arguments.host);
  std::fflush(stdout);
  const WallClock clock;
  const TimePoint deadline = clock.now() + std::chrono::milliseconds{arguments.timeout_ms};
  while (bridge_ends == 0 && (arguments.timeout_ms == 0 || clock.now() < deadline))
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  fmt::print("{}\n", text_of(gateway.counts()));
  return kOk;
}

}  // namespace rths::app
