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

/// A measurement and its reference, measured directly one after the other.
struct Pairing {
  Times measured;
  Times reference;
  double raw = 0;  ///< time of a cache line, if that is not the reference [ns]; 0: unknown
};

/// Quantity that a gate bounds.
enum class Quantity {
  RatioToRaw,    ///< measured / raw; upper bound
  RatioToOther,  ///< measured / reference other than raw; upper bound
  Time,          ///< measured [ns]; upper bound
  ExtraTime,     ///< measured − reference [ns]; upper bound
  TimesCheaper,  ///< reference / measured; lower bound
  TimesOurs,     ///< a peer's ratio to raw / that of our corresponding row; lower bound
};

/// Bounds of a median.
struct Gate {
  double goal = 0;   ///< desired value
  double limit = 0;  ///< required value
};

/// Another program that takes part in a row.
struct Peer {
  std::string program;  ///< file name, beside the command
  std::string against;  ///< name of our row that a peer's row is compared with
};

struct Row;

/// Settings that all rows share.
struct Workbench {
  Setup setup;
  std::filesystem::path programs;  ///< folder of the peers' programs
};

/// One row of the table: a way to pass or write data, and its gate.
struct Row {
  std::string name;
  std::uint32_t bytes = 0;
  std::string description;
  /// @throws Missing if a program that the row needs is missing, Error if the measurement fails
  Pairing (*measure)(const Row&, const Workbench&) = nullptr;
  Quantity quantity = Quantity::RatioToRaw;
  std::optional<Gate> gate = std::nullopt;       ///< of the quantity; none: not judged
  std::optional<Gate> tail_gate = std::nullopt;  ///< of the ratio of the 99 % quantiles
  std::optional<Peer> peer = std::nullopt;       ///< if one takes part

  /// True if the row measures a peer instead of the ring.
  [[nodiscard]] bool is_peers() const { return quantity == Quantity::TimesOurs; }
};

/// A program that a row needs is not on this machine.
class Missing : public Error {
 public:
  using Error::Error;
};

/// All rows, in the order in which they are printed.
[[nodiscard]] std::vector<Row> all_rows();

/// The rows with these names, and our rows that peers among them are compared with; all rows if
/// `names` is empty.
/// @throws Error with a list of all rows if a name is unknown
[[nodiscard]] std::vector<Row> select_rows(const std::vector<std::string>& names);

}  // namespace rths::bench
