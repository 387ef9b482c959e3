// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/alpha_os.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {

using Eigen::MatrixXd;
using Eigen::VectorXd;

AlphaOs::AlphaOs(const MatrixXd& M, const MatrixXd& C, const MatrixXd& K_I, double dt, double alpha)
    : dt_{dt},
      alpha_{alpha},
      beta_{(1 - alpha) * (1 - alpha) / 4},
      gamma_{(1 - 2 * alpha) / 2},
      C_{C},
      K_I_{K_I} {
  if (M.rows() != M.cols() || C.rows() != M.rows() || K_I.rows() != M.rows() ||
      C.cols() != M.rows() || K_I.cols() != M.rows())
    throw Error{fmt::format(
        "integrator: mass, damping and stiffness are {}x{}, {}x{} and {}x{}, expected square "
        "matrices of one size",
        M.rows(), M.cols(), C.rows(), C.cols(), K_I.rows(), K_I.cols())};
  if (!(dt > 0))
    throw Error{fmt::format("integrator: the time step is {:g} s, expected a positive time", dt)};
  if (!(alpha >= -1.0 / 3 && alpha <= 0))
    throw Error{fmt::format("integrator: alpha is {:g}, expected -1/3 to 0", alpha)};
  effective_mass_.compute(M + (1 + alpha) * (gamma_ * dt * C + beta_ * dt * dt * K_I));
  if (effective_mass_.info() != Eigen::Success)
    throw Error{"integrator: the effective mass is not positive definite"};
  const auto n = M.rows();
  for (VectorXd* vector :
       {&u_, &v_, &a_, &u_predicted_, &v_predicted_, &restoring_force_, &load_, &rhs_, &scratch_})
    vector->setZero(n);
}

void AlphaOs::reset() {
  for (VectorXd* vector : {&u_, &v_, &a_, &restoring_force_, &load_}) vector->setZero();
}

void AlphaOs::continue_from(const AlphaOs& other) noexcept {
  u_ = other.u_;
  v_ = other.v_;
  a_ = other.a_;
  restoring_force_ = other.restoring_force_;
  load_ = other.load_;
}

const VectorXd& AlphaOs::predict() noexcept {
  u_predicted_ = u_ + dt_ * v_ + dt_ * dt_ * (0.5 - beta_) * a_;
  v_predicted_ = v_ + dt_ * (1 - gamma_) * a_;
  return u_predicted_;
}

void AlphaOs::correct(const VectorXd& restoring_force, const VectorXd& load) noexcept {
  // M̂ a⁺ = (1+α)(f⁺ − r̃⁺ − C ṽ⁺) − α(f − r − C v)
  rhs_ = (1 + alpha_) * (load - restoring_force) - alpha_ * (load_ - restoring_force_);
  scratch_.noalias() = C_ * v_predicted_;
  rhs_ -= (1 + alpha_) * scratch_;
  scratch_.noalias() = C_ * v_;
  rhs_ += alpha_ * scratch_;
  a_ = rhs_;
  effective_mass_.solveInPlace(a_);

  u_ = u_predicted_ + beta_ * dt_ * dt_ * a_;
  v_ = v_predicted_ + gamma_ * dt_ * a_;
  scratch_ = u_ - u_predicted_;
  restoring_force_ = restoring_force;
  restoring_force_.noalias() += K_I_ * scratch_;
  load_ = load;
}

}  // namespace rths::sim
