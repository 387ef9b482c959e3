// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/launch/run.hpp>

#include "commands.hpp"

namespace rths::app {

int stop(const std::string& ring) {
  fmt::print("process {} ends the run on ring '{}'\n", launch::request_stop(ring), ring);
  return kOk;
}

}  // namespace rths::app
