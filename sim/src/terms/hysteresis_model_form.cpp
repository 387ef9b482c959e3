// SPDX-License-Identifier: Apache-2.0
#include "elastomeric.hpp"
#include "hysteresis.hpp"
#include "kinds.hpp"
#include "work_taken.hpp"

namespace rths::sim {
namespace {

constexpr std::size_t kElements = 4;

// Not dissipative: negative forces return work.
struct HysteresisShape : Acts<Stage::Restoring, kFrameIndifferent> {
  static constexpr std::string_view kName = "hysteresis_shape";
  static constexpr std::string_view kTitle = "shape of the loop (model form)";
  static constexpr std::string_view kEquation =
      "F = sum_k q_k h_k,  dh_k = (du - h_k |du|) / L_k,  L_k = L (1, 10/3, 65/6, 37.5)";
  static constexpr std::string_view kSource = "Dahl 1968 for two directions; the sum is ours";
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
  static constexpr std::string_view kName = "degradation";
  static constexpr std::string_view kTitle = "strength and stiffness lost with dissipated work";
  static constexpr std::string_view kEquation =
      "Q_d -> Q_d f,  k -> k f^s,  f = 1 / (1 + d_Q W),  K_d -> K_d / (1 + d_K W),  W = int F_h . "
      "du";
  static constexpr std::string_view kSource = "Baber & Wen 1981";
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

}  // namespace

std::span<const TermKind> model_form_kinds() { return kinds_of<HysteresisShape, Degradation>(); }

}  // namespace rths::sim
