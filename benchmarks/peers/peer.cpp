// SPDX-License-Identifier: Apache-2.0
#include "peer.hpp"

#include <sys/prctl.h>

#include <csignal>
#include <cstdio>
#include <string>

#include <nlohmann/json.hpp>

#include <rths/core/error.hpp>

namespace rths::peers {
namespace {

constexpr int kArguments = 6;
constexpr std::uint32_t kLargestMessage = 65'536;

Request parse(char** argv) {
  Request request;
  request.bytes = static_cast<std::uint32_t>(std::stoul(argv[2]));
  if (request.bytes < 4 || request.bytes > kLargestMessage)
    throw Error{"expected 4 to 65536 bytes"};
  request.setup.round_trips = static_cast<std::uint32_t>(std::stoul(argv[3]));
  request.setup.cpus = {std::stoi(argv[4]), std::stoi(argv[5])};
  request.setup.tick = bench::measure_tick();
  return request;
}

bench::Times measure(int argc, char** argv, const Tasks& tasks) {
  if (argc != kArguments) throw Error{"expected: TASK BYTES ROUND_TRIPS NEAR_CPU FAR_CPU"};
  const auto task = tasks.find(argv[1]);
  if (task == tasks.end()) throw Error{"there is no task '" + std::string{argv[1]} + "'"};
  return task->second(parse(argv));
}

}  // namespace

int run_peer(int argc, char** argv, const Tasks& tasks) {
  // Ends with the command that started it.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  nlohmann::json result;
  try {
    const bench::Times times = measure(argc, argv, tasks);
    result = {{"p50_ns", times.p50}, {"p99_ns", times.p99}};
  } catch (const std::exception& error) {
    result = {{"error", error.what()}};
  }
  std::printf("%s\n", result.dump().c_str());
  return result.contains("error") ? 1 : 0;
}

std::uint32_t number_of(const void* message, std::size_t bytes) {
  std::uint32_t first = 0;
  std::uint32_t last = 0;
  std::memcpy(&first, message, sizeof first);
  std::memcpy(&last, static_cast<const std::byte*>(message) + bytes - sizeof last, sizeof last);
  if (first != last) throw Error{"a message was read torn"};
  return first;
}

}  // namespace rths::peers
