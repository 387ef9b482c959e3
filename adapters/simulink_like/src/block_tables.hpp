// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "block.hpp"

// What the functions that build blocks from their tables share.
namespace rths::adapters {

constexpr bool kPerAxis = true;
constexpr bool kSingle = false;

/// One value per axis of the run, of those that the file gives in the order long, lat, …
/// @throws Error with the key's place if there are too few
[[nodiscard]] std::vector<double> per_axis(const Config& table, const std::string& key,
                                           const BlockContext& context, double otherwise);

/// Gives a block a setting that may be tuned while it runs.
void add_parameter(Block& block, const Config& table, const std::string& name,
                   const std::string& unit, double otherwise);

[[nodiscard]] Block make_predictor_corrector(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_ats(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_feed_forward(const Config& table, const BlockContext& context);
[[nodiscard]] Block make_force_observer(const Config& table, const BlockContext& context);

}  // namespace rths::adapters
