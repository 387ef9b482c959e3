// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include <rths/controller/specimen_model.hpp>
#include <rths/sim/bearing.hpp>

namespace rths::adapters {

/// Makes the specimen that a test assumes, for a controller.
/// @param axes  each long or lat   @param period  of its moves [s]
/// @throws Error as sim::BearingRun does, when it makes one   @setup
[[nodiscard]] controller::MakeSpecimen assumed_specimen(const sim::Bearing& bearing,
                                                        const std::vector<std::string>& axes,
                                                        double period);

}  // namespace rths::adapters
