// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/card/shared_cards.hpp>
#include <rths/command_line/write_file.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/replicated/images.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct RingArguments {
  std::string source;  ///< scenario; of `show` also the name of a ring
  std::string out;     ///< file of the trace; empty: named after the scenario, in this folder
  std::optional<double> at_us;  ///< time of the picture [µs]; empty: the end
};

void print_registers(const scramnet::SharedCard& card) {
  for (const int csr : {0, 1, 2, 8})
    fmt::print("{}", replicated::csr_line(csr, card.csr[static_cast<std::size_t>(csr)]));
  fmt::print("  interrupt FIFO {} of 1024, {} interrupts to the host\n", card.interrupt_fifo,
             card.host_interrupts);
}

broker::RingReport usable_ring(const std::string& name) {
  const auto ring = broker::inspect_ring(name);
  if (!ring)
    throw Error{fmt::format("'{}' is neither a scenario file nor a ring of this host", name)};
  if (!ring->usable) throw Error{fmt::format("ring '{}': {}", name, ring->trouble)};
  return *ring;
}

// Nodes of a ring in shared memory see the same words, so there are no messages to show.
int show_shared(const broker::RingReport& ring, const std::vector<scramnet::SharedCard>& cards) {
  fmt::print("{}: {} bytes in shared memory, {} processes, {} cards\n", ring.name, ring.bytes,
             ring.occupants.size(), ring.cards);
  for (const auto& occupant : ring.occupants)
    fmt::print("  {:<12} {} {}\n", occupant.node, occupant.process,
               occupant.alive ? "alive" : "ended without leaving");
  for (const auto& card : cards) {
    fmt::print("\n{} {}, id {}, {}\n", card.gt ? "GT card" : "card", card.index, card.id,
               card.process.empty() ? "idle" : "of " + card.process);
    if (!card.gt) print_registers(card);
  }
  return kOk;
}

// Each node has an image and a card.
int show_images(const broker::RingReport& ring) {
  const auto attached = broker::Ring::attach(ring.name);
  const auto& nodes = attached.map().description().nodes;
  fmt::print("{}: {} bytes for each of {} nodes\n", ring.name, ring.bytes, nodes.size());
  for (const auto& node : nodes) {
    const std::string image = replicated::image_name(ring.name, node.name);
    for (const auto& card : scramnet::cards_of(image)) {
      if (!card.carried) continue;
      fmt::print("\n{}, image '{}', id {}\n", node.name, image, card.id);
      print_registers(card);
      fmt::print("  transmit FIFO  {} of 1024, messages sent {}, stored {}, rejected {}\n",
                 card.carried->transmit_fifo, card.carried->sent, card.carried->stored,
                 card.carried->rejected);
      if (card.carried->ring_nodes != 0)
        fmt::print("  ring of {} nodes\n", card.carried->ring_nodes);
      if (card.carried->same_id != 0)
        fmt::print("  messages of other nodes with this id: {}\n", card.carried->same_id);
    }
  }
  return kOk;
}

int show_running(const std::string& name) {
  const auto ring = usable_ring(name);
  const auto cards = scramnet::cards_of(name);
  const bool has_images = std::any_of(cards.begin(), cards.end(),
                                      [](const auto& card) { return card.carried.has_value(); });
  return has_images ? show_images(ring) : show_shared(ring, cards);
}

int ring_trace(const RingArguments& arguments) {
  const auto scenario = replicated::load_scenario(arguments.source);
  const std::string out =
      arguments.out.empty()
          ? std::filesystem::path{arguments.source}.stem().string() + ".trace.json"
          : arguments.out;
  write_file(out, replicated::trace_of(scenario));
  fmt::print("{}: {:.3f} µs of {} nodes, seed {}\n", out,
             replicated::to_ns(scenario.duration) * 1e-3, scenario.names.size(),
             scenario.setup.seed);
  return kOk;
}

int ring_show(const RingArguments& arguments) {
  if (!std::filesystem::exists(arguments.source)) {
    if (arguments.at_us) throw Error{"--at-us: a running ring has no other time than now"};
    return show_running(arguments.source);
  }
  replicated::Course course{replicated::load_scenario(arguments.source)};
  const replicated::Time end = course.scenario().duration;
  course.run_until(arguments.at_us ? std::min(end, replicated::from_ns(*arguments.at_us * 1e3))
                                   : end);
  fmt::print("{}", replicated::show(course));
  return kOk;
}

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

void add_ring(CommandLine& line) {
  auto* command = line.app.add_subcommand(
      "ring", "Simulate a ring of cards in virtual time, message by message");
  command->require_subcommand(1);
  auto [trace, a] = line.add_to(
      *command, "trace",
      "Write every hop of a scenario as trace events for Perfetto or chrome://tracing", ring_trace);
  trace->add_option("scenario", a.source, "Scenario file")->required()->check(CLI::ExistingFile);
  trace->add_option("--out", a.out, "File for the trace [name of the scenario, in this folder]");
  auto [show, b] = line.add_to(
      *command, "show", "Draw nodes, registers, FIFOs and ages of a scenario or of a running ring",
      ring_show);
  show->add_option("source", b.source, "Scenario file, or name of a ring")->required();
  show->add_option("--at-us", b.at_us, "Time in the scenario [us; its end]")->check(not_negative());
}

void add_fault(CommandLine& line) {
  auto [command, a] = line.add("fault", "Cause a fault of the cards of a replicated ring", fault);
  command->add_option("ring", a.ring, "Name of a ring")->required();
  command
      ->add_option("keys", a.keys,
                   "key=value, as in a [[fault]] of an experiment: kind=power_off node=NAME")
      ->required();
}

}  // namespace rths::app
