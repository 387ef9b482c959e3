// SPDX-License-Identifier: Apache-2.0
//
// Plays the solver of examples/python/two_signals.ringmap.toml: steps to 0.1 m after 0.2 s, again
// every 50 ms, and ends 0.5 s later.
#include <cstdio>

#include <rths/core/error.hpp>
#include <rths/testkit/signals.hpp>

int main(int argc, char** argv) {
  try {
    if (argc != 2) throw rths::Error{"expected the name of a ring"};
    const auto ring = rths::testkit::SignalRing::attach(argv[1]);
    const auto solver = ring->join("solver");
    rths::WallClock clock;
    clock.sleep_until(clock.now() + std::chrono::milliseconds{200});
    for (int i = 0; i < 10; ++i) {
      solver->write("solver.displacement", 0.1);
      solver->beat();
      clock.sleep_until(clock.now() + std::chrono::milliseconds{50});
    }
    return 0;
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "pusher: %s\n", error.what());
    return 1;
  }
}
