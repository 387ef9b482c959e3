// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/assign.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct SendArguments {
  std::string ring;
  std::vector<std::string> assignments;  ///< name=value; optional unit, default the map's
};

int send(const SendArguments& arguments) {
  broker::Ring ring = broker::Ring::attach(arguments.ring);
  broker::assign(ring, arguments.assignments);
  return kOk;
}

}  // namespace

void add_send(CommandLine& line) {
  auto [command, a] = line.add("send", "Write words of a ring by name", send);
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command->add_option("assignments", a.assignments, "name=value, optionally with a unit: 12.5mm")
      ->required();
}

}  // namespace rths::app
