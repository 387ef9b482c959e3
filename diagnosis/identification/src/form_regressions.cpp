// SPDX-License-Identifier: Apache-2.0
#include "form_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include <rths/identification/constants.hpp>
#include <rths/identification/screening.hpp>
#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

// Hat functions over a range: piecewise linear between equally spaced knots.
struct Hats {
  double low, high;
  Index count;

  [[nodiscard]] MatrixXd operator()(const VectorXd& x) const {
    MatrixXd basis = MatrixXd::Zero(x.size(), count);
    for (Index i = 0; i < x.size(); ++i) {
      const double position = std::clamp((x[i] - low) / (high - low), 0.0, 1.0 - 1e-12) *
                              static_cast<double>(count - 1);
      const auto k = static_cast<Index>(position);
      basis(i, k) = 1 - (position - static_cast<double>(k));
      basis(i, k + 1) = position - static_cast<double>(k);
    }
    return basis;
  }
};

// Arguments of forms, divided by their peaks over all records.
struct StateSignals {
  VectorXd u, v, other_u, other_v, path, time, load, control;
};

struct Form {
  std::string name;
  std::string abscissa;  // u, v, path, t, N or I of the curve; empty: no curve
  std::function<MatrixXd(const StateSignals&)> design;
  bool is_friction = false;  // the design holds the curve twice, see friction()

  // Whether it depends on rates or times, which rows without time do not have.
  [[nodiscard]] bool needs_time() const {
    return name.starts_with("v g(") || name.starts_with("f(v") || name == "g(u, v)" ||
           abscissa == "t";
  }
};

VectorXd bent(const VectorXd& v) { return (v.array() / kBentSpeed).asinh(); }
const double kBentReach = std::asinh(1 / kBentSpeed);

// Displacement or velocity at a position between -1 and 1 among the knots of its curve.
double state_at(double position, const std::string& abscissa, double reach) {
  return (abscissa == "v" ? kBentSpeed * std::sinh(position * kBentReach) : position) * reach;
}
const char* label_of(const std::string& abscissa) {
  return abscissa == "v" ? "velocity [m/s]" : "displacement [m]";
}
// Position of a knot.
double position_of(Index knot, Index count) {
  return 2 * static_cast<double>(knot) / static_cast<double>(count - 1) - 1;
}

VectorXd sign_of(const VectorXd& v) {
  return v.unaryExpr([](double x) { return std::tanh(x / kTurningSpeed); });
}

// The same after elastic presliding over a hundredth of the largest displacement.
VectorXd direction_of(const VectorXd& u) {
  VectorXd direction = VectorXd::Zero(u.size());
  for (Index i = 1; i < u.size(); ++i)
    direction[i] = std::clamp(direction[i - 1] + (u[i] - u[i - 1]) / kPresliding, -1.0, 1.0);
  return direction;
}

// A friction of some size, which turns at once and after presliding: together any presliding
// between them. Both are the same while the friction slides, so that the size is the sum of their
// weights.
MatrixXd friction(const StateSignals& s, const MatrixXd& size) {
  MatrixXd both(size.rows(), 2 * size.cols());
  both << sign_of(s.v).asDiagonal() * size, direction_of(s.u).asDiagonal() * size;
  return both;
}

// Products of all columns of two bases.
MatrixXd surface(const MatrixXd& a, const MatrixXd& b) {
  MatrixXd products(a.rows(), a.cols() * b.cols());
  for (Index i = 0; i < a.cols(); ++i)
    for (Index k = 0; k < b.cols(); ++k)
      products.col(b.cols() * i + k) = a.col(i).cwiseProduct(b.col(k));
  return products;
}

// Curves over a state, and friction, viscosity and stiffness with a factor that depends on it.
void add_state(const std::string& symbol, VectorXd StateSignals::*state, std::vector<Form>& all) {
  const Hats range{0, 1, 9};
  all.push_back(
      {"f(" + symbol + ")", symbol, [=](const StateSignals& s) { return range(s.*state); }});
  all.push_back({"sgn(v) g(" + symbol + ")", symbol,
                 [=](const StateSignals& s) { return friction(s, range(s.*state)); }, true});
  all.push_back({"v g(" + symbol + ")", symbol, [=](const StateSignals& s) -> MatrixXd {
                   return s.v.asDiagonal() * range(s.*state);
                 }});
  all.push_back({"u g(" + symbol + ")", symbol, [=](const StateSignals& s) -> MatrixXd {
                   return s.u.asDiagonal() * range(s.*state);
                 }});
}

std::vector<Form> forms(bool has_other, bool has_load, bool has_control) {
  const Hats coarse{-1, 1, 14}, fine{-1, 1, 100}, middle{-1, 1, 41};
  const Hats speed{-kBentReach, kBentReach, 19};
  std::vector<Form> all{
      {"f(u)", "u", [=](const StateSignals& s) { return coarse(s.u); }},
      {"periodic in displacement", "u", [=](const StateSignals& s) { return fine(s.u); }},
      {"f(v)", "v", [=](const StateSignals& s) { return speed(bent(s.v)); }},
      {"sgn(v) g(u)", "u", [=](const StateSignals& s) { return friction(s, middle(s.u)); }, true},
      {"v g(u)", "u",
       [=](const StateSignals& s) -> MatrixXd { return s.v.asDiagonal() * coarse(s.u); }},
      {"g(u, v)", "", [](const StateSignals& s) {
         return surface(Hats{-1, 1, 9}(s.u), Hats{-kBentReach, kBentReach, 9}(bent(s.v)));
       }}};
  add_state("path", &StateSignals::path, all);
  add_state("t", &StateSignals::time, all);
  if (has_load) add_state("N", &StateSignals::load, all);
  if (has_control) add_state("I", &StateSignals::control, all);
  if (has_other) {
    all.push_back(
        {"f(u of the other axis)", "", [=](const StateSignals& s) { return coarse(s.other_u); }});
    all.push_back({"f(v of the other axis)", "",
                   [=](const StateSignals& s) { return speed(bent(s.other_v)); }});
    all.push_back({"f(v_long v_lat)", "", [=](const StateSignals& s) {
                     return Hats{-1, 1, 21}(
                         (s.v.cwiseProduct(s.other_v).array() / kBentSpeed).asinh().matrix() /
                         kBentReach);
                   }});
    all.push_back({"f(u_long, u_lat)", "", [](const StateSignals& s) {
                     return surface(Hats{-1, 1, 9}(s.u), Hats{-1, 1, 9}(s.other_u));
                   }});
  }
  return all;
}

// Residual of a hypothesis on a fold, its derivatives, and the ranges of the recorded states.
class ResidualView {
 public:
  ResidualView(const TestedHypothesis& tested, const Fold& fold) : tested_{tested}, fold_{fold} {
    const std::vector<Index> all = movable_of(tested.hypothesis());
    static_cast<void>(tested.evaluate(fold, tested.hypothesis().values, all, residual_, jacobian_));
    const Problem& problem = tested.problem();
    for (std::size_t i = 0; i < problem.records(); ++i) {
      const Drive& drive = problem.drive(i);
      if (drive.displacement.size() == 0) continue;
      u_ = std::max(u_, drive.displacement.cwiseAbs().maxCoeff());
      v_ = std::max(v_, drive.velocity.cwiseAbs().maxCoeff());
      path_.high = std::max(path_.high, path_of(drive).maxCoeff());
      time_.high = std::max(time_.high, time_of(drive).maxCoeff());
      for (const auto& [name, values] : drive.states)
        if (Range* range = range_of(name)) {
          range->low = std::min(range->low, values.minCoeff());
          range->high = std::max(range->high, values.maxCoeff());
          range->label = name;
        }
    }
  }

  struct Range {
    double low = 1e300, high = -1e300;
    std::string label;
    [[nodiscard]] bool varies() const {
      return high - low > kSteadyShare * std::max(std::abs(high), std::abs(low));
    }
    [[nodiscard]] VectorXd operator()(const VectorXd& values) const {
      return (values.array() - low) / (high - low);
    }
  };
  [[nodiscard]] const Range& load() const { return load_; }
  [[nodiscard]] const Range& control() const { return control_; }
  // Of the state of a curve; null: displacement or velocity.
  [[nodiscard]] const Range* range_over(const std::string& abscissa) const {
    if (abscissa == "path") return &path_;
    if (abscissa == "t") return &time_;
    if (abscissa == "N") return &load_;
    return abscissa == "I" ? &control_ : nullptr;
  }
  [[nodiscard]] double reach(const std::string& abscissa) const {
    return abscissa == "v" ? v_ : u_;
  }

  // Rows of one output: residual, derivatives of the fitted parameters, whitened columns of a form.
  void of_output(Index output, const Form& form, VectorXd& residual, MatrixXd& nuisance,
                 MatrixXd& columns) const {
    const Problem& problem = tested_.problem();
    std::vector<Index> rows;
    Index first = 0;
    std::vector<MatrixXd> designs;
    for (const auto& share : fold_.shares) {
      const Drive& drive = problem.drive(share.record);
      const Index count = drive.rows();
      for (Index row = 0; row < count; ++row) rows.push_back(first + output * count + row);
      designs.push_back(white(share, output, form));
      first += count * drive.measured.cols();
    }
    residual = residual_(rows);
    nuisance = jacobian_(rows, Eigen::all);
    columns.resize(static_cast<Index>(rows.size()), designs[0].cols());
    Index row = 0;
    for (const auto& design : designs) {
      columns.middleRows(row, design.rows()) = design;
      row += design.rows();
    }
  }

 private:
  // Distance covered on all axes since the record began.
  static VectorXd path_of(const Drive& drive) {
    VectorXd path = drive.velocity.cwiseAbs().rowwise().sum() * drive.time_step;
    for (Index i = 1; i < path.size(); ++i) path[i] += path[i - 1];
    return path;
  }
  static VectorXd time_of(const Drive& drive) {
    return VectorXd::LinSpaced(drive.rows(), 0, static_cast<double>(drive.rows() - 1)) *
           drive.time_step;
  }
  static bool is_load(const std::string& name) { return name.starts_with("axial load"); }
  static bool is_control(const std::string& name) { return name.starts_with("auxiliary."); }
  Range* range_of(const std::string& name) {
    if (is_load(name)) return &load_;
    return is_control(name) ? &control_ : nullptr;
  }

  [[nodiscard]] MatrixXd white(const Fold::Share& share, Index output, const Form& form) const {
    const Problem& problem = tested_.problem();
    const Drive& drive = problem.drive(share.record);
    const Index other = drive.measured.cols() > 1 ? 1 - output : output;
    StateSignals signals{drive.displacement.col(output) / u_,
                         drive.velocity.col(output) / v_,
                         drive.displacement.col(other) / u_,
                         drive.velocity.col(other) / v_,
                         path_(path_of(drive)),
                         time_(time_of(drive)),
                         {},
                         {}};
    for (const auto& [name, values] : drive.states) {
      if (is_load(name)) signals.load = load_(values);
      if (is_control(name)) signals.control = control_(values);
    }
    const MatrixXd design = form.design(signals);
    MatrixXd result(design.rows(), design.cols());
    for (Index i = 0; i < design.cols(); ++i) {
      result.col(i) = problem.noise(share.record).whitened(design.col(i), output);
      if (share.weight.size() > 0) result.col(i).array() *= share.weight;
    }
    return result;
  }

  const TestedHypothesis& tested_;
  const Fold& fold_;
  VectorXd residual_;
  MatrixXd jacobian_;
  double u_ = 1e-300, v_ = 1e-300;
  Range path_{0, 0, "path [m]"}, time_{0, 0, "time since the record began [s]"}, load_, control_;
};

// A fine curve over displacement or velocity of one axis, fitted to forces without noise.
class FineCurve {
 public:
  FineCurve(const Problem& problem, const std::string& abscissa)
      : problem_{problem},
        abscissa_{abscissa},
        hats_{abscissa == "u" ? Hats{-1, 1, 100} : Hats{-kBentReach, kBentReach, 99}} {
    for (std::size_t i = 0; i < problem.records(); ++i)
      reach_ = std::max(reach_, state(i).cwiseAbs().maxCoeff());
  }

  // @returns share of the forces' energy that the curve explains
  double fit(const std::vector<MatrixXd>& forces) {
    MatrixXd normal = MatrixXd::Zero(hats_.count, hats_.count);
    VectorXd right = VectorXd::Zero(hats_.count);
    double all = 1e-300;
    for (std::size_t i = 0; i < forces.size(); ++i) {
      const VectorXd x = state(i) / reach_;
      const Drive& drive = problem_.drive(i);
      const MatrixXd basis = drive.compared_rows(hats_(abscissa_ == "v" ? bent(x) : x));
      const VectorXd force = drive.compared_rows(forces[i]);
      normal += basis.transpose() * basis;
      right += basis.transpose() * force;
      all += force.squaredNorm();
    }
    const double ridge = kRidge * normal.diagonal().mean();
    normal.diagonal().array() += ridge;
    const maths::SymmetricFactors factors{normal};
    weights_ = factors.solve(right);
    resolution_ = 1 - ridge * factors.inverse().diagonal().array();
    return weights_.dot(2 * right - normal * weights_) / all;
  }

  // Without the knots that no record visits, where the ridge alone gives the value.
  [[nodiscard]] Description description(double share) const {
    Description law{"f(" + abscissa_ + ")", share, label_of(abscissa_), {}, {}, {}};
    law.is_of_terms = true;
    for (Index i = 0; i < hats_.count; ++i) {
      if (resolution_[i] < kVisited) continue;
      law.x.push_back(state_at(position_of(i, hats_.count), abscissa_, reach_));
      law.y.push_back(weights_[i]);
    }
    return law;
  }

 private:
  [[nodiscard]] VectorXd state(std::size_t record) const {
    const Drive& drive = problem_.drive(record);
    return abscissa_ == "v" ? drive.velocity.col(0) : drive.displacement.col(0);
  }

  const Problem& problem_;
  std::string abscissa_;
  Hats hats_;
  double reach_ = 1e-300;
  VectorXd weights_, resolution_;
};

// Ridge regression on one fold, scored on the other.
struct Regression {
  VectorXd weights, deviation;
  double gain = 0;  // decrease of the other fold's sum of squares
  double left = 0;  // the rest of it
};

// The rows of one output: residual and columns of a form, without what the fitted parameters can
// reproduce. Each fold may prefer other values of them, which are no part of the form.
struct Reduced {
  VectorXd residual;
  MatrixXd columns;

  Reduced(const ResidualView& view, Index output, const Form& form) {
    MatrixXd nuisance;
    view.of_output(output, form, residual, nuisance, columns);
    const Complement complement{nuisance};
    complement.take_out(residual);
    for (Index i = 0; i < columns.cols(); ++i) complement.take_out(columns.col(i));
  }
};

Regression regress(const Reduced& first, const Reduced& second, bool is_friction) {
  MatrixXd normal = first.columns.transpose() * first.columns;
  normal.diagonal().array() += kRidge * normal.diagonal().mean();
  const maths::SymmetricFactors factors{normal};
  const VectorXd c = factors.solve(first.columns.transpose() * first.residual);
  const MatrixXd inverse = factors.inverse();
  const double left = (second.residual - second.columns * c).squaredNorm();
  const double gain = second.residual.squaredNorm() - left;
  if (!is_friction) return {c, inverse.diagonal().cwiseMax(0).cwiseSqrt(), gain, left};
  const Index m = c.size() / 2;
  const VectorXd variance = (inverse.topLeftCorner(m, m) + inverse.bottomRightCorner(m, m) +
                             2 * inverse.topRightCorner(m, m))
                                .diagonal();
  return {c.head(m) + c.tail(m), variance.cwiseMax(0).cwiseSqrt(), gain, left};
}

Description curve_of(const Form& form, const Regression& best, const ResidualView& view,
                     double share) {
  Description description{form.name, share, "", {}, {}, {}};
  if (form.abscissa == "path" || form.abscissa == "t") description.over = Description::Over::Time;
  if (form.abscissa.empty()) return description;
  const ResidualView::Range* state = view.range_over(form.abscissa);
  const Index m = best.weights.size();
  for (Index i = 0; i < m; ++i) {
    const double position = position_of(i, m);
    description.x.push_back(state != nullptr
                                ? state->low + (position + 1) / 2 * (state->high - state->low)
                                : state_at(position, form.abscissa, view.reach(form.abscissa)));
    description.y.push_back(best.weights[i]);
    description.band.push_back(best.deviation[i]);
  }
  description.x_label = state != nullptr ? state->label : label_of(form.abscissa);
  return description;
}

}  // namespace

std::optional<Description> common_law(const TestedHypothesis& with,
                                      const TestedHypothesis& without) {
  const Problem& problem = with.problem();
  if (problem.drive(0).displacement.cols() != 1) return std::nullopt;
  std::vector<MatrixXd> forces;
  for (std::size_t i = 0; i < problem.records(); ++i) {
    const MatrixXd one = with.prediction(i), other = without.prediction(i);
    if (one.cols() != 1 || other.size() != one.size()) return std::nullopt;
    forces.push_back(one - other);
  }
  for (const std::string abscissa : {"u", "v"}) {
    if (abscissa == "v" && !problem.drive(0).has_time) continue;
    FineCurve curve{problem, abscissa};
    const double share = curve.fit(forces);
    if (share > kCommonLaw) return curve.description(share);
  }
  return std::nullopt;
}

void regress_forms(const TestedHypothesis& tested, const Folds& folds,
                   std::vector<Description>& found) {
  const bool has_time = tested.problem().drive(0).has_time;
  const double excess = excess_on(tested, folds.second);
  const ResidualView first{tested, folds.first}, second{tested, folds.second};
  const Index outputs = tested.problem().drive(0).measured.cols();
  for (const auto& form : forms(outputs > 1, first.load().varies(), first.control().varies())) {
    if (!has_time && form.needs_time()) continue;
    double gain = 0, left = -observations(tested.problem(), folds.second);
    Regression best;
    for (Index output = 0; output < outputs; ++output) {
      const Regression one =
          regress({first, output, form}, {second, output, form}, form.is_friction);
      gain += one.gain;
      left += one.left;
      if (output == 0 || one.gain > best.gain) best = one;
    }
    found.push_back(curve_of(form, best, first, gain / excess));
    if (!form.abscissa.empty()) found.back().left = left;
  }
}

}  // namespace rths::diagnosis
