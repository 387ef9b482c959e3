// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/card_view/card_view.hpp>
#include <rths/core/error.hpp>
#include <rths/replicated/scenario.hpp>

#include "commands.hpp"
#include "write_file.hpp"

namespace rths::app {
namespace {

// Nodes of a ring in shared memory see the same words, so there are no messages to show.
int show_shared(const std::string& name) {
  const auto ring = broker::inspect_ring(name);
  if (!ring)
    throw Error{fmt::format("'{}' is neither a scenario file nor a ring of this host", name)};
  if (!ring->usable) throw Error{fmt::format("ring '{}': {}", name, ring->trouble)};
  fmt::print("{}: {} bytes in shared memory, {} processes, {} cards\n", name, ring->bytes,
             ring->occupants.size(), ring->cards);
  for (const auto& occupant : ring->occupants)
    fmt::print("  {:<12} process {} {}\n", occupant.node, occupant.pid,
               occupant.alive ? "alive" : "ended without leaving");
  if (ring->cards == 0) return kOk;
  for (const auto& card : card_view::cards_of(name)) {
    fmt::print("\n{} {}, id {}, {}\n", card.gt ? "GT card" : "card", card.index, card.id,
               card.process == 0 ? "idle" : fmt::format("of process {}", card.process));
    if (card.gt) continue;
    for (const int csr : {0, 1, 2, 8}) {
      const std::uint32_t value = card.csr[static_cast<std::size_t>(csr)];
      fmt::print("  CSR{} {:04x}  {}\n", csr, value, replicated::csr_in_words(csr, value));
    }
    fmt::print("  interrupt FIFO {} of 1024, {} interrupts to the host\n", card.interrupt_fifo,
               card.host_interrupts);
  }
  return kOk;
}

}  // namespace

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
    return show_shared(arguments.source);
  }
  replicated::Course course{replicated::load_scenario(arguments.source)};
  const replicated::Time end = course.scenario().duration;
  course.run_until(arguments.at_us ? std::min(end, replicated::from_ns(*arguments.at_us * 1e3))
                                   : end);
  fmt::print("{}", replicated::show(course));
  return kOk;
}

}  // namespace rths::app
