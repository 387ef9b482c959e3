// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/user_program.hpp>

#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/file.hpp>
#include <rths/core/text.hpp>

namespace rths::experiment {

void check_placeholders(const Config& table, const std::string& key,
                        const std::vector<std::string>& arguments,
                        const std::vector<std::string_view>& known) {
  for (const auto& argument : arguments) {
    const std::string placeholder = argument.substr(0, argument.find('}') + 1);
    if (argument.starts_with("{") &&
        std::find(known.begin(), known.end(), placeholder) == known.end())
      table.fail(key,
                 fmt::format("unknown placeholder '{}', expected one of {}",
                             placeholder.empty() ? argument : placeholder, fmt::join(known, ", ")));
  }
}

bool fill_in(std::string& argument, const Experiment& experiment,
             const std::filesystem::path& motion) {
  const bool takes_motion = argument.find(kMotionPlaceholder) != std::string::npos;
  replace_all(argument, kMotionPlaceholder, std::filesystem::absolute(motion).string());
  replace_all(argument, kStepPlaceholder, fmt::format("{}", experiment.time.integration_step));
  replace_all(argument, kDurationPlaceholder, fmt::format("{}", experiment.time.duration));
  return takes_motion;
}

std::string motion_text(const sim::GroundMotion& motion) {
  std::string text = "t_s,long_m_per_s2,lat_m_per_s2\n";
  for (std::size_t i = 0; i < motion.long_acceleration.size(); ++i)
    text += fmt::format("{:.9g},{:.9g},{:.9g}\n", static_cast<double>(i) * motion.time_step,
                        motion.long_acceleration[i], motion.lat_acceleration[i]);
  return text;
}

std::filesystem::path file_beside(const std::filesystem::path& recording, const std::string& node,
                                  const std::string& ending) {
  return recording.parent_path() / (recording.stem().string() + "." + node + ending);
}

bool is_program(const std::string& name) {
  if (name.find('/') != std::string::npos) return access(name.c_str(), X_OK) == 0;
  return found_in_path(name).has_value();
}

}  // namespace rths::experiment
