// SPDX-License-Identifier: Apache-2.0
//
// The programs of a small laboratory: laboratory NODE RING
//   solver      commands 0.1 m, repeats it, and ends with 0 when the machine answers with 100 kN
//   controller  passes each target on, at most 0.2 m
//   machine     answers each reference with the force of a spring of 1 MN/m
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

#include <rths/core/error.hpp>
#include <rths/testkit/signals.hpp>

namespace {

using rths::testkit::SignalNode;
using rths::testkit::SignalRing;

constexpr auto kPeriod = std::chrono::milliseconds{20};
constexpr auto kStart = std::chrono::milliseconds{200};  // of the solver, at rest

// Answers each write to `input` by `output`; ends by a signal.
void answer(SignalRing& ring, const std::string& node, const std::string& input,
            const std::string& output, const std::function<double(double)>& law) {
  const auto inputs = ring.follow({input});  // before it joins: others take a joined node as ready
  const auto member = ring.join(node);
  for (;;) {
    rths::broker::Write write;
    member->beat();
    if (inputs->wait(rths::WallClock{}.now() + kPeriod, write) == rths::Status::Ok)
      member->write(output, law(inputs->change_of(write).values[0].second));
  }
}

void solve(SignalRing& ring) {
  const auto solver = ring.join("solver");
  rths::WallClock clock;
  clock.sleep_until(clock.now() + kStart);
  while (std::abs(solver->read("machine.force") - 1e5) > 1) {
    solver->write("solver.target", 0.1);
    solver->beat();
    clock.sleep_until(clock.now() + kPeriod);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc != 3) throw rths::Error{"expected NODE RING"};
    const std::string node = argv[1];
    const auto ring = SignalRing::attach(argv[2]);
    if (node == "solver") solve(*ring);
    if (node == "controller")
      answer(*ring, node, "solver.target", "controller.reference",
             [](double target) { return std::clamp(target, -0.2, 0.2); });
    if (node == "machine")
      answer(*ring, node, "controller.reference", "machine.force",
             [](double reference) { return 1e6 * reference; });
    return 0;
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "laboratory: %s\n", error.what());
    return 1;
  }
}
