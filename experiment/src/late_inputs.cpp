// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/node.hpp>

#include <fmt/format.h>

namespace rths::experiment {

MissedSteps read_late_inputs(const Config& table, const char* otherwise, MissedSteps due) {
  const std::string inputs = table.text("late_inputs", otherwise);
  if (inputs != "due" && inputs != "newest")
    table.fail("late_inputs", fmt::format("late_inputs is '{}', expected due or newest", inputs));
  return inputs == "due" ? due : MissedSteps::Make;
}

}  // namespace rths::experiment
