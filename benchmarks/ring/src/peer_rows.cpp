// SPDX-License-Identifier: Apache-2.0
#include "peer_rows.hpp"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/bench/program.hpp>
#include <rths/core/error.hpp>

#include "ring_rows.hpp"

namespace rths::bench {
namespace {

constexpr auto kLongestRun = std::chrono::seconds{60};
// The peers that are not judged use the kernel: a wake-up takes as long as hundreds of messages
// without one.
constexpr std::uint32_t kMostKernelRoundTrips = 4'000;

Times run_peer(const Row& row, const Workbench& bench, const std::string& task) {
  const auto program = bench.programs / row.peer->program;
  if (!std::filesystem::exists(program))
    throw Missing{fmt::format("{} is not built", row.peer->program)};
  const bool is_judged = row.gate.has_value();
  const std::uint32_t trips = is_judged ? bench.setup.round_trips
                                        : std::min(bench.setup.round_trips, kMostKernelRoundTrips);
  const std::string out =
      output_of({program.string(), task, std::to_string(row.bytes), std::to_string(trips),
                 std::to_string(bench.setup.cpus.near), std::to_string(bench.setup.cpus.far)},
                kLongestRun);
  return parse_peer_line(out);
}

Pairing write_under_reader(const Row& row, const Workbench& bench, std::uint32_t gap) {
  const double raw = raw_round_trips(bench.setup).p50;
  const Times peer = run_peer(row, bench, fmt::format("writes_each_{}", gap));
  return {write_group_under_reader(row, bench, gap), peer, raw};
}

}  // namespace

Times parse_peer_line(const std::string& line) {
  const auto result = nlohmann::json::parse(line, nullptr, false);
  if (!result.is_object()) throw Error{fmt::format("expected one line of JSON, found '{}'", line)};
  if (result.contains("error")) throw Error{result["error"].get<std::string>()};
  if (!result.contains("p50_ns") || !result.contains("p99_ns"))
    throw Error{fmt::format("expected p50_ns and p99_ns, found '{}'", line)};
  return {result["p50_ns"].get<double>(), result["p99_ns"].get<double>()};
}

Pairing measure_peer(const Row& row, const Workbench& bench) {
  const Times raw = raw_round_trips(bench.setup);
  return {run_peer(row, bench, "round_trips"), raw};
}

Pairing measure_write_under_reader_200(const Row& row, const Workbench& bench) {
  return write_under_reader(row, bench, 200);
}

Pairing measure_write_under_reader_1000(const Row& row, const Workbench& bench) {
  return write_under_reader(row, bench, 1000);
}

Pairing measure_queue_throughput(const Row& row, const Workbench& bench) {
  const double raw = raw_round_trips(bench.setup).p50;
  const Times peer = run_peer(row, bench, "stream");
  return {stream_of_words(bench), peer, raw};
}

}  // namespace rths::bench
