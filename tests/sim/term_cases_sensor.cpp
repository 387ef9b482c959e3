// SPDX-License-Identifier: Apache-2.0
#include "term_cases.hpp"

namespace rths::sim::test_support {
namespace {

TermCase beside_bearing(const char* kind) {
  TermCase c;
  c.kind = kind;
  c.companions = {lead_rubber()};
  return c;
}

}  // namespace

std::vector<TermCase> sensor_cases() {
  // The range only scales the share; it is the sensor's known full scale.
  TermCase cubic = beside_bearing("cubic_distortion");
  cubic.fixed = {"range"};
  // Readings jump where a value wraps or is rounded to the next level. Least squares can only
  // refine a lattice already visible in the recording. So the fit starts close, with few samples
  // and little noise, and no reading changes its level during the fit.
  TermCase overflow = beside_bearing("overflow");
  overflow.motion.steps = 150;
  overflow.noise = 1e-3;
  overflow.start = 2e-4;
  TermCase quantisation = overflow;
  quantisation.kind = "quantisation";
  return {cubic, overflow, quantisation};
}

}  // namespace rths::sim::test_support
