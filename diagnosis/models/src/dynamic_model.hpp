// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/cases/case.hpp>
#include <rths/identification/hypothesis.hpp>
#include <rths/identification/vectors.hpp>

namespace rths::diagnosis {

/// The linear system of a model, with inputs u, outputs y, and the forces f of terms in
/// connections. A connection joins two points; d is their relative displacement:
///     x' = A x + B u + E f,  y = C x + D u + H f
///     d = P x + Q u,  d' = R x + S u,  d'' = T u
/// A sampled system has x(t + Δt) in place of x'. Terms with a mass need d'', which is known only
/// if it was measured.
struct LinearSystem {
  MatrixXd a, b, e, c, d, h, p, q, r, s, t;
  /// Of the linear spring and damper, which `a` includes, by connection.
  VectorXd stiffness, damping;

  [[nodiscard]] static LinearSystem zeros(Index states, Index inputs, Index outputs,
                                          Index connections);
};

/// An input of the linear system: a channel after the terms that act on it, or a rate of it.
struct PlantInput {
  std::size_t channel = 0;  ///< in `DynamicModel::inputs`
  int order = 0;            ///< 1: its rate of change, 2: its second rate
};

/// A component between two points of the model, on which terms may act.
struct Connection {
  std::string component;  ///< "spring.2"
  std::string title;      ///< "between masses 1 and 2"
  std::string seen;       ///< the output that it alone affects; if there is none, the component
  /// Input or output with the size of its force. None: the size is that of the linear spring and
  /// damper, or of the moving mass.
  std::optional<std::size_t> like_input, like_output;
  bool is_port = false;  ///< of a simulation that runs
  /// A port with unknown forces: their size is that of a unit mass in its motion.
  bool is_of_unit_mass = false;
};

/// A parameter of the linear system.
struct ModelParameter {
  std::string name, unit;  ///< "spring.2.stiffness", "N/m"
  double value = 0;
  std::string error;  ///< name in verdicts of a wrong value: "stiffness_error"; empty: none
  /// Input and output that it joins directly: their sizes set its bounds.
  std::optional<std::pair<std::size_t, std::size_t>> joins;
  /// None: a tenth to ten times the value.
  // NOLINTNEXTLINE(readability-redundant-member-init): initializers may leave it out
  std::optional<std::pair<double, double>> bounds = {};
  double step = 0;  ///< of its differences; 0: a hundredth of its scale
};

/// Inputs between samples.
enum class Hold {
  Linear,  ///< linear interpolation
  Zero,    ///< each sample is held until the next
  Smooth   ///< the band-limited signal through the samples (Whittaker-Shannon, Kaiser window)
};

/// A dynamic system as in [model]: a linear system, and the components on which terms may act. For
/// inputs and outputs the component is the role.
struct DynamicModel {
  std::string name;                 ///< "input to output"
  std::vector<std::string> inputs;  ///< roles
  /// Inputs on which terms may act; none: they equal the records. Absent: all.
  std::optional<std::vector<std::string>> inputs_with_terms;
  std::vector<PlantInput> plant_inputs;
  std::vector<std::string> outputs;  ///< roles
  std::vector<Connection> connections;
  std::vector<ModelParameter> parameters;
  std::vector<ModelTerm> terms;                         ///< of the simulation
  std::function<LinearSystem(const VectorXd&)> linear;  ///< at values of `parameters`
  double sampled_every = 0;  ///< time step of a discrete-time system [s]; 0: continuous
  Hold hold = Hold::Linear;
  bool has_free_start = false;  ///< the state at the first sample is not known
  int substeps = 0;             ///< steps per sample; 0: determined from the model

  [[nodiscard]] VectorXd values() const;
};

struct ForeignPort;

/// @throws Error file:line:column if the table does not describe such a model   @setup
[[nodiscard]] DynamicModel read_mass_spring_damper(const Config& table);
[[nodiscard]] DynamicModel read_structure(const Config& table);
[[nodiscard]] DynamicModel read_linear(const Config& table);
/// @param record  has the predicted and the measured channels
[[nodiscard]] DynamicModel read_data(const Config& table, const Record& record);
/// What a simulation that runs has beside its predictions.
struct PredictedFrom {
  std::vector<std::string> inputs;  ///< on which terms may act
  std::vector<ModelParameter> parameters;
  std::vector<ForeignPort> ports;
};
/// The same for predictions that a simulation computes. Terms at its ports do not change the linear
/// system: the simulation takes their forces.
[[nodiscard]] DynamicModel read_predicted(const Config& table, const Record& record,
                                          PredictedFrom from);

}  // namespace rths::diagnosis
