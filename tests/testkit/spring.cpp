// SPDX-License-Identifier: Apache-2.0
//
// Plays the machine of examples/python/two_signals.ringmap.toml: a spring of 1 MN/m. A second
// argument is the number of commands after which it ends.
#include <cstdio>
#include <cstdlib>

#include <rths/core/error.hpp>
#include <rths/testkit/signals.hpp>

int main(int argc, char** argv) {
  try {
    const auto ring = rths::testkit::SignalRing::attach(argv[1]);
    const auto commands = ring->follow({"solver.displacement"});
    const auto machine = ring->join("machine");
    long left = argc > 2 ? std::atol(argv[2]) : 1'000'000;
    while (left > 0) {
      rths::broker::Write write;
      const auto deadline = rths::WallClock{}.now() + std::chrono::milliseconds{50};
      machine->beat();
      if (commands->wait(deadline, write) != rths::Status::Ok) continue;
      machine->write("machine.force", 1e6 * commands->change_of(write).values[0].second);
      --left;
    }
    return 0;
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "spring: %s\n", error.what());
    return 1;
  }
}
