// SPDX-License-Identifier: Apache-2.0
#include "script_placeholders.hpp"

#include <fmt/format.h>

namespace rths::launch {

std::string text_of(const sim::GroundMotion& motion) {
  std::string text = "t_s,long_m_per_s2,lat_m_per_s2\n";
  for (std::size_t i = 0; i < motion.long_acceleration.size(); ++i)
    text += fmt::format("{:.9g},{:.9g},{:.9g}\n", static_cast<double>(i) * motion.time_step,
                        motion.long_acceleration[i], motion.lat_acceleration[i]);
  return text;
}

void replace_all(std::string& text, std::string_view from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
}

std::string filled_in(std::string argument, const Experiment& e,
                      const std::filesystem::path& motion) {
  replace_all(argument, kMotionPlaceholder, std::filesystem::absolute(motion).string());
  replace_all(argument, kStepPlaceholder, fmt::format("{}", e.integration_step));
  replace_all(argument, kDurationPlaceholder, fmt::format("{}", e.duration));
  return argument;
}

}  // namespace rths::launch
