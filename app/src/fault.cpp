// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/broker/ring.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/key_value.hpp>
#include <rths/replicated/images.hpp>

#include "command.hpp"
#include "commands.hpp"

namespace rths::app {
namespace {

struct FaultArguments {
  std::string ring;
  std::vector<std::string> keys;  ///< key=value, as in a [[fault]] of an experiment
};

int fault(const FaultArguments& arguments) {
  Config table = Config::parse("", "rths fault");
  for (const auto& text : arguments.keys) {
    const auto key = key_value(text);
    if (!key) throw Error{fmt::format("found '{}', expected key=value", text)};
    table.set(key->first, key->second);
  }
  const auto ring = broker::Ring::attach(arguments.ring);
  std::vector<std::string> names;
  for (const auto& node : ring.map().description().nodes) names.push_back(node.name);
  const auto action = replicated::read_fault(table, names);
  table.reject_unknown_keys();
  replicated::request_fault(arguments.ring, action);
  return kOk;
}

}  // namespace

void add_fault(CommandLine& line) {
  auto& a = line.values<FaultArguments>();
  auto* command =
      line.app.add_subcommand("fault", "Cause a fault of the cards of a replicated ring");
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command
      ->add_option("keys", a.keys,
                   "key=value, as in a [[fault]] of an experiment: kind=power_off node=NAME")
      ->required();
  command->callback([&] { line.chosen = [&a] { return fault(a); }; });
}

}  // namespace rths::app
