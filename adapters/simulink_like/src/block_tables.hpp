// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <iterator>
#include <string>
#include <vector>

#include "block.hpp"

// Shared by the functions that build blocks from tables.
namespace rths::adapters {

constexpr bool kPerAxis = true;
constexpr bool kSingle = false;
constexpr double kFadeTime = 0.5;  ///< to fade compensation in or out [s]

using Range = std::optional<std::pair<double, double>>;
inline constexpr std::pair<double, double> kOffOrOn{0, 1};

/// The ports of a block, one for each name that its type gives them.
template <std::size_t count, std::size_t size>
[[nodiscard]] std::vector<PortSpec> ports(PortSpec (&&specs)[size]) {
  static_assert(size == count);
  return {std::make_move_iterator(std::begin(specs)), std::make_move_iterator(std::end(specs))};
}

/// Adds a tunable parameter to a block.
/// @param range  of the type; `range.<name>` in the table replaces it
void add_parameter(Block& block, const Config& table, const std::string& name,
                   const std::string& unit, double otherwise, const Range& range = std::nullopt);

[[nodiscard]] Block make_predictor_corrector(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_ats(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_adaptive_inverse(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_feed_forward(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_force_observer(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_table_force_observer(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_target_force(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_vertical_force(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_lag_correction(const Config& table, const BlockContext& context);

}  // namespace rths::adapters
