// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "report.hpp"

namespace rths::diagnosis {

/// Covariances of the named models, by relation that names something.
using Covariances = std::map<const RelationFindings*, MatrixXd>;
[[nodiscard]] Covariances covariances_of(const AllFindings& all);

/// Improved models, as TOML, whose specimen has the parameters one standard deviation away from the
/// fitted ones: in both senses along each direction of a square root of their covariance. A
/// parameter ends at its bounds.
[[nodiscard]] std::vector<std::string> deviations_of(const AllFindings& all,
                                                     const Covariances& covariances);

/// What the named model leaves of the force of the first record: the residual, reduced by the share
/// of its energy that is noise. Empty if the evaluation is not of a force.
[[nodiscard]] ForceRemainder remainder_of(const Evaluation& evaluation);

}  // namespace rths::diagnosis
