// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "hysteresis.hpp"
#include "kinds.hpp"

namespace rths::sim {
namespace {

// Length of a substep in yield displacements: a quarter, or less for a sharp knee, because
// Runge-Kutta is stable up to 2.8/eta.
double substep_for(double eta) { return eta > 4 ? 1 / eta : 0.25; }

// After this many yield displacements along a line, the initial state has no influence.
constexpr double kForgotten = 10;
double most_substeps(double substep) { return std::ceil(kForgotten / substep); }
// Weakly coupled axes forget more slowly if one moves far less than the other.
constexpr double kMostSubstepsUncoupled = 400;

// A vector of a law that moves along one axis: half the work of one in the plane.
template <class Real>
struct Line {
  Real x{};

  [[gnu::always_inline]] friend Line operator+(const Line& a, const Line& b) { return {a.x + b.x}; }
  [[gnu::always_inline]] friend Line operator-(const Line& a, const Line& b) { return {a.x - b.x}; }
  template <class Factor>
  [[gnu::always_inline]] friend Line operator*(const Line& a, const Factor& b) {
    return {a.x * b};
  }
};

template <class Real>
[[gnu::always_inline]] inline Real dot(const Line<Real>& a, const Line<Real>& b) {
  return a.x * b.x;
}

template <class Real>
Real length(const Line<Real>& a) {
  using std::abs;
  return abs(a.x);
}

template <class Real>
Real sign_of(const Real& x) {
  return x > 0 ? Real{1} : (x < 0 ? Real{-1} : Real{0});
}

// |z|^(eta-2) from |z|². At eta = 2 the shortcut is taken only if no derivative is needed. At z = 0
// the bending vanishes.
template <class Real>
Real sharpness(const Real& square, const Real& eta) {
  if (is_just(eta, 2)) return Real{1};
  return square > 0 ? Real{pow(square, 0.5 * eta - 1)} : Real{0};
}

template <class Rule, class Real, template <class> class Vector>
void runge_kutta(const TermView<Real>& term, Vector<Real>& z, const Vector<Real>& du,
                 const Vector<Real>& k1) {
  const Vector<Real> k2 = Rule::rate(term, z + k1 * 0.5, du);
  const Vector<Real> k3 = Rule::rate(term, z + k2 * 0.5, du);
  const Vector<Real> k4 = Rule::rate(term, z + k3, du);
  z = z + (k1 + k4 + (k2 + k3) * 2.0) * (1.0 / 6);
}

// One substep, split where unloading turns into loading: there the rate has a kink. The vectors
// stay in registers only if all calls are inlined.
template <class Rule, class Real, template <class> class Vector>
[[gnu::flatten]] void integrate_substep(const TermView<Real>& term, Vector<Real>& z,
                                        Vector<Real> du) {
  Vector<Real> k1 = Rule::rate(term, z, du);
  const double work = value_of(dot(z, du)), change = value_of(dot(k1, du));
  if (work < 0 && work + change > 0) {
    const double kink = -work / change;
    runge_kutta<Rule>(term, z, du * kink, k1 * kink);
    du = du * (1 - kink);
    k1 = Rule::rate(term, z, du);
  }
  runge_kutta<Rule>(term, z, du, k1);
  Rule::confine(term, z);
}

// Number of substeps for an increment in yield displacements. NaN gives one substep.
double substeps_of(double yields, double substep) {
  const double substeps = std::ceil(yields / substep);
  return substeps > 1 ? substeps : 1;
}

// Step of a law `Rule` whose first parameters are those of `bouc_wen`. Of an increment that exceeds
// the memory, only the last substeps are integrated.
template <class Rule, class Real>
void step_bouc_wen(const TermView<Real>& term, Quantities<Real>& q) {
  Plane<Real> z{term.state[2], term.state[3]};
  const Plane<Real> increment = scaled_increment(q, term.state);
  Rule::integrate(term, z, increment);
  term.state[2] = z.x, term.state[3] = z.y;
  resist(q, z * (term.parameters[Rule::kStrength] * q.strength),
         term.parameters[Rule::kStiffness] * q.stiffness);
}

template <class Rule, class Real, template <class> class Vector>
void integrate_evenly(const TermView<Real>& term, Vector<Real>& z, const Vector<Real>& increment,
                      double substep, double most) {
  const double yields =
      value_of(length(increment)) / value_of(term.parameters[Rule::kYieldDisplacement]);
  const double wanted = substeps_of(yields, substep);
  const int substeps = static_cast<int>(std::min(wanted, most));
  const Vector<Real> du = increment * (1 / wanted);
  for (int i = 0; i < substeps; ++i) integrate_substep<Rule>(term, z, du);
}

// The exact laws keep |z| <= 1; the integration may exceed it by its error.
template <class Real, template <class> class Vector>
void into_unit_circle(Vector<Real>& z) {
  const Real radius = length(z);
  if (radius > 1) z = z * (1 / radius);
}

template <class Real>
void into_unit_square(Plane<Real>& z) {
  for (Real* component : {&z.x, &z.y}) {
    if (*component > 1) *component = Real{1};
    if (*component < -1) *component = Real{-1};
  }
}

// Dissipative at every beta: unloading is never softer than loading.
struct BoucWen : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "bouc_wen";
  static constexpr Text kTitle = "Bouc-Wen hysteresis with post-yield stiffness";
  static constexpr Text kEquation =
      "F = K_d u + Q_d z,  dz_i = (du_i - z_i r_i^(eta-2) w_i (gamma + beta sgn(w_i))) / u_y,  "
      "r_i^2 = z_i^2 + c z_j^2,  w_i = z_i du_i + c z_j du_j,  gamma = 1 - beta";
  static constexpr Text kSource = "Park, Wen & Ang 1986, rotation-invariant form at coupling c = 1";
  enum { kStrength, kStiffness, kYieldDisplacement, kBeta, kEta, kCoupling };
  static constexpr Parameter kParameters[] = {
      {"characteristic_strength", "N", 0, 1e9, 0, 1e6},
      {"post_yield_stiffness", "N/m", 0, 1e12, 0, 4e6},
      {"yield_displacement", "m", 1e-7, 1, 2.855e-3, 2.855e-3},
      {"beta", "-", 0, 1, 0.5, 0.5},
      {"eta", "-", 1, 20, 2, 2},
      {"coupling", "-", 0, 1, 1, 1}};
  static constexpr std::size_t kStates = 4;  // displacement before, z

  // Factor of z in dz/du.
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

  template <class Real>
  static Line<Real> rate(const TermView<Real>& term, const Line<Real>& z, const Line<Real>& du) {
    return (du - z * bending(term, dot(z, z), dot(z, du))) *
           (1 / term.parameters[kYieldDisplacement]);
  }

  template <class Real>
  static void confine(const TermView<Real>&, Line<Real>& z) {
    into_unit_circle(z);
  }

  // With coupling below 1 the law itself leaves the unit circle; at coupling 0 it fills the square.
  template <class Real>
  static void confine(const TermView<Real>& term, Plane<Real>& z) {
    if (is_just(term.parameters[kCoupling], 1))
      into_unit_circle(z);
    else
      into_unit_square(z);
  }

  template <class Real>
  static void integrate(const TermView<Real>& term, Plane<Real>& z, const Plane<Real>& increment) {
    const double substep = substep_for(value_of(term.parameters[kEta]));
    if (is_just(term.parameters[kCoupling], 1) && is_just(z.y, 0) && is_just(increment.y, 0)) {
      Line<Real> along{z.x};
      integrate_evenly<BoucWen>(term, along, Line<Real>{increment.x}, substep,
                                most_substeps(substep));
      z.x = along.x;
      return;
    }
    integrate_evenly<BoucWen>(
        term, z, increment, substep,
        term.parameters[kCoupling] < 1 ? kMostSubstepsUncoupled : most_substeps(substep));
  }

  static void step(const auto& term, auto& q) { step_bouc_wen<BoucWen>(term, q); }
};

struct BoucWenNagarajaiah : Acts<Stage::Restoring, kDissipative> {
  static constexpr Text kName = "bouc_wen_nagarajaiah";
  static constexpr Text kTitle = "Bouc-Wen hysteresis with the sign of each axis";
  static constexpr Text kEquation =
      "F = K_d u + Q_d z,  dz = (du - z sum_i z_i du_i (gamma + beta sgn(z_i du_i))) / u_y,  "
      "gamma = 1 - beta";
  static constexpr Text kSource =
      "Nagarajaiah, Reinhorn & Constantinou 1991; not the same in all directions";
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

  // With beta < 1 the law itself may leave the unit circle slightly while one axis unloads.
  template <class Real>
  static void confine(const TermView<Real>&, Plane<Real>&) {}

  template <class Real>
  static void integrate(const TermView<Real>& term, Plane<Real>& z, const Plane<Real>& increment) {
    const double substep = substep_for(2);
    integrate_evenly<BoucWenNagarajaiah>(term, z, increment, substep, most_substeps(substep));
  }

  static void step(const auto& term, auto& q) { step_bouc_wen<BoucWenNagarajaiah>(term, q); }
};

struct BoucWenSlip : Acts<Stage::Restoring, kDissipative | kFrameIndifferent> {
  static constexpr Text kName = "bouc_wen_slip";
  static constexpr Text kTitle = "Bouc-Wen hysteresis with slip (pinching)";
  static constexpr Text kEquation =
      "F = K_d u + Q_d z,  u = u_1 + u_2,  dz of du_1 as bouc_wen,  du_2 = a f(|z|) dz,  "
      "f(z) = sqrt(2/pi)/sigma exp(-z^2/(2 sigma^2))";
  static constexpr Text kSource = "Baber & Noori 1985 (slip-lock), for two directions";
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

  // a f(|z|)
  template <class Real>
  static Real slip_length(const TermView<Real>& term, const Real& square) {
    constexpr double kTwoOverPi = 0.6366197723675814;
    const Real& sigma = term.parameters[kSigma];
    return term.parameters[kSlip] * std::sqrt(kTwoOverPi) / sigma *
           exp(-0.5 * square / (sigma * sigma));
  }

  // Across z the law is dz (u_y + a f) = du. Along z it is dz (u_y + a f m) = m du, where m is the
  // bracket of bouc_wen.
  template <class Real>
  static Plane<Real> rate(const TermView<Real>& term, const Plane<Real>& z, const Plane<Real>& du) {
    const Real square = dot(z, z), work = dot(z, du);
    const Real& beta = term.parameters[kBeta];
    const Real bend = sharpness(square, term.parameters[kEta]) * (1 - beta + beta * sign_of(work));
    const Real m = 1 - square * bend;
    const Real slip = slip_length(term, square);
    const Real across = 1 / (term.parameters[kYieldDisplacement] + slip);
    // (along - across) / |z|², rewritten with m to avoid a division by zero.
    const Real difference = -bend * term.parameters[kYieldDisplacement] * across /
                            (term.parameters[kYieldDisplacement] + slip * m);
    return du * across + z * (difference * work);
  }

  template <class Real>
  static void confine(const TermView<Real>&, Plane<Real>& z) {
    into_unit_circle(z);
  }

  // Substeps are short in z instead of u, because slip adds displacement. z changes by 2 from one
  // side to the other; settling then takes as many substeps as without slip.
  template <class Real>
  static void integrate(const TermView<Real>& term, Plane<Real>& z, const Plane<Real>& increment) {
    const double all = value_of(length(increment));
    const double sharp = substep_for(value_of(term.parameters[kEta]));
    if (!(term.parameters[kSlip] > 0))
      return integrate_evenly<BoucWenSlip>(term, z, increment, sharp, most_substeps(sharp));
    const double substep = std::min(sharp, kSubstepOfWidth * value_of(term.parameters[kSigma]));
    const int most = static_cast<int>(std::ceil(2 / substep) + most_substeps(substep));
    double done = 0;
    for (int i = 0; i < most && !(done >= all); ++i) {
      const double du = std::min(substep * scale(term, z, increment), all - done);
      integrate_substep<BoucWenSlip>(term, z, increment * (du / all));
      done += du;
    }
  }
  // Displacement over which z changes by about 1 [m]. While z yields, there is no slip.
  template <class Real>
  static double scale(const TermView<Real>& term, const Plane<Real>& z,
                      const Plane<Real>& increment) {
    const Real square = dot(z, z);
    const double beta = value_of(term.parameters[kBeta]);
    const double sign = value_of(dot(z, increment)) < 0 ? -1 : 1;
    const double m = 1 - value_of(square) * value_of(sharpness(square, term.parameters[kEta])) *
                             (1 - beta + beta * sign);
    const double slip = value_of(slip_length(term, square)) * std::max(m, 0.0);
    return value_of(term.parameters[kYieldDisplacement]) + slip;
  }
  static constexpr double kSubstepOfWidth = 0.5;  // f falls by an eighth within a substep

  static void step(const auto& term, auto& q) { step_bouc_wen<BoucWenSlip>(term, q); }
};

}  // namespace

std::span<const TermKind> bouc_wen_kinds() {
  return kinds_of<BoucWen, BoucWenNagarajaiah, BoucWenSlip>();
}

}  // namespace rths::sim
