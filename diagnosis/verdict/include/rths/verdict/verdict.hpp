// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <rths/budget/budget.hpp>
#include <rths/budget/response_bands.hpp>
#include <rths/cases/case.hpp>
#include <rths/experiment_design/proposal.hpp>
#include <rths/identification/forms.hpp>
#include <rths/identification/hypothesis.hpp>
#include <rths/identification/intervals.hpp>
#include <rths/identification/relation_findings.hpp>

namespace rths::diagnosis {

/// Result of a diagnosis. None and Unknown are full answers, like Missing.
enum class Outcome {
  Missing,  ///< the simulation left out terms of the catalogue
  None,     ///< the residual is noise
  Unknown   ///< a systematic discrepancy that no term of those searched explains
};

/// A term that the records cannot distinguish from the named one.
struct Alternative {
  std::string name, title;
  double share = 0;  ///< its gain on rows it was not fitted to, over the named term's gain [-]
  std::string test;  ///< that would separate the two; empty: no known test does
  double sigma = 0;  ///< separation in that test [standard deviations]
};

/// What speaks for a name, on rows that its term was not fitted to.
struct Support {
  double gain = 0;  ///< log-likelihood [nat]
  double lead = 0;  ///< of the gain over that of the best candidate that is no alternative, over
                    ///< the gain [-]; 1: none gains half as much
  double best = 0;  ///< share of the resampled records in which no other candidate gains more [-]
};

/// A term that the simulation left out.
struct Cause {
  std::string name;  ///< in the catalogue, or with its channel: "accelerometer_gain"
  std::string title, equation;
  Part part = Part::Machine;
  bool is_rule = false;   ///< replaces the model's rule of hysteresis instead of adding a term
  std::string channel;    ///< role in which it appears: "force", "displacement"
  double confidence = 0;  ///< how often a name like this one is right [-], shared with alternatives
  double explained = 0;   ///< of the energy beyond the noise: the share of all causes, divided in
                          ///< proportion to their gains [-]; NaN: steps of a sensor have none
  Support support;
  std::vector<Estimate> parameters;
  std::vector<Alternative> alternatives;
};

/// A name that is more often wrong than right: no cause, but a law that describes what is missing.
[[nodiscard]] inline bool is_guess(const Cause& cause) {
  constexpr double kLikely = 0.5;
  return cause.confidence < kLikely;
}

/// A cell of the displacement-velocity plane.
struct StateCell {
  std::pair<double, double> displacement, velocity;  ///< from, to [m], [m/s]
  double share = 0;                                  ///< of the energy beyond the noise [-]
};

/// Energy beyond the noise over one variable, by cell.
struct Profile {
  std::string name;  ///< "axial load"
  std::string unit;
  std::vector<double> edges;  ///< one more than cells
  std::vector<double> share;  ///< of the energy beyond the noise; < 0: less energy than noise
};

/// Place of the mismatch: the smallest sets of cells that hold 80 % of its energy.
struct Where {
  Part part = Part::Machine;
  std::string channel;       ///< role: "force.long"; several: "force"
  std::string record;        ///< of the maps
  bool is_of_named = false;  ///< the named terms' contribution; else the residual beyond the noise
  bool has_time = true;      ///< of the record; else the intervals are rows, and have no bands
  std::vector<std::pair<double, double>> intervals;  ///< [s]
  std::vector<std::pair<double, double>> bands;      ///< [Hz]
  std::vector<StateCell> states;
  std::vector<StateCell> state_map;  ///< all visited cells, for figures; may be empty
  std::vector<Profile> profiles;     ///< over time, frequency and other recorded variables
};

/// Error of the proof with a changed set of terms.
struct Ablation {
  std::string what;  ///< "without coulomb_friction", "quadratic_drag instead of coulomb_friction"
  double nrmse = 0;  ///< on the record of the proof
};

/// Evidence for one candidate alone.
struct CandidateEvidence {
  std::string name, title;
  double gain = 0, low = 0, high = 0;  ///< log-likelihood per observation, 90 % bootstrap [nat]
};

/// Measurement and predictions of a record before and after: equally long, compared rows only.
/// Free offsets of the predictions are removed.
struct Trace {
  std::string record, channel, unit;
  std::string use;    ///< of the record: "fit", "held_out"
  double cutoff = 0;  ///< of the low-pass filter that all curves passed [Hz]; 0: none
  bool has_time = true;
  std::vector<double> time;      ///< [s]; without time the rows
  std::vector<double> abscissa;  ///< displacement or input; may be empty
  std::string abscissa_label;
  std::vector<double> measured, stated, before, after;  ///< [unit]
  /// Predictions without one of several named causes, everything else fitted again, by its name.
  /// Of the records that a page shows.
  std::vector<std::pair<std::string, std::vector<double>>> without;
  std::vector<double> noise;   ///< standard deviation of the residual's noise [unit]
  std::vector<double> excess;  ///< share of the excess energy, by sample
};

/// A refitted parameter of the simulation. Left-out physics biases these parameters: `before` and
/// `after` show by how much.
struct Refitted {
  std::string name, unit;  ///< unit: SI
  double stated = 0;       ///< in the case
  double before = 0;       ///< fitted without the named terms
  double after = 0;        ///< with them
};

/// Errors over all records of the proof: of the held-out records, or of the fitted ones if there
/// are none. Root mean squares over the standard deviation of the measurement.
struct ProofSummary {
  double before = 0;               ///< refitted without the named terms
  double after = 0;                ///< with them
  double floor = 0;                ///< of sensor noise alone
  double explained = 0;            ///< of the energy of the error beyond the noise [-]
  bool is_systematic = false;      ///< the error that is left is coloured and well above the noise
  bool has_noise_at_rest = false;  ///< the noise was measured, not guessed from samples in motion
  bool is_noise_known = true;      ///< measured, stated or guessed; else `floor` means nothing
};

/// What one relation between the channels shows.
struct RelationVerdict {
  std::string name;                  ///< "motion to force"
  std::vector<std::string> outputs;  ///< roles of the predicted channels
  Outcome outcome = Outcome::None;
  bool has_remainder = false;       ///< a systematic residual is left
  std::vector<std::string> causes;  ///< names of causes and guesses
  std::string common_law;    ///< "f(v)": all of them are parts of one law; empty: they are not
  bool is_held_out = false;  ///< the proof is one on unseen records
  double left = 0;           ///< energy beyond the noise that the named terms leave [nat]
  ProofSummary proof;
};

/// The answer of a diagnosis.
struct Conclusion {
  Outcome outcome = Outcome::None;
  double confidence = 0;       ///< in the outcome [-]
  std::vector<Cause> causes;   ///< and guesses; all are terms of the improved simulation
  bool has_remainder = false;  ///< besides the causes, something else is missing, or a guess is
  /// Outputs with a systematic residual that no term explains, without axis: "displacement".
  std::vector<std::string> unexplained;
  std::vector<std::string> withdrawn;  ///< titles of terms that were selected and are not named
  Where where;
};

/// Simulation and measurement of the relation that is shown, without and with the named terms.
struct Evaluation {
  std::vector<RecordScore> fit;
  std::vector<Refitted> refitted;
  ProofSummary proof;
  std::string proof_record;   ///< last record that was not used before; empty: there is none
  Whiteness residual;         ///< of the proof
  std::vector<Trace> traces;  ///< of every record and output
};

/// Terms of the catalogue that a diagnosis considers.
struct ConsideredTerms {
  std::vector<std::string> assumed;   ///< the simulation already has them
  std::vector<std::string> searched;  ///< effects that could have been named
};

/// The test to run next.
struct ProposedTest {
  std::string text;   ///< empty: none
  TestMotion motion;  ///< no channels: there is none
};

/// Where the noise of the sensors is known from.
struct NoiseBasis {
  std::string source;
  std::string remedy;      ///< how to measure the noise; empty: it was measured at rest
  bool is_stated = false;  ///< in the case
};

/// The part of the measured force of a record that the named model and the sensors' noise leave.
struct ForceRemainder {
  double time_step = 0;                      ///< [s]
  std::array<std::vector<double>, 2> force;  ///< long, lat [N]; empty: not measured
};

/// The simulation with the named causes.
struct ImprovedModel {
  std::string fragment;  ///< TOML of the improved model, for experiments
  CaseSource source;     ///< the improved case, and experiment; empty: none
  /// Fragments whose specimen has the parameters one standard deviation away, in both senses along
  /// each of their independent directions: two for each.
  std::vector<std::string> deviations;
  ForceRemainder remainder;  ///< of the first record
};

/// All results of a diagnosis.
struct Verdict {
  std::string case_name;
  /// The tested object in a word, "device", where the records do not tell it from its machine;
  /// empty where they do, as those of a run.
  std::string specimen;
  std::string sentence;  ///< the summary
  Conclusion conclusion;
  std::vector<RelationVerdict> relations;  ///< that of `evaluation` first
  Evaluation evaluation;
  std::vector<Ablation> ablation;
  std::vector<Description> descriptions;    ///< best first
  std::vector<CandidateEvidence> evidence;  ///< best first, of the first term
  ConsideredTerms terms;
  ProposedTest next;
  NoiseBasis noise;
  std::vector<std::string> limits;  ///< missing channels, source of the noise, unvisited states
  ImprovedModel improvement;
  budget::MismatchBudget budget;  ///< of the response of a run; empty: none
  budget::ResponseBands bands;    ///< of the improved simulation of a run; empty: none
  bool synthetic = false;         ///< the recordings come from models, not from a laboratory
  double seconds = 0;             ///< run time
};

/// Adds the mismatch budget of a run to its verdict and its sentence. If no term explains the
/// residual of the actuator, an identified transfer system becomes its cause, with its parameters;
/// terms of the actuator that were named on the way are withdrawn, also from the improved model.
/// The errors then compare the transfer system with a displacement equal to the reference. Causes,
/// forms and remainder of other outputs stay.   @setup
void add_budget(budget::MismatchBudget budget, Verdict& verdict);

/// A verdict for a reader who has a minute.
struct Answers {
  std::string headline;   ///< at most 25 words and three numbers
  std::string missing;    ///< what is missing, and where
  std::string certainty;  ///< how sure that is
  std::string next;       ///< what to do now
};
[[nodiscard]] Answers answers_of(const Verdict& verdict);

/// Name of a part of the laboratory in a verdict: "machine", "device".
[[nodiscard]] std::string place_of(Part part, const Verdict& verdict);

/// "missing", "none", "unknown"
[[nodiscard]] std::string name_of(Outcome outcome);

}  // namespace rths::diagnosis
