// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hysteresis_kinds.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

// z is integrated along the step in parts of a quarter of the yield displacement: Runge-Kutta's
// error is then below 1e-4 of the strength. Beyond kMaxParts parts the bearing has yielded along
// this very direction long since: only the last parts of the way are walked.
constexpr double kPartOfYieldDisplacement = 0.25;
constexpr int kMaxParts = 40;

template <class Real>
Real sign_of(const Real& x) {
  return x > 0 ? Real{1} : (x < 0 ? Real{-1} : Real{0});
}

// |z|^(eta-2) from |z|². The exponent's derivative is wanted even where it is 2. Without |z| there
// is nothing to bend.
template <class Real>
Real sharpness(const Real& square, const Real& eta) {
  using std::pow;
  if (is_just(eta, 2)) return Real{1};
  return square > 0 ? Real{pow(square, 0.5 * eta - 1)} : Real{0};
}

template <class Rule, class Real>
void runge_kutta_part(const TermView<Real>& term, Plane<Real>& z, const Plane<Real>& du) {
  const Plane<Real> k1 = Rule::rate(term, z, du);
  const Plane<Real> k2 = Rule::rate(term, z + k1 * Real{0.5}, du);
  const Plane<Real> k3 = Rule::rate(term, z + k2 * Real{0.5}, du);
  const Plane<Real> k4 = Rule::rate(term, z + k3, du);
  z = z + (k1 + k4 + (k2 + k3) * Real{2}) * Real{1.0 / 6};
}

// A term with the parameters of `bouc_wen` first and a rate of its own.
template <class Rule, class Real>
void step_bouc_wen(const TermView<Real>& term, Quantities<Real>& q) {
  Plane<Real> z{term.state[2], term.state[3]};
  const Plane<Real> increment = way_of(q, term.state);
  const double part =
      kPartOfYieldDisplacement * value_of(term.parameters[Rule::kYieldDisplacement]);
  const double wanted = std::ceil(value_of(length(increment)) / part);
  const int parts = static_cast<int>(std::min(std::max(wanted, 1.0), double{kMaxParts}));
  const Plane<Real> du = increment * Real{1 / std::max(wanted, 1.0)};
  for (int i = 0; i < parts; ++i) {
    runge_kutta_part<Rule>(term, z, du);
    Rule::confine(term, z);
  }
  term.state[2] = z.x, term.state[3] = z.y;
  resist(q, z * (term.parameters[Rule::kStrength] * q.strength),
         term.parameters[Rule::kStiffness] * q.stiffness);
}

// |z| <= 1 holds exactly for the laws; the integration may leave it by its error.
template <class Real>
void into_unit_circle(Plane<Real>& z) {
  const Real radius = length(z);
  if (radius > 1) z = z * (1 / radius);
}

struct BoucWen {
  static constexpr std::string_view kName = "bouc_wen";
  static constexpr std::string_view kTitle = "Bouc-Wen hysteresis with post-yield stiffness";
  static constexpr std::string_view kEquation =
      "F = K_d u + Q_d z,  dz_i = (du_i - z_i r_i^(eta-2) w_i (gamma + beta sgn(w_i))) / u_y,  "
      "r_i^2 = z_i^2 + c z_j^2,  w_i = z_i du_i + c z_j du_j,  gamma = 1 - beta";
  static constexpr std::string_view kSource =
      "Park, Wen & Ang 1986, rotation-invariant form at coupling c = 1";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
  enum { kStrength, kStiffness, kYieldDisplacement, kBeta, kEta, kCoupling };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3},
      {"beta", "-", 0, 1, 0.5, 0.5},
      {"eta", "-", 1, 20, 2, 2},
      {"coupling", "-", 0, 1, 1, 1}};
  static constexpr std::size_t kStates = 4;  // displacement before, z

  // Along z, per unit of du.
  template <class Real>
  static Real bending(const TermView<Real>& term, const Real& square, const Real& work) {
    const Real& beta = term.parameters[kBeta];
    return sharpness(square, term.parameters[kEta]) * work * (1 - beta + beta * sign_of(work));
  }

  template <class Real>
  static Plane<Real> rate(const TermView<Real>& term, const Plane<Real>& z, const Plane<Real>& du) {
    const Real& c = term.parameters[kCoupling];
    const Real per_yield = 1 / term.parameters[kYieldDisplacement];
    if (is_just(c, 1)) return (du - z * bending(term, dot(z, z), dot(z, du))) * per_yield;
    const Real xx = z.x * z.x, yy = z.y * z.y, wx = z.x * du.x, wy = z.y * du.y;
    return Plane<Real>{du.x - z.x * bending(term, xx + c * yy, wx + c * wy),
                       du.y - z.y * bending(term, yy + c * xx, wy + c * wx)} *
           per_yield;
  }

  // With less coupling the law itself leaves the circle: on the way to the square of coupling 0.
  template <class Real>
  static void confine(const TermView<Real>& term, Plane<Real>& z) {
    if (is_just(term.parameters[kCoupling], 1)) into_unit_circle(z);
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    step_bouc_wen<BoucWen>(term, q);
  }
};

struct BoucWenNagarajaiah {
  static constexpr std::string_view kName = "bouc_wen_nagarajaiah";
  static constexpr std::string_view kTitle = "Bouc-Wen hysteresis with the sign of each axis";
  static constexpr std::string_view kEquation =
      "F = K_d u + Q_d z,  dz = (du - z sum_i z_i du_i (gamma + beta sgn(z_i du_i))) / u_y,  "
      "gamma = 1 - beta";
  static constexpr std::string_view kSource =
      "Nagarajaiah, Reinhorn & Constantinou 1991; not the same in all directions";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative;
  enum { kStrength, kStiffness, kYieldDisplacement, kBeta };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3},
      {"beta", "-", 0.5, 1, 0.9, 0.9}};
  static constexpr std::size_t kStates = 4;

  template <class Real>
  static Plane<Real> rate(const TermView<Real>& term, const Plane<Real>& z, const Plane<Real>& du) {
    const Real& beta = term.parameters[kBeta];
    const Real wx = z.x * du.x, wy = z.y * du.y;
    const Real bent = wx * (1 - beta + beta * sign_of(wx)) + wy * (1 - beta + beta * sign_of(wy));
    return (du - z * bent) * (1 / term.parameters[kYieldDisplacement]);
  }

  // With beta < 1 this law itself may leave the circle a little where one axis unloads.
  template <class Real>
  static void confine(const TermView<Real>&, Plane<Real>&) {}

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    step_bouc_wen<BoucWenNagarajaiah>(term, q);
  }
};

struct BoucWenSlip {
  static constexpr std::string_view kName = "bouc_wen_slip";
  static constexpr std::string_view kTitle = "Bouc-Wen hysteresis with slip (pinching)";
  static constexpr std::string_view kEquation =
      "F = K_d u + Q_d z,  u = u_1 + u_2,  dz of du_1 as bouc_wen,  du_2 = a f(|z|) dz,  "
      "f(z) = sqrt(2/pi)/sigma exp(-z^2/(2 sigma^2))";
  static constexpr std::string_view kSource = "Baber & Noori 1985 (slip-lock), for two directions";
  static constexpr Stage kStage = Stage::Restoring;
  static constexpr unsigned kTraits = kDissipative | kFrameIndifferent;
  enum { kStrength, kStiffness, kYieldDisplacement, kBeta, kEta, kSlip, kSigma };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3},
      {"beta", "-", 0, 1, 0.5, 0.5},
      {"eta", "-", 1, 20, 2, 2},
      {"slip_length", "m", 0, 1, 0, 1e-2},
      {"slip_width", "-", 0.05, 1, 0.2, 0.2}};
  static constexpr std::size_t kStates = 4;

  // Across z the law is dz (u_y + a f) = du; along z, where the bracket of bouc_wen is m,
  // dz (u_y + a f m) = m du.
  template <class Real>
  static Plane<Real> rate(const TermView<Real>& term, const Plane<Real>& z, const Plane<Real>& du) {
    using std::exp;
    constexpr double kTwoOverPi = 0.6366197723675814;
    const Real square = dot(z, z), work = dot(z, du);
    const Real& beta = term.parameters[kBeta];
    const Real& sigma = term.parameters[kSigma];
    const Real bend = sharpness(square, term.parameters[kEta]) * (1 - beta + beta * sign_of(work));
    const Real m = 1 - square * bend;
    const Real slip = term.parameters[kSlip] * std::sqrt(kTwoOverPi) / sigma *
                      exp(-0.5 * square / (sigma * sigma));
    const Real across = 1 / (term.parameters[kYieldDisplacement] + slip);
    // (along - across) / |z|², where m has been put in so that nothing is divided by 0.
    const Real difference = -bend * term.parameters[kYieldDisplacement] * across /
                            (term.parameters[kYieldDisplacement] + slip * m);
    return du * across + z * (difference * work);
  }

  template <class Real>
  static void confine(const TermView<Real>&, Plane<Real>& z) {
    into_unit_circle(z);
  }

  template <class Real>
  static void step(const TermView<Real>& term, Quantities<Real>& q) {
    step_bouc_wen<BoucWenSlip>(term, q);
  }
};

constexpr TermKind kKinds[] = {kind_of<BoucWen>(), kind_of<BoucWenNagarajaiah>(),
                               kind_of<BoucWenSlip>()};

}  // namespace

std::span<const TermKind> bouc_wen_kinds() { return kKinds; }

}  // namespace rths::sim
