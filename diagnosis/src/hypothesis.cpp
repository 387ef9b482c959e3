// SPDX-License-Identifier: Apache-2.0
#include "hypothesis.hpp"

#include <algorithm>

namespace rths::diagnosis {

Hypothesis extended(const Hypothesis& hypothesis, const Candidate& candidate,
                    const Eigen::VectorXd& start) {
  Hypothesis result = hypothesis;
  result.terms.insert(result.terms.end(), candidate.adds.begin(), candidate.adds.end());
  std::vector<double> values(hypothesis.values.begin(), hypothesis.values.end());
  for (std::size_t i = 0; i < candidate.frees.size(); ++i) {
    const auto& wanted = candidate.frees[i];
    const auto known = std::find_if(result.free.begin(), result.free.end(),
                                    [&](const auto& free) { return free.name == wanted.name; });
    if (known != result.free.end()) {
      if (known->is_tolerance) *known = wanted;
      continue;
    }
    result.free.push_back(wanted);
    values.push_back(start[static_cast<Eigen::Index>(i)]);
  }
  result.values =
      Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
  return result;
}

}  // namespace rths::diagnosis
