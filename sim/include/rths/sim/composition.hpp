// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/sim/term.hpp>

namespace rths::sim {

inline constexpr unsigned kBothAxes = 0b11;

/// One term of a configuration.
struct TermSettings {
  std::string kind;
  std::string name;                                        ///< empty: the kind's name
  std::vector<std::pair<std::string, double>> parameters;  ///< by name, SI; the rest: defaults
  unsigned axes = kBothAxes;                               ///< bit 0: long, bit 1: lat
  SensorChannel channel = SensorChannel::Force;            ///< of a sensor term
};

/// The term's own name, or its kind if it has none.
[[nodiscard]] const std::string& name_of(const TermSettings& settings);

/// Terms that act one after another: a bearing, a machine, a chain of sensors.
///
/// Const once built. Its state is a plain array of numbers owned by the caller; all zeros is the
/// virgin state. Copy the array to restore a state later.
class Composition {
 public:
  struct Term {
    const TermKind* kind;
    std::string name;
    unsigned axes;
    SensorChannel channel;
    std::size_t first_parameter, first_state, first_constant;
  };

  Composition() = default;
  /// Sorts the terms into the catalogue's order.
  /// @param time_step  of every `advance` [s], > 0
  /// @throws Error for an unknown kind or parameter, a value out of bounds, a name used twice
  /// @setup
  Composition(const std::vector<TermSettings>& terms, double time_step);

  [[nodiscard]] std::span<const Term> terms() const { return terms_; }
  [[nodiscard]] double time_step() const { return time_step_; }
  /// All parameters, term after term.
  [[nodiscard]] std::span<const double> parameters() const { return parameters_; }
  /// Index of a parameter in `parameters()`. @throws Error if there is none   @setup
  [[nodiscard]] std::size_t parameter_index(const std::string& term,
                                            const std::string& parameter) const;
  [[nodiscard]] std::size_t states() const { return states_; }

  /// Advances one time step to the motion in `q` and fills in the results of all terms.
  /// @param parameters  in the order of `parameters()`; duals carry the derivatives
  /// @param state  of length `states()`   @realtime
  void advance(std::span<const double> parameters, std::span<double> state,
               Quantities<double>& q) const RTHS_REALTIME;
  void advance(std::span<const Dual> parameters, std::span<Dual> state,
               Quantities<Dual>& q) const RTHS_REALTIME;
  void advance(std::span<double> state, Quantities<double>& q) const RTHS_REALTIME {
    advance(parameters_, state, q);
  }
  /// Sets `last_specimen_force` of the next step [N], for compliant terms of a composition without
  /// the specimen.   @realtime
  void set_specimen_force(std::span<double> state,
                          const Horizontal<double>& force) const RTHS_REALTIME;
  void set_specimen_force(std::span<Dual> state,
                          const Horizontal<double>& force) const RTHS_REALTIME;

 private:
  double time_step_ = 0;
  std::vector<Term> terms_;
  std::vector<double> parameters_, constants_;
  std::size_t states_ = 0;
};

/// Name and unit of a channel in a configuration: "force" in "N".
struct ChannelName {
  std::string_view channel, unit;
};
[[nodiscard]] const ChannelName& name_of(SensorChannel channel);

/// "actuator", "motion", …
[[nodiscard]] std::string_view stage_name(Stage stage);

/// The object that terms belong to. A specimen has no actuators, no sensors and no acceleration
/// input; a machine has no specimen physics; neither has a control input.
enum class TermOwner { Any, Specimen, Machine };

/// @throws Error if the owner cannot have this term   @setup
void check_owner(const TermSettings& term, TermOwner owner);

/// Bounds of parameters: those of the catalogue, or none for a system in other units or sizes.
enum class ParameterBounds { Catalogue, None };

/// Reads the terms of a table. Each subtable is a term. Its key is the kind, or any name if the
/// subtable has `kind = "…"`. A parameter may be an array [long, lat] if the kind acts on each
/// axis. `enabled = false` leaves a term out.
///
///     [specimen.bouc_wen]
///     characteristic_strength_N = 1_010_000
///
/// @throws Error with the place of the first wrong key or value, or of a term that its owner cannot
///         have   @setup
[[nodiscard]] std::vector<TermSettings> read_terms(
    const Config& table, TermOwner owner = TermOwner::Any,
    ParameterBounds bounds = ParameterBounds::Catalogue);

/// Key of a parameter in a configuration: "stiffness" in "N/m" is "stiffness_N_per_m".   @setup
[[nodiscard]] std::string parameter_key(const Parameter& parameter, SensorChannel channel);

}  // namespace rths::sim
