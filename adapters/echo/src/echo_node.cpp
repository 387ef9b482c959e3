// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/echo.hpp>
#include <rths/adapters/opf_handshake.hpp>
#include <rths/experiment/experiment.hpp>

namespace rths::adapters {

using namespace experiment;

NodeSettings read_echo(const std::string& /*node*/, const Config& table,
                       const Experiment& /*setup*/) {
  constexpr double kPeriod = 1e-3;  // [s]
  EchoSettings echo;
  echo.stiffness = table.number_in("stiffness_N_per_m", 0, 1e15, echo.stiffness);
  echo.is_down_when_idle = read_handshake(table) == Handshake::TargetFirst;
  echo.is_prompt = table.flag("prompt", false);
  NodeSettings settings;
  settings.schedule = schedule_of(kPeriod, 0.3 * kPeriod);
  settings.make = [echo](const Experiment&, const NodeContext& context) {
    EchoSettings complete = echo;
    complete.layout = opf_layout(context.map);
    return make_echo(complete);
  };
  return settings;
}

}  // namespace rths::adapters
