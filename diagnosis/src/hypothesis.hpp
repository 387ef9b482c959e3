// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rths/diagnosis/verdict.hpp>
#include <rths/sim/composition.hpp>

namespace rths::diagnosis {

/// A term, and where in the model it acts: "" where there is one composition only, else
/// "spring.2", "input.voltage", "output.position".
struct ModelTerm {
  sim::TermSettings settings;
  std::string component;
};

/// A parameter that a fit may move.
struct FreeParameter {
  std::string name;           ///< "bouc_wen.eta": of a term, or of the model itself: "mass.1"
  std::string unit;           ///< SI
  double low, high;           ///< bounds
  double scale;               ///< a change that matters, > 0
  bool is_tolerance = false;  ///< of the recording, not of the model: a candidate may widen it
};

/// What is supposed to be going on: terms, and the values of those parameters that may move. All
/// others stand at what the terms say.
struct Hypothesis {
  std::vector<ModelTerm> terms;
  std::vector<FreeParameter> free;
  Eigen::VectorXd values;  ///< of `free`, within their bounds
};

/// Something that a simulation may have left out.
struct Candidate {
  std::string name;  ///< of the verdict: that of the kind, or "force_gain" of a sensor's channel
  std::string kind;  ///< in the catalogue; empty: of the model itself
  std::string title, equation;
  Part part = Part::Machine;
  std::string channel;  ///< role of what it shows in: "force", "displacement"
  std::vector<ModelTerm> adds;
  /// Terms of the model, by name, that become another kind with the same parameters and more.
  std::vector<std::pair<std::string, std::string>> becomes;
  std::vector<FreeParameter> frees;     ///< of what it adds, or of what is there already
  std::vector<Eigen::VectorXd> starts;  ///< values of `frees` from which fits begin, at least one
  bool is_hidden = false;  ///< nearly all of it can be made by what is fitted anyway: only a fit of
                           ///< both together tells
  bool is_rule = false;    ///< the rule of hysteresis itself is another: says nothing of what else
                           ///< there is
  int price = 0;           ///< parameters that it may choose; the cheaper wins a tie
  std::vector<std::string> contains;  ///< what it is as a special case: no rivals of it
  std::vector<std::string> after;  ///< named only once none of these is worth naming: it would do
                                   ///< its own work and theirs
};

/// The hypothesis with the candidate in it, its parameters at one of its starts.
[[nodiscard]] Hypothesis extended(const Hypothesis& hypothesis, const Candidate& candidate,
                                  const Eigen::VectorXd& start);

/// Whether all that would be fitted are parameters of what the terms would then be: where one
/// becomes another kind, that may lack what another candidate frees.
[[nodiscard]] bool may_extend(const Hypothesis& hypothesis, const Candidate& candidate);

}  // namespace rths::diagnosis
