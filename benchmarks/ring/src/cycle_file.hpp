// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <rths/bench/judge.hpp>

namespace rths::bench {

/// One measured cycle in a file, so that an interrupted run can be continued.
class CycleFile {
 public:
  /// @param folder  empty: nothing is read or written
  CycleFile(const std::filesystem::path& folder, int number, std::uint32_t round_trips);
  /// The stored cycle, if it has the same number of round trips and measured all these rows.
  [[nodiscard]] std::optional<Cycle> read(const std::vector<Row>& rows) const;
  void write(const Cycle& cycle) const;

 private:
  std::filesystem::path path_;
  std::uint32_t round_trips_;
};

}  // namespace rths::bench
