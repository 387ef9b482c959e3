// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <rths/identification/selection.hpp>

namespace rths::diagnosis {

/// Form of an unknown effect: the mean residual over the variable that it depends on.
struct Description {
  std::string form;     ///< "f(u)", "sgn(v) g(u)", "external periodic force"
  double share = 0;     ///< of the energy beyond the noise, explained on the other fold [-]
  std::string x_label;  ///< variable of the curve, with its unit
  /// Curve [unit of the output] over the variable, and its standard deviation; none of a law of
  /// terms
  std::vector<double> x, y, band;
  enum class Over {
    State,   ///< fitted to one fold, and explains the other
    Time,    ///< the same, but noise has tones and rounding errors drift, too
    Records  ///< found on each record
  };
  Over over = Over::State;
  bool is_of_pieces = false;  ///< the folds are pieces of the same records
  bool is_of_terms = false;   ///< the law of all named terms together, not of what they leave
  /// Output with this residual, without axis; in verdicts. Lists of initial values omit it.
  std::string channel = {};  // NOLINT(readability-redundant-member-init)
  /// What a curve leaves of this energy; infinite: not known, or no curve.
  double left = std::numeric_limits<double>::infinity();
};

/// Describes the form of a residual that no term explains: curves and surfaces over recorded or
/// predicted quantities, a lasting sine, held samples, a sudden change. Best first, by the share of
/// the energy beyond the noise that each explains. Curves, surfaces and sines are fitted to one
/// fold and explain the other; held samples and changes are found on each record.
[[nodiscard]] std::vector<Description> describe(const TestedHypothesis& tested, const Folds& folds);

/// The least energy beyond the noise on a fold that is left by a curve which is fitted to it
/// together with the parameters; infinite without any. A surface would also fit what another effect
/// leaves.
[[nodiscard]] double least_left(const TestedHypothesis& tested, const Fold& fold);

/// The curve over displacement or velocity that the terms of one hypothesis, which the other lacks,
/// draw together on one axis, at the knots that the records visit: another law of this form fits
/// the records as well. None if their force depends on more.
[[nodiscard]] std::optional<Description> common_law(const TestedHypothesis& with,
                                                    const TestedHypothesis& without);

}  // namespace rths::diagnosis
