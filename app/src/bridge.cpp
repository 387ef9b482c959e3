// SPDX-License-Identifier: Apache-2.0
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <mutex>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/message.hpp>
#include <rths/dds/gateway.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

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

volatile std::sig_atomic_t bridge_ends = 0;  // NOLINT: for the signal handler
extern "C" void end_bridge(int) { bridge_ends = 1; }

std::string text_of(const dds::GatewayCounts& c) {
  return fmt::format(
      "sent {} updates in {} frames, received {}; {} missing and asked for again, {} repeated, {} "
      "snapshots, {} images differed, {} bad frames, {} times behind a journal, {} interrupts "
      "sent, {} lost, held off {:.1f} ms, joined the network anew {} times",
      c.updates_sent, c.frames_sent, c.updates_received, c.gaps, c.repeated, c.snapshots,
      c.mismatches, c.bad_frames, c.lapped, c.interrupts_sent, c.interrupts_lost,
      1e-6 * static_cast<double>(c.hold_off_ns), c.rejoins);
}

/// A ring that the gateway creates, if it is asked to, and removes at its end.
class OwnRing {
 public:
  explicit OwnRing(const BridgeArguments& arguments) : name_{arguments.ring} {
    if (!arguments.map.empty())
      ring_.emplace(broker::Ring::create(name_, memmap::load_map(rths::find_map(arguments.map))));
  }
  ~OwnRing() {
    if (ring_) broker::remove_ring(name_);
  }
  OwnRing(const OwnRing&) = delete;
  OwnRing& operator=(const OwnRing&) = delete;

 private:
  std::string name_;
  std::optional<broker::Ring> ring_;
};

/// A lock of the ring's object: one gateway per ring and domain. The kernel releases it when this
/// process ends.
class OneGateway {
 public:
  OneGateway(const std::string& ring, std::uint32_t domain)
      : object_{shm_open(("/rths." + ring).c_str(), O_RDWR, 0)} {
    if (object_ < 0 && errno == ENOENT) throw Error{fmt::format("there is no ring '{}'", ring)};
    if (object_ < 0)
      throw Error{fmt::format("ring '{}' cannot be opened: {}", ring, std::strerror(errno))};
    constexpr off_t kBehindTheRing = off_t{1} << 40;
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_start = kBehindTheRing + domain;
    lock.l_len = 1;
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
    if (fcntl(object_, F_OFD_SETLK, &lock) == 0) return;
    close(object_);
    throw Error{
        fmt::format("ring '{}' has a gateway to domain {} already, expected one", ring, domain)};
  }
  ~OneGateway() { close(object_); }
  OneGateway(const OneGateway&) = delete;
  OneGateway& operator=(const OneGateway&) = delete;

 private:
  int object_;
};

int bridge(const BridgeArguments& arguments) {
  struct sigaction action {};
  action.sa_handler = end_bridge;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  std::mutex output;
  const auto report = [&](const std::string& line) {
    const std::lock_guard lock{output};
    write_message(fmt::format("rths: {}\n", line));
  };
  dds::CycloneOptions network;
  network.domain = arguments.domain;
  network.interface = arguments.interface;
  network.peers = arguments.peers;
  network.ring = arguments.joint_name.empty() ? arguments.ring : arguments.joint_name;
  network.host = arguments.host;
  dds::GatewayOptions options;
  options.host = arguments.host;
  options.report = report;
  options.skips_unchanged = arguments.skips_unchanged;
  const OwnRing own_ring{arguments};
  const OneGateway one{arguments.ring, arguments.domain};
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

std::string this_host() {
  utsname host{};
  return uname(&host) == 0 ? host.nodename : "host";
}

}  // namespace

void add_bridge(CommandLine& line) {
  auto [command, a] =
      line.add("bridge", "Connect a ring with those of the same name on other hosts", bridge,
               [](BridgeArguments& given) {
                 if (given.host.empty()) given.host = this_host();
               });
  command->add_option("ring", a.ring, "Name of a ring of this host")->required();
  command->add_option("--map", a.map, "Create the ring with this map; it is removed at the end");
  command->add_option("--domain", a.domain, "DDS domain")
      ->check(CLI::Range(0, 230))
      ->capture_default_str();
  command->add_option("--interface", a.interface,
                      "Network interface or address [Cyclone DDS chooses]");
  repeatable(command->add_option(
      "--peer", a.peers, "Address of another host, for networks without multicast; repeatable"));
  command->add_option("--host", a.host, "Name of this host [its network name]");
  command->add_flag("--skip-unchanged", a.skips_unchanged,
                    "Do not send writes that leave a word as it was");
  command->add_option("--as", a.joint_name, "Name of the ring on all hosts [the ring's]");
  command->add_option("-T,--timeout", a.timeout_ms, "Stop after this time [ms]")
      ->check(not_negative());
}

}  // namespace rths::app
