// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test {
namespace {

TermSettings bearing() {
  return {"bouc_wen",
          "",
          {{"characteristic_strength", 1.01e6},
           {"post_yield_stiffness", 4.238e6},
           {"yield_displacement", 2.855e-3}}};
}

TermCase beside_bearing(const char* kind) {
  TermCase c;
  c.kind = kind;
  c.companions = {bearing()};
  return c;
}

}  // namespace

std::vector<TermCase> sensor_cases() {
  // A range only scales the share beside it: it is the sensor's full scale, and known.
  TermCase cubic = beside_bearing("cubic_distortion");
  cubic.fixed = {"range"};
  // Readings jump where a number wraps or turns to its neighbour. What least squares can polish is
  // the lattice that the recording itself shows: the fit begins near it, with few samples and
  // little noise, so that none of them changes its place on the way.
  TermCase overflow = beside_bearing("overflow");
  overflow.motion.steps = 150;
  overflow.noise = 1e-3;
  overflow.start = 2e-4;
  TermCase quantisation = overflow;
  quantisation.kind = "quantisation";
  return {cubic, overflow, quantisation};
}

}  // namespace rths::sim::test
