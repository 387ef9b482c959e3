// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <rths/bench/round_trip.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

/// What a row takes and what it is compared with, measured one right after the other.
struct Pairing {
  Times measured;
  Times reference;
  double raw = 0;  ///< of a cache line right before, where it is not the reference [ns]; 0: unknown
};

/// What a row is judged by.
enum class Quantity {
  RatioToRaw,    ///< measured / raw; at most so many
  RatioToOther,  ///< measured / reference, which is not raw; at most so many
  Time,          ///< measured [ns]; at most so many
  ExtraTime,     ///< measured − reference [ns]; at most so many
  TimesCheaper,  ///< reference / measured; at least so many
  TimesOurs,     ///< a peer's ratio to raw / that of our row of the same meaning; at least so many
};

/// What a median is held against.
struct Gate {
  double goal = 0;   ///< what is aimed at
  double limit = 0;  ///< what must hold
};

/// A program that is not ours and takes part in a row.
struct Peer {
  std::string program;  ///< beside the command
  std::string against;  ///< name of our row that a peer's row is held against
};

struct Row;

/// Where rows are measured.
struct Workbench {
  Setup setup;
  std::filesystem::path programs;  ///< folder of the peers' programs
};

/// One line of the table: a way to pass data, or to write it, and what is asked of it.
struct Row {
  std::string name;
  std::uint32_t bytes = 0;
  std::string what;
  /// @throws Missing if something that it needs is not here, Error if it fails
  Pairing (*measure)(const Row&, const Workbench&) = nullptr;
  Quantity quantity = Quantity::RatioToRaw;
  std::optional<Gate> gate = std::nullopt;       ///< of the quantity; none: not judged
  std::optional<Gate> tail_gate = std::nullopt;  ///< of the ratio of the 99 % quantiles
  std::optional<Peer> peer = std::nullopt;       ///< that takes part in it

  /// Whether it is a peer that is measured, and not the ring.
  [[nodiscard]] bool is_peers() const { return quantity == Quantity::TimesOurs; }
};

/// Something that a row needs is not on this machine.
class Missing : public Error {
 public:
  using Error::Error;
};

/// All rows, in the order in which they are printed.
[[nodiscard]] std::vector<Row> all_rows();

/// The rows of these names, all if there are none, and those of ours that peers among them need.
/// @throws Error that lists the rows there are
[[nodiscard]] std::vector<Row> select_rows(const std::vector<std::string>& names);

}  // namespace rths::bench
