// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/rows.hpp>

namespace rths::bench {

/// Round trips through another program: a peer, or a client of the vendor's API.
/// @throws Missing if the program was not built, Error if it fails
[[nodiscard]] Pairing measure_peer(const Row& row, const Workbench& bench);

/// Writes under a reader: our group and a peer's record of the same size.
[[nodiscard]] Pairing measure_write_under_reader_200(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_write_under_reader_1000(const Row& row, const Workbench& bench);
/// Throughput: words through a journal, messages through a peer's queue.
[[nodiscard]] Pairing measure_queue_throughput(const Row& row, const Workbench& bench);

/// Reads the last line of a peer's output: {"p50_ns": …, "p99_ns": …}.
/// @throws Error with the program's message if the line is {"error": …}
[[nodiscard]] Times parse_peer_line(const std::string& line);

}  // namespace rths::bench
