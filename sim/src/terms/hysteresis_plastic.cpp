// SPDX-License-Identifier: Apache-2.0
#include "hysteresis.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

struct Bilinear : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr std::string_view kName = "bilinear";
  static constexpr std::string_view kTitle = "bilinear hysteresis";
  static constexpr std::string_view kEquation =
      "F = K_d u + Q_d z,  dz = du/u_y within |z| < 1, radial return to |z| = 1";
  static constexpr std::string_view kSource = "Simo & Hughes 1998, chapter 1, in the plane";
  enum { kStrength, kStiffness, kYieldDisplacement };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3}};
  static constexpr std::size_t kStates = 4;  // displacement before, z

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> increment = scaled_increment(q, term.state);
    Plane<Real> z = Plane<Real>{term.state[2], term.state[3]} +
                    increment * (1 / term.parameters[kYieldDisplacement]);
    const Real radius = length(z);
    if (radius > 1) z = z * (1 / radius);
    term.state[2] = z.x, term.state[3] = z.y;
    resist(q, z * (term.parameters[kStrength] * q.strength),
           term.parameters[kStiffness] * q.stiffness);
  }
};

// Sliders are evenly spaced on a logarithmic scale over two decades below the reach. Every fourth
// one is a knot of the spline.
constexpr std::size_t kIwanKnots = 6;
constexpr std::size_t kSlidersPerKnot = 4;
constexpr std::size_t kIwanSliders = (kIwanKnots - 1) * kSlidersPerKnot + 1;
constexpr double kDecades = 2;

// A slider's shares of the strengths of the knots to its left and right: hat functions, which sum
// to 1 over the sliders for each knot.
struct Share {
  std::size_t left;
  double of_left, of_right;
};

constexpr double hat_sum(std::size_t knot) {
  const double full = kSlidersPerKnot;  // 1 + 2 (1/n + … + (n-1)/n)
  return knot == 0 || knot == kIwanKnots - 1 ? (full + 1) / 2 : full;
}

constexpr Share share_of(std::size_t slider) {
  const std::size_t left = std::min(slider / kSlidersPerKnot, kIwanKnots - 2);
  const double right = static_cast<double>(slider - left * kSlidersPerKnot) / kSlidersPerKnot;
  return {left, (1 - right) / hat_sum(left), right / hat_sum(left + 1)};
}

struct Iwan : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr std::string_view kName = "iwan";
  static constexpr std::string_view kTitle = "Masing hysteresis with a spline backbone";
  static constexpr std::string_view kEquation =
      "F = K_d u + sum_j Q_j z_j,  dz_j = du/r_j within |z_j| < 1, radial return to |z_j| = 1,  "
      "Q_j = sum_k q_k hat_k(log r_j)";
  static constexpr std::string_view kSource =
      "Iwan 1966 (parallel sliders), monotone concave spline after Meyer 2008";
  enum { kStiffness, kReach, kStrength };
  static constexpr Parameter kParameters[] = {{"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
                                              {"reach", "m", 1e-6, 10, 0.1, 0.1},
                                              {"strength_1", "N", 0, 1e9, 0, 1e5},
                                              {"strength_2", "N", 0, 1e9, 0, 3e5},
                                              {"strength_3", "N", 0, 1e9, 0, 3e5},
                                              {"strength_4", "N", 0, 1e9, 0, 2e5},
                                              {"strength_5", "N", 0, 1e9, 0, 1e5},
                                              {"strength_6", "N", 0, 1e9, 0, 5e4}};
  static constexpr std::size_t kStates = 2 + 2 * kIwanSliders;  // displacement before, z of each

  static TermSize size(const TermSetup&) { return {kStates, kIwanSliders}; }
  // reach / r_j
  static void prepare(const TermSetup&, std::span<double> constants) {
    for (std::size_t j = 0; j < kIwanSliders; ++j)
      constants[j] = std::pow(10, kDecades * (1 - static_cast<double>(j) / (kIwanSliders - 1)));
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> increment = scaled_increment(q, term.state) * (1 / term.parameters[kReach]);
    Plane<Real> sum;
    for (std::size_t j = 0; j < kIwanSliders; ++j) {
      Real* slider = term.state + 2 + 2 * j;
      Plane<Real> z = Plane<Real>{slider[0], slider[1]} + increment * Real{term.constants[j]};
      if (dot(z, z) > 1) z = z * (1 / length(z));
      slider[0] = z.x, slider[1] = z.y;
      const Share share = share_of(j);
      const Real* strength = term.parameters + kStrength + share.left;
      sum = sum + z * (strength[0] * share.of_left + strength[1] * share.of_right);
    }
    resist(q, sum * q.strength, term.parameters[kStiffness] * q.stiffness);
  }
};

}  // namespace

std::span<const TermKind> plastic_kinds() { return kinds_of<Bilinear, Iwan>(); }

}  // namespace rths::sim
