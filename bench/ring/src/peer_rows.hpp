// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <rths/bench/rows.hpp>

namespace rths::bench {

/// Round trips through another program, a peer's or a client of the vendor's kind.
/// @throws Missing if the program was not built, Error if it fails
[[nodiscard]] Pairing measure_peer(const Row& row, const Workbench& bench);

/// Our group and a peer's record of the same size, each written under a reader.
[[nodiscard]] Pairing measure_write_under_reader_200(const Row& row, const Workbench& bench);
[[nodiscard]] Pairing measure_write_under_reader_1000(const Row& row, const Workbench& bench);
/// Words through a journal, and a peer's queue.
[[nodiscard]] Pairing measure_queue_throughput(const Row& row, const Workbench& bench);

/// Reads the line that a peer's program ends with: {"p50_ns": …, "p99_ns": …}.
/// @throws Error with the program's own words if it says {"error": …}
[[nodiscard]] Times parse_peer_line(const std::string& line);

}  // namespace rths::bench
