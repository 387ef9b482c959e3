// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "compliance.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

constexpr std::string_view kMountSource = "textbook; solution: docs/theory/machine_terms.md";

struct SupportFlexibility : Acts<Stage::Motion, kPerAxis | kMount> {
  static constexpr Text kName = "support_flexibility";
  static constexpr Text kTitle = "flexibility of the specimen's support";
  static constexpr Text kEquation = "u_specimen = u - chi F";
  static constexpr Text kSource = kMountSource;
  enum { kFlexibility, kStiffness };
  static constexpr Parameter kParameters[] = {{"flexibility", "m/N", 0, 1e3, 0, 2e-9},
                                              kStiffnessEstimate};
  static constexpr std::size_t kStates = kHorizontalAxes * Compliance<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      Real* state = term.state + axis * Compliance<double>::kStates;
      Compliance<Real> support{state, term.parameters[kFlexibility], term.parameters[kStiffness]};
      q.displacement[axis] = support.yield(q.displacement[axis], q.last_specimen_force[axis],
                                           Real{std::numeric_limits<double>::max()});
    });
  }
};

struct MountSlack : Acts<Stage::Motion, kPerAxis | kMount> {
  static constexpr Text kName = "mount_slack";
  static constexpr Text kTitle = "slack in the specimen's mount";
  static constexpr Text kEquation = "u_specimen = u - (g/2) clip(F/F_seat, 1)";
  static constexpr Text kSource = kMountSource;
  enum { kSlack, kSeat, kStiffness };
  static constexpr Parameter kParameters[] = {{"slack", "m", 0, 10, 0, 2e-3},
                                              {"seating_force", "N", 1e-6, 1e9, 1e5, 1e5},
                                              kStiffnessEstimate};
  static constexpr std::size_t kStates = kHorizontalAxes * Compliance<double>::kStates;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real half = 0.5 * term.parameters[kSlack];
    for_each_active_axis(term, [&](std::size_t axis) {
      Real* state = term.state + axis * Compliance<double>::kStates;
      Compliance<Real> mount{state, half / term.parameters[kSeat], term.parameters[kStiffness]};
      q.displacement[axis] = mount.yield(q.displacement[axis], q.last_specimen_force[axis], half);
    });
  }
};

struct TransducerBacklash : Acts<Stage::Motion, kPerAxis> {
  static constexpr Text kName = "transducer_backlash";
  static constexpr Text kTitle = "backlash between transducer and specimen";
  static constexpr Text kEquation = "u_specimen: play of u, moved only beyond +-g/2";
  static constexpr Text kSource = "Krasnosel'skii & Pokrovskii 1989 (play operator)";
  enum { kGap };
  static constexpr Parameter kParameters[] = {{"gap", "m", 0, 10, 0, 2e-3}};
  static constexpr std::size_t kStates = kHorizontalAxes;

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real half = 0.5 * term.parameters[kGap];
    for_each_active_axis(term, [&](std::size_t axis) {
      const Real& u = q.displacement[axis];
      Real& x = term.state[axis];
      if (u >= x + half)
        x = u - half;
      else if (u <= x - half)
        x = u + half;
      else
        q.velocity[axis] = q.acceleration[axis] = Real{0};
      q.displacement[axis] = x;
    });
  }
};

struct InputDeadZone : Acts<Stage::Motion, kPerAxis> {
  static constexpr Text kName = "input_dead_zone";
  static constexpr Text kTitle = "dead zone of the input";
  static constexpr Text kEquation = "u_specimen = u - clip(u, d)";
  enum { kHalfWidth };
  static constexpr Parameter kParameters[] = {{"half_width", "m", 0, 10, 0, 5e-3}};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    for_each_active_axis(term, [&](std::size_t axis) {
      const Real lost = clipped(q.displacement[axis], term.parameters[kHalfWidth]);
      if (lost == q.displacement[axis] && term.parameters[kHalfWidth] > 0)
        q.velocity[axis] = q.acceleration[axis] = Real{0};
      q.displacement[axis] -= lost;
    });
  }
};

}  // namespace

std::span<const TermKind> mount_kinds() {
  return kinds_of<SupportFlexibility, MountSlack, TransducerBacklash, InputDeadZone>();
}

}  // namespace rths::sim
