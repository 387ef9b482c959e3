// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rths::diagnosis {

/// None and Unknown are answers of equal rank with Missing.
enum class Outcome {
  Missing,  ///< terms of the catalogue that the simulation left out
  None,     ///< what remains is noise
  Unknown   ///< something systematic that no term of the catalogue explains
};

/// Where something stands in the laboratory, from the command to what is recorded.
enum class Part { Numerical, Actuator, Machine, Bearing, Structure, Sensor };

/// A parameter that was fitted, with the interval that holds it in 95 of 100 cases.
struct Estimate {
  std::string name;  ///< "coulomb_friction_long.friction_force"
  std::string unit;  ///< SI
  double value = 0, low = 0, high = 0;
};

/// A term that cannot be told from the one that is named.
struct Alternative {
  std::string name, title;
  double share = 0;  ///< of what the named term gains on records that it was not fitted to [-]
  std::string test;  ///< that would tell them apart; empty: none of those that are known
  double sigma = 0;  ///< how far apart they are in that test [standard deviations]
};

/// A term that the simulation left out.
struct Cause {
  std::string name;  ///< as in the catalogue, or what it is on its channel: "accelerometer_gain"
  std::string title, equation;
  Part part = Part::Machine;
  bool is_rule = false;   ///< not a term besides: the model's rule of hysteresis is another
  std::string channel;    ///< role in which it is seen: "force", "displacement"
  double confidence = 0;  ///< share of resampled records in which it is the best [-]
  double explained = 0;   ///< of the energy beyond the noise [-]
  std::vector<Estimate> parameters;
  std::vector<Alternative> alternatives;
};

/// A part of the plane of displacement and velocity.
struct StateCell {
  std::pair<double, double> displacement, velocity;  ///< from, to [m], [m/s]
  double share = 0;                                  ///< of the energy beyond the noise [-]
};

/// Energy beyond the noise over something, cell by cell.
struct Profile {
  std::string name;  ///< "axial load"
  std::string unit;
  std::vector<double> edges;  ///< one more than cells
  std::vector<double>
      share;  ///< of the energy beyond the noise; < 0 where there is less than noise
};

/// Where the mismatch is, before any term is named: the smallest sets of cells that hold 80 % of
/// the energy beyond the noise.
struct Where {
  Part part = Part::Machine;
  std::string channel;                               ///< role: "force.long", or "force" of several
  std::string record;                                ///< that the maps are of
  std::vector<std::pair<double, double>> intervals;  ///< [s]
  std::vector<std::pair<double, double>> bands;      ///< [Hz]
  std::vector<StateCell> states;
  std::vector<StateCell> state_map;  ///< every cell that was visited, for pictures; may be empty
  std::vector<Profile> profiles;     ///< time, frequency, and what else was recorded
};

/// How well a record is predicted. Errors are root mean squares over the standard deviation of what
/// was measured, both through the same filter, offset removed.
struct RecordScore {
  std::string record, use;  ///< "fit", "held_out"
  double nrmse_before = 0;  ///< fitted again without the terms that are named
  double nrmse_after = 0;   ///< with them
  double nrmse_stated = 0;  ///< the simulation as it is stated, nothing fitted
  double noise_floor = 0;   ///< what the noise of the sensors alone makes
  double variance_before = 0, variance_after = 0;  ///< of the whitened residual; 1: noise [-]
};

/// What the proof gives if the answer is changed.
struct Ablation {
  std::string what;  ///< "without coulomb_friction", "quadratic_drag instead of coulomb_friction"
  double nrmse = 0;  ///< on the record of the proof
};

/// The form of something that has no name: the mean of the residual over what it depends on.
struct Description {
  std::string form;     ///< "f(u)", "sgn(v) g(u)", "external periodic force"
  double share = 0;     ///< of the energy beyond the noise that it explains on another record [-]
  std::string x_label;  ///< what it is a curve over, with its unit
  std::vector<double> x, y, band;  ///< curve [unit of the output] and its standard deviation
};

/// A column of evidence: what each candidate explains by itself.
struct Evidence {
  std::string name, title;
  double gain = 0, low = 0, high = 0;  ///< log-likelihood per observation, 90 % bootstrap [nat]
};

/// Before and after on a record, for pictures: equally long, thinned.
struct Trace {
  std::string record, channel, unit;
  std::vector<double> time;      ///< [s]
  std::vector<double> abscissa;  ///< displacement or input; may be empty
  std::string abscissa_label;
  std::vector<double> measured, stated, before, after;  ///< [unit]
  std::vector<double> excess;                           ///< share of excess energy, by sample
};

/// A parameter of the simulation that was fitted again. What is missing hides in these: they tell
/// by how much they had to lie.
struct Refitted {
  std::string name, unit;  ///< unit: SI
  double stated = 0;       ///< by the case
  double before = 0;       ///< fitted without the terms that are named
  double after = 0;        ///< with them
};

/// The motion of a test, as a command would have it.
struct TestMotion {
  double time_step = 0;                                               ///< [s]
  std::vector<std::pair<std::string, std::vector<double>>> channels;  ///< by role [SI]
};

/// Everything that was found about a case.
struct Verdict {
  std::string case_name;
  Outcome outcome = Outcome::None;
  std::string sentence;  ///< all of it in one
  Where where;
  std::vector<Cause> causes;
  double confidence = 0;       ///< in the outcome [-]
  bool has_remainder = false;  ///< something systematic is left besides what is named
  std::vector<RecordScore> fit;
  std::vector<Refitted> refitted;
  std::string proof_record;  ///< never used before the proof; empty: there was none
  std::vector<Ablation> ablation;
  bool residual_white = false;
  std::vector<double> residual_correlation;  ///< of the proof, from lag 1 on
  double correlation_bound = 0;  ///< ± this much holds 95 % of the lags of noise; 0: not known
  std::vector<Description> descriptions;  ///< best first
  std::vector<Evidence> evidence;         ///< best first, of the first term
  std::vector<std::string> limits;        ///< channels missing, noise model used, states unseen
  std::string next_test;                  ///< what to run next; empty: nothing
  TestMotion next_motion;                 ///< of it; no channels: there is none
  std::string noise_model;                ///< where the noise was taken from
  std::string fragment;                   ///< TOML of the improved model, for experiments
  std::vector<Trace> traces;
  bool synthetic = false;  ///< the recordings come from models, not from a laboratory
  double seconds = 0;      ///< it took
};

/// "missing", "none", "unknown"
[[nodiscard]] std::string name_of(Outcome outcome);
/// "actuator", "machine", …
[[nodiscard]] std::string name_of(Part part);

}  // namespace rths::diagnosis
