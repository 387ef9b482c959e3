// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <rths/identification/vectors.hpp>
#include <rths/sim/composition.hpp>

namespace rths::diagnosis {

/// Part of the laboratory, from the command to the recorded signals.
enum class Part { Numerical, Actuator, Machine, Bearing, Structure, Sensor };

/// "actuator", "machine", …
[[nodiscard]] std::string name_of(Part part);

/// A term, and where in the model it acts: "" where there is one composition only, else
/// "spring.2", "input.voltage", "output.position".
struct ModelTerm {
  sim::TermSettings settings;
  std::string component;
};

/// A parameter that a fit may change.
struct FreeParameter {
  std::string name;           ///< "bouc_wen.eta": of a term, or of the model itself: "mass.1"
  std::string unit;           ///< SI
  double low, high;           ///< bounds
  double scale;               ///< size of a significant change, > 0
  bool is_tolerance = false;  ///< of the recording, not the model: a candidate may widen it
  std::optional<double> absent = {};  // NOLINT: value without any effect; none: not a size
};

/// "eta" of "bouc_wen.eta"
[[nodiscard]] std::string_view last_name(std::string_view parameter);

/// A model that may explain the records: its terms, and values of its free parameters. All other
/// parameters have the values of the terms.
struct Hypothesis {
  std::vector<ModelTerm> terms;
  std::vector<FreeParameter> free;
  VectorXd values;  ///< of `free`, within their bounds
};

/// Indices of all its free parameters.
[[nodiscard]] std::vector<Index> all_of(const Hypothesis& hypothesis);

/// Indices of those that a candidate has not replaced.
[[nodiscard]] std::vector<Index> movable_of(const Hypothesis& hypothesis);

/// A physical effect that a simulation may have left out.
struct Candidate {
  std::string name;  ///< in the verdict: that of the kind, or with its channel: "force_gain"
  std::string kind;  ///< in the catalogue; empty: a parameter of the model itself
  std::string title, equation;
  Part part = Part::Machine;
  std::string channel;  ///< role in which it shows: "force", "displacement"
  std::string axis;     ///< the only axis that it acts on, beside a candidate that acts on all axes
  std::vector<ModelTerm> adds;
  /// Terms of the model, by name, and the kind that replaces theirs: same parameters and more.
  std::vector<std::pair<std::string, std::string>> becomes;
  std::vector<FreeParameter> frees;   ///< of the added terms, or of existing ones
  std::vector<std::string> replaces;  ///< sizes of the model in whose place it stands: fixed at 0
  std::vector<VectorXd> starts;       ///< values of `frees` from which fits begin, at least one
  bool is_hidden = false;  ///< fitted parameters reproduce nearly all of it: screening cannot
                           ///< detect it, only a fit can
  bool is_rule = false;    ///< another hysteresis rule of the model, not an added effect
  bool is_exact = false;   ///< has no error of form: beside it, a small remainder is another effect
  bool corrects_form = false;  ///< adapts the form of the model and is no effect of its own: has to
                               ///< explain much
  int price = 0;               ///< number of its free parameters; the cheaper wins a tie
  std::vector<std::string> contains;  ///< its special cases: not alternatives to it
  std::vector<std::string> sum_of;    ///< candidates that together are the same law: it is named
                                      ///< instead of all of them if it explains as much
  std::vector<std::string> after;     ///< it subsumes these simpler candidates, so it is named only
                                      ///< if none of them is acceptable
};

/// Returns true if both are the same effect on the same channel, on whatever axes.
[[nodiscard]] bool is_same(const Candidate& one, const Candidate& other);

/// Returns true if a candidate is a constant error of a sensor.
[[nodiscard]] bool is_offset_of_sensor(const Candidate& candidate);

/// Returns true if a candidate changes a term that another candidate adds.
[[nodiscard]] bool depends_on(const Candidate& candidate, const Candidate& other);

/// The hypothesis with the candidate added, the candidate's parameters at a starting point.
[[nodiscard]] Hypothesis extended(const Hypothesis& hypothesis, const Candidate& candidate,
                                  const VectorXd& start);

/// Sets every free parameter that the other hypothesis has too to its value there.
void take_values(const Hypothesis& from, Hypothesis& to);

/// Returns true if every free parameter still exists after the extension. A term that becomes
/// another kind may lack a parameter that another candidate has freed.
[[nodiscard]] bool may_extend(const Hypothesis& hypothesis, const Candidate& candidate);

}  // namespace rths::diagnosis
