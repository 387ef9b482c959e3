// SPDX-License-Identifier: Apache-2.0
#include "step_times.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/text.hpp>

#include "launcher_link.hpp"

namespace rths::launch {
namespace {

constexpr double kMicro = 1e-6;
constexpr std::size_t kStepsPerLine = 500;

}  // namespace

void send_times(const adapters::StepTimes& times) {
  const std::size_t steps = std::min(times.late.size(), times.duration.size());
  std::string line;
  for (std::size_t i = 0; i < steps; ++i) {
    line += fmt::format("{} {} ", std::lround(times.late[i] / kMicro),
                        std::lround(times.duration[i] / kMicro));
    if ((i + 1) % kStepsPerLine != 0 && i + 1 != steps) continue;
    LauncherLink::send_line(kTimesLine + line);
    line.clear();
  }
}

void read_times(const std::string& text, adapters::StepTimes& times) {
  const auto words = cells_of(text, ' ');
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    const auto late = number_of(words[i]), duration = number_of(words[i + 1]);
    if (!late || !duration) return;
    times.late.push_back(static_cast<float>(*late * kMicro));
    times.duration.push_back(static_cast<float>(*duration * kMicro));
  }
}

}  // namespace rths::launch
