// SPDX-License-Identifier: Apache-2.0
//
// A peer: another way to pass data between two processes, as a separate program, so that the
// command does not link its library. It is called as
//
//     rths_peer_<name> TASK BYTES ROUND_TRIPS NEAR_CPU FAR_CPU
//
// and prints {"p50_ns": …, "p99_ns": …} or {"error": "…"} in one line on standard output.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <map>
#include <string>

#include <rths/bench/round_trip.hpp>

namespace rths::peers {

/// A measurement that the command requests.
struct Request {
  std::uint32_t bytes = 0;
  bench::Setup setup;
};

/// The tasks of a peer, by name. May throw.
using Tasks = std::map<std::string, std::function<bench::Times(const Request&)>>;

/// `main` of a peer: reads the request, measures, prints the result.
[[nodiscard]] int run_peer(int argc, char** argv, const Tasks& tasks);

/// Writes a number to the first and last four bytes of a message; with four bytes they coincide.
inline void mark(void* message, std::size_t bytes, std::uint32_t number) {
  std::memcpy(message, &number, sizeof number);
  std::memcpy(static_cast<std::byte*>(message) + bytes - sizeof number, &number, sizeof number);
}

/// The number of a message. @throws Error if its two ends differ
[[nodiscard]] std::uint32_t number_of(const void* message, std::size_t bytes);

}  // namespace rths::peers
