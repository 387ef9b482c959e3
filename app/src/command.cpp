// SPDX-License-Identifier: Apache-2.0
#include "command.hpp"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/core/key_value.hpp>
#include <rths/core/message.hpp>
#include <rths/session/run.hpp>

namespace rths::app {

Changes split_changes(const std::vector<std::string>& sets) {
  Changes changes;
  for (const auto& set : sets) {
    const auto change = key_value(set);
    if (!change) throw CLI::ValidationError{"--set " + set + ": expected key=value"};
    changes.push_back(*change);
  }
  return changes;
}

void check_sizes(const experiment::Experiment& experiment) {
  for (const auto& remark : session::remarks_on(experiment))
    write_message(fmt::format("rths: {}\n", remark));
}

std::string version() { return RTHS_VERSION; }

}  // namespace rths::app
