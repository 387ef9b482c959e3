// SPDX-License-Identifier: Apache-2.0
//
// The block of block.h as the solver on a ring, by the C++ API of rths. Signals have names and SI
// units.
//   block_rths MOTION STEP_S DURATION_S
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <string>
#include <thread>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>

#include "block.h"

namespace {

constexpr auto kDeadline = std::chrono::seconds{5};  // for each flag of the handshake
constexpr auto kNap = std::chrono::microseconds{50};
constexpr auto kFarewell = std::chrono::milliseconds{20};  // until every node has read it

const char* const kAxes[AXES] = {"long", "lat"};

// A variable that `rths run` sets for the program of a node.
std::string variable(const char* name) {
  const char* value = std::getenv(name);
  if (value == nullptr)
    throw rths::Error{std::string{name} +
                      " is not set: let `rths run` start this program, or set it"};
  return value;
}

/// A word of the ring in SI.
class Word {
 public:
  Word(rths::broker::Node& node, const rths::memmap::Map& map, const std::string& name)
      : node_{node}, entry_{map.entry(map.signal(name))}, codec_{*entry_.signal} {}
  [[nodiscard]] double read() const { return codec_.decode(node_.read(entry_.signal->offset)); }
  void write(double value) {
    if (node_.write(entry_.signal->offset, codec_.encode(value)) != rths::Status::Ok)
      throw rths::Error{"'" + entry_.name + "' is not a word of this node"};
  }
  void wait_for(double expected) {
    for (const auto deadline = std::chrono::steady_clock::now() + kDeadline; read() != expected;) {
      if (std::chrono::steady_clock::now() > deadline)
        throw rths::Error{entry_.name + " did not become " + std::to_string(std::lround(expected))};
      node_.beat();
      std::this_thread::sleep_for(kNap);
    }
  }

 private:
  rths::broker::Node& node_;
  rths::memmap::SignalEntry entry_;
  rths::memmap::Codec codec_;
};

void run(const motion& ground, double step, int steps) {
  auto ring = rths::broker::Ring::attach(variable("RTHS_RING"));
  const auto& map = ring.map();
  auto node = ring.join(variable("RTHS_NODE"), map.hash());
  const auto word = [&](const std::string& name) { return Word{node, map, name}; };
  Word new_target = word("opf.newTarget"), time = word("opf.1.time.target");
  Word switch_pc = word("daq.switchPC"), at_target = word("daq.atTarget");
  Word target[AXES] = {word("opf.long.displ.target"), word("opf.lat.displ.target")};
  Word feedback[AXES] = {word("daq.long.force.fbk"), word("daq.lat.force.fbk")};

  block block{};
  at_target.wait_for(1);
  for (int i = 1; i <= steps; ++i) {
    block_predict(&block, step);
    for (int axis = 0; axis < AXES; ++axis) target[axis].write(block.displ[axis]);
    time.write(i * step);
    new_target.write(1);
    switch_pc.wait_for(1);
    new_target.write(0);
    switch_pc.wait_for(0);
    at_target.wait_for(1);
    const double force[AXES] = {feedback[0].read(), feedback[1].read()};
    block_correct(&block, force, &ground, i * step, step);
  }
  new_target.write(-1);
  std::this_thread::sleep_for(kFarewell);
  for (int axis = 0; axis < AXES; ++axis)
    std::printf("the block is at %.1f mm, %s\n", 1e3 * block.displ[axis], kAxes[axis]);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) return 4;
  try {
    motion ground;
    if (read_motion(argv[1], &ground) != 0)
      throw rths::Error{std::string{argv[1]} + " is not a motion"};
    const double step = std::atof(argv[2]);
    run(ground, step, static_cast<int>(std::lround(std::atof(argv[3]) / step)));
    return 0;
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
