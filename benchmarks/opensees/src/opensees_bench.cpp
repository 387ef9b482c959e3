// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/opensees_bench.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <future>

#include <fmt/format.h>

#include <rths/bench/load.hpp>
#include <rths/bench/partner.hpp>
#include <rths/bench/program.hpp>
#include <rths/bench/temporary_folder.hpp>
#include <rths/core/error.hpp>

#include "ping_pong.hpp"
#include "socket.hpp"

namespace rths::bench {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr std::size_t kDoubles = 256;  // length of a message: OpenSees' default
constexpr double kTrial = 3, kForce = 10, kEnd = 99;
constexpr int kWarmUp = 200;  // round trips
constexpr std::chrono::seconds kToStart{20}, kLongest{600};
constexpr std::uint64_t kSeed = 1;  // of the intervals

using Message = std::array<double, kDoubles>;

std::span<std::byte> bytes_of(Message& message) {
  return std::as_writable_bytes(std::span{message});
}

// A ring with two nodes: the server of an element and an echo.
std::string experiment(Transport transport, std::uint16_t port, const fs::path& motion) {
  return fmt::format(R"(format = 1
name = "round_trip"
map = "srmd"
duration_s = 10000
motion = {{ file = "{}", column_long = 1, column_lat = 2 }}
node.xpc = {{ adapter = "echo", prompt = true }}
[node.opf]
adapter = "opensees"
prompt = true
answer_deadline_s = 60
[[node.opf.element]]
name = "specimen"
port = {}
protocol = "{}"
dofs = ["long", "lat"]
)",
                     motion.string(), port, transport == Transport::Tcp ? "tcp" : "udp");
}

/// The run at the other end, in a temporary folder. It ends when its element ends.
class Run {
 public:
  Run(Transport transport, std::uint16_t port, const fs::path& programs) {
    const fs::path motion = folder_.path() / "still.csv", file = folder_.path() / "trip.toml";
    std::ofstream{motion} << "t,a,b\n0,0,0\n0.01,0,0\n0.02,0,0\n";
    std::ofstream{file} << experiment(transport, port, motion);
    output_ = std::async(std::launch::async, [=, folder = folder_.path()] {
      return output_of({(programs / "rths").string(), "run", file.string(), "--clock", "wall",
                        "--out", (folder / "out").string(), "--ring", folder.filename().string()},
                       kLongest);
    });
  }
  ~Run() {
    if (output_.valid()) output_.wait();
  }
  Run(const Run&) = delete;
  Run& operator=(const Run&) = delete;

 private:
  TemporaryFolder folder_{"trip"};
  std::future<std::string> output_;
};

/// The messages of an OpenSees step: a trial, then the request for its force.
class Element {
 public:
  Element(Transport transport, std::uint16_t port)
      : socket_{connect_to(transport, port, kToStart)} {
    const std::array<std::int32_t, 11> sizes{2, 2, 2, 0, 1, 0, 0, 0, 2, 0, kDoubles};
    socket_.send(std::as_bytes(std::span{sizes}));
  }
  ~Element() {
    Message end{kEnd};
    try {
      socket_.send(bytes_of(end));
    } catch (const Error&) {  // NOLINT(bugprone-empty-catch): the run has ended already
    }
  }
  Element(const Element&) = delete;
  Element& operator=(const Element&) = delete;

  /// @throws Error if the force does not belong to the displacement
  void step() {
    const double displacement = ++steps_ % 1000 * 1e-6;
    Message trial{kTrial, displacement, -displacement}, request = trial;
    request[0] = kForce;
    socket_.send(bytes_of(trial));
    socket_.send(bytes_of(request));
    socket_.receive(bytes_of(request));
    if (std::abs(request[0] - 1e6 * displacement) > 1e-3)
      throw Error{fmt::format("the force is {} N, expected {}", request[0], 1e6 * displacement)};
  }

 private:
  Socket socket_;
  int steps_ = 0;
};

template <class Trip>
std::vector<double> timed(int round_trips, const Trip& trip) {
  std::vector<double> nanoseconds;
  for (int i = 0; i < round_trips; ++i) {
    const auto begun = steady_clock::now();
    trip();
    nanoseconds.push_back(
        std::chrono::duration<double, std::nano>(steady_clock::now() - begun).count());
  }
  return nanoseconds;
}

TripResult trips_over(Transport transport, const OpenSeesOptions& options, const Cpus& cpus) {
  const PingPong bare{transport, sizeof(Message), cpus.far};
  const std::uint16_t port = free_port();
  const Run run{transport, port, options.programs};
  Element element{transport, port};
  const Pinned client{cpus.near};
  Message message{};
  std::vector<Times> through, straight;
  std::vector<double> ratios, tails;
  const auto ring = [&] { element.step(); };
  const auto ping = [&] { bare.exchange(bytes_of(message)); };
  static_cast<void>(timed(kWarmUp, ring));
  static_cast<void>(timed(kWarmUp, ping));
  for (int cycle = 0; cycle < options.cycles; ++cycle) {
    through.push_back(times_of(timed(options.round_trips, ring)));
    straight.push_back(times_of(timed(options.round_trips, ping)));
    ratios.push_back(through.back().p50 / straight.back().p50);
    tails.push_back(through.back().p99 / straight.back().p99);
  }
  TripResult result;
  result.protocol = transport == Transport::Tcp ? "tcp" : "udp";
  result.through_ring = median(through);
  result.bare = median(straight);
  result.ratio_p50 = median(ratios);
  result.ratio_interval = median_interval(ratios, kSeed);
  result.ratio_p99 = median(tails);
  result.gate_result = result.ratio_p50 <= kMostOfBare ? GateResult::Pass : GateResult::Fail;
  return result;
}

}  // namespace

OpenSeesReport run_opensees_bench(const OpenSeesOptions& options) {
  OpenSeesReport report;
  report.machine = describe_machine();
  report.cycles = options.cycles;
  report.round_trips = options.round_trips;
  if (!report.machine.chosen) {
    report.troubles.emplace_back(kOneProcessor);
    return report;
  }
  const Cpus cpus = report.machine.chosen->cpus;
  const LoadMeter load{cpus};
  for (const Transport transport : {Transport::Tcp, Transport::Udp})
    report.trips.push_back(trips_over(transport, options, cpus));
  report.steal = load.so_far().steal;
  if (auto trouble = steal_trouble(report.steal); !trouble.empty())
    report.troubles.push_back(std::move(trouble));
  report.result = worst_of(report.trips);
  if (report.result == GateResult::Fail && !report.troubles.empty())
    report.result = GateResult::Inconclusive;
  return report;
}

}  // namespace rths::bench
