// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include <rths/diagnosis/case.hpp>

#include "hypothesis.hpp"

namespace rths::diagnosis {

/// The linear part of a model, between inputs u, outputs y and the forces f that terms exert where
/// they connect two points d apart:
///     x' = A x + B u + E f,  y = C x + D u + H f
///     d = P x + Q u,  d' = R x + S u,  d'' = T u
/// A sampled system has x(t + Δt) in place of x'. Terms that move a mass of their own need d'',
/// which is known only where it is measured.
struct LinearSystem {
  Eigen::MatrixXd a, b, e, c, d, h, p, q, r, s, t;
  /// Of the linear spring and damper that are in `a` already, by connection.
  Eigen::VectorXd stiffness, damping;

  [[nodiscard]] static LinearSystem zeros(Eigen::Index states, Eigen::Index inputs,
                                          Eigen::Index outputs, Eigen::Index connections);
};

/// An input of the linear part: a channel after the terms that act on it, or a rate of it.
struct PlantInput {
  std::size_t channel = 0;  ///< in `DynamicModel::inputs`
  int order = 0;            ///< 1: its rate of change, 2: the rate of that
};

/// A component where terms may act between two points of the model.
struct Connection {
  std::string component;  ///< "spring.2"
  std::string title;      ///< "between masses 1 and 2"
  std::string seen;       ///< role of the output in which it alone shows, else its component
  /// The force that belongs to it is as large as this input or output; else it is that of the
  /// linear spring and damper, or of the mass that moves there.
  std::optional<std::size_t> like_input, like_output;
};

/// A number of the linear part.
struct ModelParameter {
  std::string name, unit;  ///< "spring.2.stiffness", "N/m"
  double value = 0;
  std::string error;  ///< name of the verdict if it is wrong: "stiffness_error"; empty: none
  /// Input and output that it joins directly: what it may be is in proportion to them.
  std::optional<std::pair<std::size_t, std::size_t>> joins;
};

/// What happens to inputs between samples.
enum class Hold {
  Linear,  ///< a line from each to the next
  Zero,    ///< each lasts until the next
  Smooth   ///< the band-limited signal through them (Whittaker-Shannon, Kaiser window)
};

/// A dynamic system as [model] describes it: a linear part, and where terms may act. On inputs and
/// outputs the component is their role.
struct DynamicModel {
  std::string name;                 ///< "input to output"
  std::vector<std::string> inputs;  ///< roles
  bool has_terms_on_inputs = true;  ///< false: nothing stands between them and the records
  std::vector<PlantInput> plant_inputs;
  std::vector<std::string> outputs;  ///< roles
  std::vector<Connection> connections;
  std::vector<ModelParameter> parameters;
  std::vector<ModelTerm> terms;                                ///< that the simulation already had
  std::function<LinearSystem(const Eigen::VectorXd&)> linear;  ///< at values of `parameters`
  double sampled_every = 0;  ///< of a system in discrete time [s]; 0: continuous
  Hold hold = Hold::Linear;
  bool has_free_start = false;  ///< its state at the first sample is not known
  int substeps = 0;             ///< steps per sample, 0: as many as are needed

  [[nodiscard]] Eigen::VectorXd values() const;
};

/// @throws Error file:line:column for a table that describes no such model   @setup
[[nodiscard]] DynamicModel read_mass_spring_damper(const Config& table);
[[nodiscard]] DynamicModel read_structure(const Config& table);
[[nodiscard]] DynamicModel read_linear(const Config& table);
/// @param record  tells what is predicted and what is measured
[[nodiscard]] DynamicModel read_data(const Config& table, const Record& record);

}  // namespace rths::diagnosis
