// SPDX-License-Identifier: Apache-2.0
#include "ticks.hpp"

#include <algorithm>

#include <rths/core/error.hpp>

namespace rths::report {
namespace {

// Tick interval between the first counted row and the first row of the final count, when the node
// left.
double period_of(const std::vector<double>& time, const std::vector<double>& counter,
                 const std::vector<double>& skipped) {
  const auto first = std::ranges::find_if(counter, [](double c) { return c >= 1; });
  const auto last = std::find(first, counter.end(), counter.back());
  const double counts = last == counter.end() ? 0 : *last - *first;
  if (!(counts > 0)) throw Error{"the recording contains no steps of the controller"};
  const auto row = [&](auto at) { return static_cast<std::size_t>(at - counter.begin()); };
  const double left_out = skipped[row(last)] - skipped[row(first)];
  return (time[row(last)] - time[row(first)]) / (counts + left_out);
}

}  // namespace

Ticks::Ticks(const Reader& run, const Roles& roles) : run_{run} {
  if (run.has("monitor." + roles.controller + ".host.step")) {
    ticks_.emplace(run, roles.controller);
    interval_ = period_of(run.time(), ticks_->counter(), ticks_->skipped());
    return;
  }
  rows_ = run.rows();
  if (run.has(roles.new_target)) {
    const auto flag = run.signal(roles.new_target);
    const auto end = std::ranges::find_if(flag, [](double word) { return word < 0; });
    rows_ = std::max<std::size_t>(2, static_cast<std::size_t>(end - flag.begin()));
  }
  interval_ = (run.time()[rows_ - 1] - run.time()[0]) / static_cast<double>(rows_ - 1);
}

Series Ticks::series(const std::string& signal) const {
  return {0, interval_, ticks_ ? ticks_->values(signal) : first_rows(run_.signal(signal))};
}

std::vector<double> Ticks::first_rows(std::vector<double> values) const {
  values.resize(std::min(values.size(), rows_));
  return values;
}

}  // namespace rths::report
