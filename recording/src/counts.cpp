// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <rths/recording/recording.hpp>

namespace rths::recording {

std::vector<double> at_each_count(const std::vector<double>& counter,
                                  const std::vector<double>& signal) {
  const std::size_t rows = std::min(counter.size(), signal.size());
  std::vector<double> values;
  double last_value = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    if (!(counter[row] >= 1)) continue;
    const auto count = static_cast<std::size_t>(std::lround(counter[row]));
    if (count <= values.size()) continue;
    const std::size_t missing = count - 1 - values.size();
    const double before = values.empty() ? signal[row] : last_value;
    for (std::size_t i = 1; i <= missing; ++i)
      values.push_back(before + (signal[row] - before) * static_cast<double>(i) /
                                    static_cast<double>(missing + 1));
    values.push_back(signal[row]);
    last_value = signal[row];
  }
  return values;
}

}  // namespace rths::recording
