// SPDX-License-Identifier: Apache-2.0
#include "state_coverage.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <rths/identification/signal.hpp>

namespace rths::diagnosis {
namespace {

constexpr Index kCells = 12;  // along a state

// A state that a test can choose.
enum class CoveredState { Displacement, Velocity, OtherDisplacement, OtherVelocity, Load, Control };

struct Dependence {
  std::vector<CoveredState> states;
  std::string name;
};

bool holds(const std::string& text, const char* phrase) {
  return text.find(phrase) != std::string::npos;
}

// States on which a form depends; none: on time alone, or on a state that no test can choose.
Dependence dependence_of(const std::string& form) {
  using enum CoveredState;
  if (holds(form, "u of the other")) return {{OtherDisplacement}, "the other axis' displacement"};
  if (holds(form, "v of the other")) return {{OtherVelocity}, "the other axis' velocity"};
  if (holds(form, "v_long")) return {{Velocity, OtherVelocity}, "the velocities of both axes"};
  if (holds(form, "u_long")) return {{Displacement, OtherDisplacement}, "the plane of both axes"};
  if (holds(form, "(N)")) return {{Load, Velocity}, "axial load and velocity"};
  if (holds(form, "(I)")) return {{Control, Velocity}, "control and velocity"};
  if (holds(form, "periodic force") || holds(form, "change of")) return {};
  if (form.starts_with("f(v)")) return {{Velocity}, "velocity"};
  if (form.starts_with("f(u)") || holds(form, "periodic in"))
    return {{Displacement}, "displacement"};
  return {{Displacement, Velocity}, "displacement and velocity"};
}

// States of a drive, by row; predicted ones if the states are its outputs.
class States {
 public:
  States(const Problem& problem, const Hypothesis& named, std::size_t record, bool are_outputs)
      : drive_{problem.drive(record)},
        displacement_{drive_.displacement},
        velocity_{drive_.velocity} {
    if (!are_outputs) return;
    displacement_ = TestedHypothesis{problem, named}.prediction(record);
    for (Index i = 0; i < displacement_.cols(); ++i)
      velocity_.col(i) = rate_of(displacement_.col(i), drive_.time_step);
  }

  [[nodiscard]] VectorXd operator[](CoveredState state) const {
    const Index other = displacement_.cols() - 1;
    if (displacement_.size() == 0) return {};
    switch (state) {
      case CoveredState::Displacement:
        return displacement_.col(0);
      case CoveredState::Velocity:
        return velocity_.col(0);
      case CoveredState::OtherDisplacement:
        return displacement_.col(other);
      case CoveredState::OtherVelocity:
        return velocity_.col(other);
      case CoveredState::Load:
        return named("axial load");
      case CoveredState::Control:
        break;
    }
    return named("auxiliary.");
  }

 private:
  [[nodiscard]] VectorXd named(const char* prefix) const {
    for (const auto& [name, values] : drive_.states)
      if (name.starts_with(prefix)) return values;
    return {};
  }

  const Drive& drive_;
  MatrixXd displacement_, velocity_;
};

struct StateRange {
  double low = 1e300, high = -1e300;

  void widen(const VectorXd& values) {
    if (values.size() == 0) return;
    low = std::min(low, values.minCoeff());
    high = std::max(high, values.maxCoeff());
  }
  [[nodiscard]] Index cell(double value) const {
    return std::clamp<Index>(static_cast<Index>((value - low) / (high - low) * kCells), 0,
                             kCells - 1);
  }
};

// Entropy of the time spent in the cells of some states, divided by its maximum.
double evenness(const States& states, const Dependence& on, const std::vector<StateRange>& ranges) {
  std::vector<double> cells(static_cast<std::size_t>(
      std::pow(static_cast<double>(kCells), static_cast<double>(on.states.size()))));
  std::vector<VectorXd> values;
  for (const CoveredState state : on.states) values.push_back(states[state]);
  const Index rows = values[0].size();
  if (rows == 0) return 0;
  for (Index row = 0; row < rows; ++row) {
    Index cell = 0;
    for (std::size_t i = 0; i < values.size(); ++i)
      cell = cell * kCells + ranges[i].cell(values[i][row]);
    cells[static_cast<std::size_t>(cell)] += 1 / static_cast<double>(rows);
  }
  double entropy = 0;
  for (const double share : cells)
    if (share > 0) entropy -= share * std::log(share);
  return entropy / std::log(static_cast<double>(cells.size()));
}

}  // namespace

std::optional<Widest> widest(const Problem& records, const Problem& tests, const Hypothesis& named,
                             const std::string& form) {
  const Dependence on = dependence_of(form);
  if (on.states.empty() || tests.records() == 0) return std::nullopt;
  const Drive& first = records.drive(0);
  const bool are_outputs =
      first.displacement.size() == first.measured.size() && first.displacement == first.measured;
  std::vector<StateRange> ranges(on.states.size());
  for (std::size_t i = 0; i < records.records(); ++i) {
    const States states{records, named, i, false};
    for (std::size_t k = 0; k < ranges.size(); ++k) ranges[k].widen(states[on.states[k]]);
  }
  for (const auto& range : ranges)
    if (!(range.high > range.low)) return std::nullopt;
  std::optional<Widest> best;
  double most = 0;
  for (std::size_t test = 0; test < tests.records(); ++test) {
    const double even = evenness({tests, named, test, are_outputs}, on, ranges);
    if (even <= most) continue;
    most = even;
    best = {test, on.name};
  }
  return best;
}

}  // namespace rths::diagnosis
