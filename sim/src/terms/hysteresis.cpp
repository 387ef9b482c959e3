// SPDX-License-Identifier: Apache-2.0
#include "hysteresis.hpp"

#include "elastomeric.hpp"
#include "kinds.hpp"
#include "work_taken.hpp"

namespace rths::sim {
namespace {

// The device is attached to a slipping anchor p. Its deflection y = u - p is bounded by the play
// and the elastic length. The force is a function of y, so the solution is exact.
struct AsymmetricHysteresis : Acts<Stage::Restoring, kDissipative | kPerAxis> {
  static constexpr Text kName = "asymmetric_hysteresis";
  static constexpr Text kTitle = "asymmetric friction of a device with play";
  static constexpr Text kEquation =
      "F = F_+ (y - g/2)/L_+ for y > g/2, F_- (y + g/2)/L_- for y < -g/2, else 0,  "
      "dy = du within -L_- - g/2 ... L_+ + g/2";
  static constexpr Text kSource = "stop operator, Visintin 1994; the play before it is ours";
  enum { kForward, kBackward, kForwardLength, kBackwardLength, kPlay };
  static constexpr Parameter kParameters[] = {{"forward_force", "N", 0, 1e9, 0, 1e5},
                                              {"backward_force", "N", 0, 1e9, 0, 1.5e5},
                                              {"forward_length", "m", 1e-9, 1, 3e-3, 3e-3},
                                              {"backward_length", "m", 1e-9, 1, 3e-3, 4e-3},
                                              {"play", "m", 0, 1, 0, 5e-3}};
  static constexpr std::size_t kStates =
      std::size_t{2} * kHorizontalAxes;  // displacement before, y

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Real* p = term.parameters;
    const Real half = 0.5 * p[kPlay];
    for_each_active_axis(term, [&](std::size_t axis) {
      Real& before = term.state[2 * axis];
      Real& y = term.state[2 * axis + 1];
      y += q.displacement[axis] - before;
      before = q.displacement[axis];
      // A weaker device slips earlier with the same stiffness.
      const Real most = half + p[kForwardLength] * q.strength;
      const Real least = -half - p[kBackwardLength] * q.strength;
      if (y > most) y = most;
      if (y < least) y = least;
      if (!(y > half || y < -half)) return;
      const Real force = y > half ? Real{p[kForward] / p[kForwardLength] * (y - half)}
                                  : Real{p[kBackward] / p[kBackwardLength] * (y + half)};
      q.hysteretic_force[axis] += force;
      q.force[axis] += force;
    });
  }
};

constexpr std::size_t kElements = 4;

// Not dissipative: negative forces return work.
struct HysteresisShape : Acts<Stage::Restoring, kFrameIndifferent> {
  static constexpr Text kName = "hysteresis_shape";
  static constexpr Text kTitle = "shape of the loop (model form)";
  static constexpr Text kEquation =
      "F = sum_k q_k h_k,  dh_k = (du - h_k |du|) / L_k,  L_k = L (1, 10/3, 65/6, 37.5)";
  static constexpr Text kSource = "Dahl 1968 for two directions; the sum is ours";
  enum { kLength, kForce };
  static constexpr Parameter kParameters[] = {{"length", "m", 1e-7, 1, 1.2e-3, 1.2e-3},
                                              {"force_1", "N", -1e9, 1e9, 0, 2e4},
                                              {"force_2", "N", -1e9, 1e9, 0, 2e4},
                                              {"force_3", "N", -1e9, 1e9, 0, 2e4},
                                              {"force_4", "N", -1e9, 1e9, 0, 2e4}};
  static constexpr std::size_t kStates = 2 + 2 * kElements;  // displacement before, h of each
  static constexpr double kLengths[kElements] = {1, 4 / 1.2, 13 / 1.2, 45 / 1.2};

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    const Plane<Real> u = displacement_of(q);
    const Plane<Real> du = u - Plane<Real>{term.state[0], term.state[1]};
    term.state[0] = u.x, term.state[1] = u.y;
    const Real path = length(du);
    const Plane<Real> ahead = path > 0 ? du * (1 / path) : Plane<Real>{};
    const Real relative_path = path / term.parameters[kLength];
    Plane<Real> sum;
    for (std::size_t k = 0; k < kElements; ++k) {
      Real* state = term.state + 2 + 2 * k;
      // Exact solution along a straight step.
      const Real kept = exp(relative_path * (-1 / kLengths[k]));
      const Plane<Real> h = Plane<Real>{state[0], state[1]} * kept + ahead * (1 - kept);
      state[0] = h.x, state[1] = h.y;
      sum = sum + h * term.parameters[kForce + k];
    }
    resist(q, sum * q.strength, Real{0});
  }
};

struct Degradation : Acts<Stage::Modifier, kFrameIndifferent> {
  static constexpr Text kName = "degradation";
  static constexpr Text kTitle = "strength and stiffness lost with dissipated work";
  static constexpr Text kEquation =
      "Q_d -> Q_d f,  k -> k f^s,  f = 1 / (1 + d_Q W),  K_d -> K_d / (1 + d_K W),  W = int F_h . "
      "du";
  static constexpr Text kSource = "Baber & Wen 1981";
  enum { kStrengthLoss, kStiffnessLoss, kElasticShare };
  static constexpr Parameter kParameters[] = {{"strength_loss", "1/J", 0, 1e6, 0, 1e-7},
                                              {"stiffness_loss", "1/J", 0, 1e6, 0, 1e-7},
                                              kElasticShareParameter};
  static constexpr std::size_t kStates = kWorkStates + 1;  // W

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    Real& work = term.state[kWorkStates];
    work += work_taken(term.state, q, Real{0});
    // The force is one step old, so the first reversal may make the work slightly negative.
    if (work < 0) work = Real{0};
    weaken<Real>(q, 1 / (1 + term.parameters[kStrengthLoss] * work),
                 term.parameters[kElasticShare]);
    q.stiffness *= 1 / (1 + term.parameters[kStiffnessLoss] * work);
  }
};

struct Bilinear : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "bilinear";
  static constexpr Text kTitle = "bilinear hysteresis";
  static constexpr Text kEquation =
      "F = K_d u + Q_d z,  dz = du/u_y within |z| < 1, radial return to |z| = 1";
  static constexpr Text kSource = "Simo & Hughes 1998, chapter 1, in the plane";
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
  static constexpr Text kName = "iwan";
  static constexpr Text kTitle = "Masing hysteresis with a spline backbone";
  static constexpr Text kEquation =
      "F = K_d u + sum_j Q_j z_j,  dz_j = du/r_j within |z_j| < 1, radial return to |z_j| = 1,  "
      "Q_j = sum_k q_k hat_k(log r_j)";
  static constexpr Text kSource =
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

std::span<const TermKind> hysteresis_kinds() {
  return kinds_of<Bilinear, Iwan, HysteresisShape, Degradation, AsymmetricHysteresis>();
}

}  // namespace rths::sim
