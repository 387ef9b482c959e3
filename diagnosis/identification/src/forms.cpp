// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/forms.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>

#include <Eigen/Core>

#include <fmt/format.h>

#include <rths/algebra/decompositions.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/scores.hpp>
#include <rths/identification/signal.hpp>

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

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
struct Signals {
  VectorXd u, v, other_u, other_v, load, control;
};

struct Form {
  std::string name;
  std::string abscissa;  // u, v, N or I of the curve; empty: no curve
  std::function<MatrixXd(const Signals&)> design;
};

constexpr double kRidge = 1e-3;        // of the mean square of the columns
constexpr double kLeastExcess = 0.05;  // mean w² beyond 1: less may be an error of the noise
constexpr double kSteadyShare = 0.05;  // of its size: a state that varies less is held constant

VectorXd bent(const VectorXd& v) { return (v.array() / 0.05).asinh(); }
const double kBentReach = std::asinh(1 / 0.05);

VectorXd sign_of(const VectorXd& v) {
  return v.unaryExpr([](double x) { return std::tanh(x / 0.01); });
}

// Curves over a state, and friction, viscosity and stiffness with a factor that depends on it.
void add_state(const std::string& symbol, VectorXd Signals::*state, std::vector<Form>& all) {
  const Hats range{0, 1, 9};
  all.push_back({"f(" + symbol + ")", symbol, [=](const Signals& s) { return range(s.*state); }});
  all.push_back({"sgn(v) g(" + symbol + ")", symbol, [=](const Signals& s) -> MatrixXd {
                   return sign_of(s.v).asDiagonal() * range(s.*state);
                 }});
  all.push_back({"v g(" + symbol + ")", symbol,
                 [=](const Signals& s) -> MatrixXd { return s.v.asDiagonal() * range(s.*state); }});
  all.push_back({"u g(" + symbol + ")", symbol,
                 [=](const Signals& s) -> MatrixXd { return s.u.asDiagonal() * range(s.*state); }});
}

std::vector<Form> forms(bool has_other, bool has_load, bool has_control) {
  const Hats coarse{-1, 1, 14}, fine{-1, 1, 100}, middle{-1, 1, 41};
  const Hats speed{-kBentReach, kBentReach, 19};
  std::vector<Form> all{
      {"f(u)", "u", [=](const Signals& s) { return coarse(s.u); }},
      {"periodic in displacement", "u", [=](const Signals& s) { return fine(s.u); }},
      {"f(v)", "v", [=](const Signals& s) { return speed(bent(s.v)); }},
      {"sgn(v) g(u)", "u",
       [=](const Signals& s) -> MatrixXd { return sign_of(s.v).asDiagonal() * middle(s.u); }},
      {"v g(u)", "u", [=](const Signals& s) -> MatrixXd { return s.v.asDiagonal() * coarse(s.u); }},
      {"g(u, v)", "", [](const Signals& s) {
         const MatrixXd a = Hats{-1, 1, 9}(s.u), b = Hats{-kBentReach, kBentReach, 9}(bent(s.v));
         MatrixXd surface(a.rows(), 81);
         for (Index i = 0; i < 9; ++i)
           for (Index k = 0; k < 9; ++k) surface.col(9 * i + k) = a.col(i).cwiseProduct(b.col(k));
         return surface;
       }}};
  if (has_load) add_state("N", &Signals::load, all);
  if (has_control) add_state("I", &Signals::control, all);
  if (has_other) {
    all.push_back(
        {"f(u of the other axis)", "", [=](const Signals& s) { return coarse(s.other_u); }});
    all.push_back(
        {"f(v of the other axis)", "", [=](const Signals& s) { return speed(bent(s.other_v)); }});
    all.push_back({"f(v_long v_lat)", "", [=](const Signals& s) {
                     return Hats{-1, 1,
                                 21}((s.v.cwiseProduct(s.other_v).array() / 0.05).asinh().matrix() /
                                     kBentReach);
                   }});
    all.push_back({"f(u_long, u_lat)", "", [](const Signals& s) {
                     const MatrixXd a = Hats{-1, 1, 9}(s.u), b = Hats{-1, 1, 9}(s.other_u);
                     MatrixXd surface(a.rows(), 81);
                     for (Index i = 0; i < 9; ++i)
                       for (Index k = 0; k < 9; ++k)
                         surface.col(9 * i + k) = a.col(i).cwiseProduct(b.col(k));
                     return surface;
                   }});
  }
  return all;
}

// Residual of a hypothesis on a fold, its derivatives, and the ranges of the recorded states.
class ResidualView {
 public:
  ResidualView(const Supposition& supposition, const Fold& fold)
      : supposition_{supposition}, fold_{fold} {
    std::vector<Index> all(supposition.hypothesis().free.size());
    std::iota(all.begin(), all.end(), Index{0});
    static_cast<void>(
        supposition.evaluate(fold, supposition.hypothesis().values, all, residual_, jacobian_));
    const Problem& problem = supposition.problem();
    for (std::size_t i = 0; i < problem.records(); ++i) {
      const Drive& drive = problem.drive(i);
      if (drive.displacement.size() == 0) continue;
      u_ = std::max(u_, drive.displacement.cwiseAbs().maxCoeff());
      v_ = std::max(v_, drive.velocity.cwiseAbs().maxCoeff());
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
  [[nodiscard]] double reach(const std::string& abscissa) const {
    return abscissa == "v" ? v_ : u_;
  }

  // Rows of one output: residual, derivatives of the fitted parameters, whitened columns of a form.
  void of_output(Index output, const Form* form, VectorXd& residual, MatrixXd& nuisance,
                 MatrixXd& columns) const {
    const Problem& problem = supposition_.problem();
    std::vector<Index> rows;
    Index first = 0;
    std::vector<MatrixXd> designs;
    for (const auto& share : fold_.shares) {
      const Drive& drive = problem.drive(share.record);
      const Index count = drive.rows();
      for (Index row = 0; row < count; ++row) rows.push_back(first + output * count + row);
      if (form != nullptr) designs.push_back(white(share, output, *form));
      first += count * drive.measured.cols();
    }
    residual = residual_(rows);
    nuisance = jacobian_(rows, Eigen::all);
    if (form == nullptr) return;
    columns.resize(static_cast<Index>(rows.size()), designs[0].cols());
    Index row = 0;
    for (const auto& design : designs) {
      columns.middleRows(row, design.rows()) = design;
      row += design.rows();
    }
  }

 private:
  static bool is_load(const std::string& name) { return name.starts_with("axial load"); }
  static bool is_control(const std::string& name) { return name.starts_with("auxiliary."); }
  Range* range_of(const std::string& name) {
    if (is_load(name)) return &load_;
    return is_control(name) ? &control_ : nullptr;
  }

  [[nodiscard]] MatrixXd white(const Fold::Share& share, Index output, const Form& form) const {
    const Problem& problem = supposition_.problem();
    const Drive& drive = problem.drive(share.record);
    const Index other = drive.measured.cols() > 1 ? 1 - output : output;
    Signals signals{drive.displacement.col(output) / u_,
                    drive.velocity.col(output) / v_,
                    drive.displacement.col(other) / u_,
                    drive.velocity.col(other) / v_,
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

  const Supposition& supposition_;
  const Fold& fold_;
  VectorXd residual_;
  MatrixXd jacobian_;
  double u_ = 1e-300, v_ = 1e-300;
  Range load_, control_;
};

// Ridge regression on one fold, scored on the other.
struct Regression {
  VectorXd weights, deviation;
  double gain = 0;  // decrease of the other fold's sum of squares
};

Regression regress(const VectorXd& w1, const MatrixXd& nuisance1, const MatrixXd& columns1,
                   const VectorXd& w2, const MatrixXd& nuisance2, const MatrixXd& columns2) {
  const Index m = columns1.cols(), n = nuisance1.cols();
  MatrixXd X1(w1.size(), m + n), X2(w2.size(), m + n);
  VectorXd scale(n);
  for (Index i = 0; i < n; ++i)
    scale[i] = std::sqrt(static_cast<double>(w1.size())) / (nuisance1.col(i).norm() + 1e-300);
  X1 << columns1, nuisance1 * scale.asDiagonal();
  X2 << columns2, nuisance2 * scale.asDiagonal();
  MatrixXd normal = X1.transpose() * X1;
  const double size = normal.diagonal().head(m).mean();
  // Relative to the columns, so that the result does not depend on the unit of the output.
  normal.diagonal().head(m).array() += kRidge * size;
  normal.diagonal().tail(n).array() += 1e-3;
  const algebra::SymmetricFactors factors{normal};
  const VectorXd c = factors.solve(X1.transpose() * w1);
  const MatrixXd inverse = factors.inverse();
  return {c.head(m), inverse.diagonal().head(m).cwiseMax(0).cwiseSqrt(),
          w2.squaredNorm() - (w2 - X2 * c).squaredNorm()};
}

Description curve_of(const Form& form, const Regression& best, const ResidualView& view,
                     double share) {
  Description description{form.name, share, "", {}, {}, {}};
  if (form.abscissa.empty()) return description;
  const ResidualView::Range* state = form.abscissa == "N"   ? &view.load()
                                     : form.abscissa == "I" ? &view.control()
                                                            : nullptr;
  const Index m = best.weights.size();
  for (Index i = 0; i < m; ++i) {
    double x = 2 * static_cast<double>(i) / static_cast<double>(m - 1) - 1;
    if (form.abscissa == "v")
      x = 0.05 * std::sinh(x * kBentReach) * view.reach("v");
    else if (state != nullptr)
      x = state->low + (x + 1) / 2 * (state->high - state->low);
    else
      x *= view.reach("u");
    description.x.push_back(x);
    description.y.push_back(best.weights[i]);
    description.band.push_back(best.deviation[i]);
  }
  description.x_label = form.abscissa == "v" ? "velocity [m/s]"
                        : state != nullptr   ? state->label
                                             : "displacement [m]";
  return description;
}

// Adds the strongest spectral line that both folds have; its share is its energy over the excess.
void add_line(const VectorXd& w1, const VectorXd& w2, double time_step, double excess,
              std::vector<Description>& found) {
  constexpr int kWindow = 512;
  if (w1.size() < kWindow || w2.size() < kWindow) return;
  const Spectrum a = power_spectrum(w1, kWindow, time_step);
  const Spectrum b = power_spectrum(w2, kWindow, time_step);
  const auto around = [&](const Spectrum& s, Index i) {
    std::vector<double> near;
    for (Index k = std::max<Index>(3, i - 20); k < std::min(s.density.size(), i + 20); ++k)
      near.push_back(s.density[k]);
    return quantile(near, 0.5);
  };
  Index line = 6;
  double sharpest = 0;
  for (Index i = 6; i + 3 < a.density.size(); ++i) {
    const double ratio = a.density[i] / std::max(around(a, i), 1e-300);
    if (ratio > sharpest) sharpest = ratio, line = i;
  }
  const double again =
      b.density.segment(line - 1, 3).maxCoeff() / std::max(around(b, line), 1e-300);
  if (sharpest < 12 || again < 8) return;
  const double energy = b.density.segment(line - 2, 5).sum() * (b.frequency[1] - b.frequency[0]) *
                        static_cast<double>(w2.size());
  found.push_back({fmt::format("external periodic force at {:.2f} Hz", a.frequency[line]),
                   std::min(0.99, energy / excess),
                   "",
                   {},
                   {},
                   {}});
}

// The sudden change of one parameter that explains most of a residual.
struct Change {
  double explained = 0;  // energy
  double time = 0;       // [s]
};

// The part of a parameter's derivative from row `cut` of each output on.
VectorXd from_row(const MatrixXd& jacobian, Index column, Index cut, const Drive& drive) {
  VectorXd g = jacobian.col(column);
  for (Index output = 0; output < drive.measured.cols(); ++output)
    g.segment(output * drive.rows(), cut).setZero();
  return g;
}

// Tries 40 times of change on one record. Sets `parameter` to the name of the best one's parameter.
Change best_change(const VectorXd& w, const MatrixXd& J, const Complement& complement,
                   const Drive& drive, const Hypothesis& hypothesis, std::string& parameter) {
  Change best;
  for (int k = 0; k < 40; ++k) {
    const auto cut = static_cast<Index>((0.12 + 0.0165 * k) * static_cast<double>(drive.rows()));
    for (Index j = 0; j < J.cols(); ++j) {
      VectorXd g = from_row(J, j, cut, drive);
      complement.take_out(g);
      const double square = g.squaredNorm();
      const double explained = square > 0 ? std::pow(g.dot(w), 2) / square : 0;
      if (explained <= best.explained) continue;
      best = {explained, drive.start + static_cast<double>(cut) * drive.time_step};
      parameter = hypothesis.free[static_cast<std::size_t>(j)].name;
    }
  }
  return best;
}

// Adds the sudden change of a parameter that explains most, found on each record separately.
void add_change(const Supposition& supposition, const Folds& folds,
                std::vector<Description>& found) {
  const auto& hypothesis = supposition.hypothesis();
  std::vector<Index> all(hypothesis.free.size());
  std::iota(all.begin(), all.end(), Index{0});
  double gain = 0, excess = 0;
  std::vector<double> times;
  std::string parameter;
  for (const auto& share : folds.both.shares) {
    VectorXd w;
    MatrixXd J;
    if (!supposition.evaluate(whole({share.record}), hypothesis.values, all, w, J)) return;
    const Complement complement{J};
    complement.take_out(w);
    const Change best = best_change(w, J, complement, supposition.problem().drive(share.record),
                                    hypothesis, parameter);
    gain += best.explained;
    excess += w.squaredNorm() - static_cast<double>(w.size());
    times.push_back(best.time);
  }
  if (times.size() < 2) return;
  excess = std::max(excess, kLeastExcess * observations(supposition.problem(), folds.both));
  const auto [first, last] = std::minmax_element(times.begin(), times.end());
  const double share = gain / excess * (*last - *first < 1.5 ? 1 : 0.5);
  found.push_back(
      {fmt::format("change of {} at {:.1f} s", parameter, times[0]), share, "", {}, {}, {}});
}

// The model with a free form, fitted to the first fold.
std::optional<Hypothesis> with_form(const Supposition& base, const FreeForm& form,
                                    const Fold& fold) {
  Hypothesis hypothesis = extended(base.hypothesis(), form.term, form.term.starts[0]);
  const auto fit = fit_if_possible(base.problem(), hypothesis, fold, kLongFit);
  if (!fit) return std::nullopt;
  hypothesis.values = fit->parameters;
  return hypothesis;
}

Description described_by(const FreeForm& form, const Problem& problem, const Fold& fold,
                         const Hypothesis& fitted, double share) {
  constexpr double kNormal95 = 1.96;
  Description description{form.term.name, share, form.label, form.knots, {}, {}};
  for (const auto& estimate : estimates_of(fitted, covariance_of(problem, fold, fitted)))
    for (const auto& free : form.term.frees)
      if (free.name == estimate.name) {
        description.y.push_back(estimate.value);
        description.band.push_back((estimate.high - estimate.low) / 2 / kNormal95);
      }
  return description;
}

// Forms that act on the predicted state: the best ones by their linearised effect are fitted to one
// fold and simulated on the other.
void add_free_forms(const Supposition& supposition, const Folds& folds,
                    const std::vector<FreeForm>& forms, std::vector<Description>& found) {
  constexpr std::size_t kFitted = 4;
  const Problem& problem = supposition.problem();
  const Supposition base{problem,
                         fitted(problem, supposition.hypothesis(), folds.first, kShortFit)};
  const double excess = std::max(kLeastExcess, base.variance(folds.second) - 1);
  std::vector<Candidate> terms;
  for (const auto& form : forms) terms.push_back(form.term);
  const auto screened = screen(base, folds.first, terms);
  for (std::size_t i = 0; i < std::min(kFitted, screened.size()); ++i) {
    const FreeForm& form = forms[static_cast<std::size_t>(screened[i].candidate - terms.data())];
    const auto with = with_form(base, form, folds.first);
    if (!with) continue;
    const double rest = Supposition{problem, *with}.variance(folds.second) - 1;
    found.push_back(described_by(form, problem, folds.first, *with, (excess - rest) / excess));
  }
}

// Forms over the measured states that drive the prediction.
void add_regressions(const Supposition& supposition, const Folds& folds, double excess,
                     std::vector<Description>& found) {
  const ResidualView first{supposition, folds.first}, second{supposition, folds.second};
  const Index outputs = supposition.problem().drive(0).measured.cols();
  VectorXd w1, w2;
  MatrixXd J1, J2, X1, X2;
  for (const auto& form : forms(outputs > 1, first.load().varies(), first.control().varies())) {
    double gain = 0;
    Regression best;
    for (Index output = 0; output < outputs; ++output) {
      first.of_output(output, &form, w1, J1, X1);
      second.of_output(output, &form, w2, J2, X2);
      const Regression one = regress(w1, J1, X1, w2, J2, X2);
      gain += one.gain;
      if (output == 0 || one.gain > best.gain) best = one;
    }
    found.push_back(curve_of(form, best, first, gain / excess));
  }
}

// Energy of the residual beyond the noise on a fold.
double excess_on(const Supposition& supposition, const Fold& fold) {
  const double n = observations(supposition.problem(), fold);
  return n * std::max(kLeastExcess, supposition.variance(fold) - 1);
}

}  // namespace

std::vector<Description> describe(const Supposition& supposition, const Folds& folds) {
  std::vector<Description> found;
  const Problem& problem = supposition.problem();
  const Drive& any = problem.drive(0);
  const double excess = excess_on(supposition, folds.second);
  const auto free_forms = problem.relation().forms(supposition.hypothesis());
  if (!free_forms.empty())
    add_free_forms(supposition, folds, free_forms, found);
  else if (any.displacement.size() > 0 && !problem.relation().runs_freely())
    add_regressions(supposition, folds, excess, found);
  // In a free run, a resonance looks like a line.
  if (any.displacement.size() > 0 && !problem.relation().runs_freely()) {
    const ResidualView first{supposition, folds.first}, second{supposition, folds.second};
    VectorXd w1, w2;
    MatrixXd J1, J2, X1, X2;
    first.of_output(0, nullptr, w1, J1, X1);
    second.of_output(0, nullptr, w2, J2, X2);
    add_line(w1, w2, any.time_step, excess / static_cast<double>(any.measured.cols()), found);
  }
  add_change(supposition, folds, found);
  // A surface contains every curve over one of its arguments, so it must explain more than the
  // curve.
  const auto worth = [](const Description& one) {
    constexpr double kPriceOfSurface = 0.1;
    const bool is_surface = one.form == "g(u, v)" || one.form == "f(u_long, u_lat)";
    return one.share - (is_surface ? kPriceOfSurface : 0);
  };
  std::stable_sort(found.begin(), found.end(),
                   [&](const Description& a, const Description& b) { return worth(a) > worth(b); });
  return found;
}

}  // namespace rths::diagnosis
