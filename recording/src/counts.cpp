// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

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

NodeTicks::NodeTicks(const Reader& run, const std::string& node)
    : run_{run}, node_{"monitor." + node + "."}, counter_{run.signal(node_ + "host.step")} {
  const std::string flag = roles_of(run).new_target;
  const auto stop = at_each_count(counter_, run.has(flag) ? run.signal(flag) : counter_);
  const auto end = std::find_if(stop.begin(), stop.end(), [](double word) { return word < 0; });
  count_ = static_cast<std::size_t>(end - stop.begin());
}

std::vector<double> NodeTicks::skipped() const {
  const std::string signal = node_ + "host.skipped";
  return run_.has(signal) ? run_.signal(signal) : std::vector<double>(counter_.size(), 0);
}

double NodeTicks::interval() const {
  const auto time = at_each_count(counter_, run_.time());
  const auto count = at_each_count(counter_, counter_);
  const auto left_out = at_each_count(counter_, skipped());
  const std::size_t last = count_ - 1;
  return (time[last] - time[0]) / (count[last] + left_out[last] - (count[0] + left_out[0]));
}

std::vector<double> NodeTicks::values(const std::string& signal) const {
  auto values = at_each_count(counter_, run_.signal(signal));
  values.resize(std::min(values.size(), count_));
  return values;
}

}  // namespace rths::recording
