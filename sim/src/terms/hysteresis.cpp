// SPDX-License-Identifier: Apache-2.0
#include "kinds.hpp"
#include "plane.hpp"

namespace rths::sim {
namespace {

// z is integrated along the step in parts of a quarter of the yield displacement: Runge-Kutta's
// error is then below 1e-4 of the strength. Beyond kMaxParts parts the bearing has yielded along
// this very direction long since: only the last parts of the way are walked.
constexpr double kPartOfYieldDisplacement = 0.25;
constexpr int kMaxParts = 40;

struct BoucWen {
  static constexpr std::string_view kName = "bouc_wen";
  static constexpr std::string_view kTitle = "Bouc-Wen hysteresis with post-yield stiffness";
  static constexpr std::string_view kEquation =
      "F = K_d u + Q_d z,  dz = (du - z |z|^(eta-2) (z.du) (gamma + beta sgn(z.du))) / u_y,  "
      "gamma = 1 - beta";
  static constexpr std::string_view kSource = "Park, Wen & Ang 1986, rotation-invariant form";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
  enum { kStrength, kStiffness, kYieldDisplacement, kBeta, kEta };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3},
      {"beta", "-", 0, 1, 0.5, 0.5},
      {"eta", "-", 1, 20, 2, 2}};
  static constexpr std::size_t kStates = 4;  // displacement before, z

  template <class Real>
  static Plane<Real> rate(const TermView<Real>& term, const Plane<Real>& z, const Plane<Real>& du) {
    using std::pow;
    const Real work = dot(z, du);
    const Real sign = work > 0 ? Real{1} : (work < 0 ? Real{-1} : Real{0});
    const Real& beta = term.parameters[kBeta];
    const Real& eta = term.parameters[kEta];
    // The exponent's derivative is wanted even where it is 2. Without |z| there is nothing to bend.
    const Real radius = length(z);
    const bool is_square = std::is_same_v<Real, double> && eta == 2;
    Real sharpness{1};
    if (!is_square) sharpness = radius > 0 ? Real{pow(radius, eta - 2)} : Real{0};
    return (du - z * (sharpness * work * (1 - beta + beta * sign))) *
           (1 / term.parameters[kYieldDisplacement]);
  }

  template <class Real>
  static void runge_kutta_part(const TermView<Real>& term, Plane<Real>& z, const Plane<Real>& du) {
    const Plane<Real> k1 = rate(term, z, du);
    const Plane<Real> k2 = rate(term, z + k1 * Real{0.5}, du);
    const Plane<Real> k3 = rate(term, z + k2 * Real{0.5}, du);
    const Plane<Real> k4 = rate(term, z + k3, du);
    z = z + (k1 + k4 + (k2 + k3) * Real{2}) * Real{1.0 / 6};
    // |z| <= 1 holds exactly for the law; the integration may leave it by its error.
    const Real radius = length(z);
    if (radius > 1) z = z * (1 / radius);
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> u{q.displacement[0], q.displacement[1]};
    Plane<Real> z{term.state[2], term.state[3]};
    const Plane<Real> increment = u - Plane<Real>{term.state[0], term.state[1]};
    const double part = kPartOfYieldDisplacement * value_of(term.parameters[kYieldDisplacement]);
    const double wanted = std::ceil(value_of(length(increment)) / part);
    const int parts = static_cast<int>(std::min(std::max(wanted, 1.0), double{kMaxParts}));
    const Plane<Real> du = increment * Real{1 / std::max(wanted, 1.0)};
    for (int i = 0; i < parts; ++i) runge_kutta_part(term, z, du);
    term.state[0] = u.x, term.state[1] = u.y;
    term.state[2] = z.x, term.state[3] = z.y;

    const Real strength = term.parameters[kStrength] * q.strength;
    const Real stiffness = term.parameters[kStiffness] * q.stiffness;
    for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
      const Real plug = strength * term.state[2 + i];
      q.hysteretic_force[i] += plug;
      q.force[i] += plug + stiffness * q.displacement[i];
    }
  }
};

constexpr TermKind kKinds[] = {kind_of<BoucWen>()};

}  // namespace

std::span<const TermKind> hysteresis_kinds() { return kKinds; }

}  // namespace rths::sim
