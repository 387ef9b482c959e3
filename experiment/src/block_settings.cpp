// SPDX-License-Identifier: Apache-2.0
#include <rths/experiment/block_settings.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::experiment {
namespace {

/// A bearing along some of its axes.
class AssumedSpecimen final : public controller::SpecimenModel {
 public:
  /// @param directions  of the axes: 0 long, 1 lat
  AssumedSpecimen(const sim::Bearing& bearing, std::vector<Eigen::Index> directions, double period)
      : run_{bearing, period},
        load_at_rest_{bearing.axial_load},
        directions_{std::move(directions)},
        force_{Eigen::VectorXd::Zero(static_cast<Eigen::Index>(directions_.size()))} {}

  [[nodiscard]] const Eigen::VectorXd& move(const Eigen::VectorXd& displacement,
                                            const Eigen::VectorXd& velocity,
                                            double axial_load) noexcept override {
    Eigen::Vector2d u = Eigen::Vector2d::Zero(), v = u;
    for (Eigen::Index i = 0; i < force_.size(); ++i) {
      u[direction(i)] = displacement[i];
      v[direction(i)] = velocity[i];
    }
    const Eigen::Vector2d force =
        run_.advance(u, v, std::isfinite(axial_load) ? axial_load : load_at_rest_);
    for (Eigen::Index i = 0; i < force_.size(); ++i) force_[i] = force[direction(i)];
    return force_;
  }

 private:
  [[nodiscard]] Eigen::Index direction(Eigen::Index axis) const {
    return directions_[static_cast<std::size_t>(axis)];
  }

  sim::BearingRun run_;
  double load_at_rest_;
  std::vector<Eigen::Index> directions_;
  Eigen::VectorXd force_;
};

struct Range {
  double low, high;
};
constexpr Range kMass{0, 1e9}, kFriction{0, 1e9}, kViscousFriction{0, 1e9}, kOffset{-1e9, 1e9},
    kLoadFriction{0, 1}, kPresliding{1e-7, 0.1}, kDelay{0, 0.02}, kSamplingDelay{0, 10},
    kDisplacementLead{-0.02, 0.02};

// Values as `per_axis` returns them. @throws Error also for a value of an axis that is not tested
std::vector<double> per_axis_in(const Config& table, const std::string& key,
                                const std::vector<std::string>& axes, const Range& range,
                                double otherwise) {
  auto values = per_axis(table, key, axes, otherwise);
  const auto given = table.numbers(key, {});
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!(given[i] >= range.low && given[i] <= range.high))
      table.fail(key, fmt::format("{} of axis '{}' is {}, expected {} to {}", key,
                                  name_of(kAxes[i]), given[i], range.low, range.high));
  return values;
}

controller::Polynomial read_polynomial(const Config& table, const std::string& key) {
  const std::string name = table.text(key, "D2");
  if (const auto polynomial = controller::polynomial_from_text(name)) return *polynomial;
  table.fail(key, fmt::format("{} is '{}', expected P0 to P3, D1 to D3, DV or DVA", key, name));
}

// One value per axis and coefficient.
std::vector<controller::InverseCoefficients> read_coefficients(
    const Config& table, const std::string& prefix, const std::vector<std::string>& axes,
    const controller::InverseCoefficients& otherwise) {
  std::vector<controller::InverseCoefficients> found(axes.size(), otherwise);
  for (const auto& [output, key, value] : controller::kInverseCoefficients) {
    const auto values = per_axis(table, prefix + key, axes, otherwise.*value);
    for (std::size_t i = 0; i < axes.size(); ++i) found[i].*value = values[i];
  }
  return found;
}

}  // namespace

controller::MakeSpecimen assumed_specimen(const sim::Bearing& bearing,
                                          const std::vector<std::string>& axes, double period) {
  std::vector<Eigen::Index> directions;
  for (const auto& axis : axes) directions.push_back(axis == name_of(Axis::Lat) ? 1 : 0);
  return [bearing, directions, period] {
    return std::make_unique<AssumedSpecimen>(bearing, directions, period);
  };
}

std::size_t index_of_axis(const std::string& axis) {
  const auto known = axis_named(axis);
  return known ? index_of(*known) : kAxes.size();
}

std::vector<double> per_axis(const Config& table, const std::string& key,
                             const std::vector<std::string>& axes, double otherwise) {
  std::vector<double> values;
  const auto given = table.numbers(key, {});
  if (given.size() > kAxes.size() || (given.empty() && table.has(key)))
    table.fail(key, fmt::format("{} has {} numbers, expected one per axis, long first", key,
                                given.size()));
  for (const auto& axis : axes) {
    const std::size_t order = index_of_axis(axis);
    if (given.empty())
      values.push_back(otherwise);
    else if (order < given.size())
      values.push_back(given[order]);
    else
      table.fail(key,
                 fmt::format("{} has {} numbers, none for axis '{}'", key, given.size(), axis));
  }
  return values;
}

controller::PredictorCorrectorSettings predictor_corrector_settings(const Config& table) {
  controller::PredictorCorrectorSettings settings;
  settings.slow_down_from = table.number_in("slow_down_from", 0.1, 0.95, settings.slow_down_from);
  settings.hold_at = table.number_in("hold_at", 0, 0.99, settings.hold_at);
  settings.predictor = read_polynomial(table, "predictor");
  settings.corrector = read_polynomial(table, "corrector");
  settings.targets_carry_rates = table.flag("targets_carry_rates", false);
  settings.largest_xi = table.number_in("largest_xi", 0.1, 0.99, settings.largest_xi);
  return settings;
}

bool is_one_tick(double simulation_step, double tick) {
  return std::abs(simulation_step - tick) <= 1e-9 * tick;
}

std::vector<int> sampling_delays(const Config& table, const std::vector<std::string>& axes,
                                 double period) {
  std::vector<int> delays;
  for (const double delay : per_axis_in(table, "sampling_delay_s", axes, kSamplingDelay, 0))
    delays.push_back(static_cast<int>(std::lround(delay / period)));
  return delays;
}

std::vector<controller::AdaptiveInverseSettings> adaptive_inverse_settings(
    const Config& table, const std::vector<std::string>& axes, double period) {
  controller::AdaptiveInverseSettings settings;
  settings.period = period;
  const auto initial = read_coefficients(table, "", axes, settings.initial);
  const auto uncertainty = read_coefficients(table, "uncertainty_", axes, settings.uncertainty);
  const auto capacity = per_axis(table, "force_capacity_N", axes, settings.force_capacity);
  const auto mass = per_axis(table, "effective_mass_kg", axes, settings.effective_mass);
  const auto limits = per_axis(table, "limits", axes, settings.largest_reference);
  settings.a4 = table.number_in("a4_s4", 0, 1e-3, settings.a4);
  settings.lead_time = table.number_in("lead_time_s", 0, 1, settings.lead_time);
  settings.sign_velocity =
      table.number_in("sign_velocity_m_per_s", 1e-4, 10, settings.sign_velocity);
  settings.smoothing = table.number_in("smoothing_s", 1e-5, 0.1, settings.smoothing);
  settings.average = table.number_in("average_s", 0, 0.1, settings.average);
  const auto oil_columns = per_axis(table, "oil_column_Hz", axes, settings.oil_column);
  settings.forgetting = table.number_in("forgetting_s", 0.1, 1000, settings.forgetting);
  settings.error = table.number_in("error_m", 1e-6, 1, settings.error);
  settings.cutoff = table.number_in("cutoff_Hz", 0.1, 1000, settings.cutoff);
  settings.informative_speed =
      table.number_in("informative_speed_m_per_s", 0, 10, settings.informative_speed);
  settings.largest_error = table.number_in("largest_error_m", 1e-6, 10, settings.largest_error);
  std::vector<controller::AdaptiveInverseSettings> found(axes.size(), settings);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    found[i].initial = initial[i];
    found[i].uncertainty = uncertainty[i];
    found[i].force_capacity = capacity[i];
    found[i].effective_mass = mass[i];
    found[i].largest_reference = limits[i];
    found[i].oil_column = oil_columns[i];
  }
  return found;
}

controller::TargetForceSettings target_force_settings(const Config& table,
                                                      const std::vector<std::string>& axes,
                                                      double period, double interval,
                                                      const sim::Bearing* specimen) {
  controller::TargetForceSettings settings;
  settings.axes = static_cast<int>(axes.size());
  settings.period = period;
  settings.interval = interval;
  const bool has_sliders = table.has("reach_m") || table.has("smooth_reach_m");
  if (specimen != nullptr && !has_sliders && !table.has("expected_strengths_N"))
    settings.specimen = assumed_specimen(*specimen, axes, period);
  settings.reach = table.numbers("reach_m", settings.reach);
  settings.smooth_reach = table.numbers("smooth_reach_m", settings.smooth_reach);
  settings.expected = table.numbers("expected_strengths_N", {});
  settings.forgetting = table.number_in("forgetting_s", 0.1, 1000, settings.forgetting);
  settings.informative_speed =
      table.number_in("informative_speed_m_per_s", 0, 10, settings.informative_speed);
  settings.motion_bandwidth =
      table.number_in("motion_bandwidth_Hz", 0.01, 40, settings.motion_bandwidth);
  settings.lead_time = table.number_in("lead_time_s", 0, 0.1, settings.lead_time);
  return settings;
}

ForceObserverSettings force_observer_settings(const Config& table,
                                              const std::vector<std::string>& axes) {
  const auto mass = per_axis_in(table, "effective_mass_kg", axes, kMass, 0);
  const auto coulomb = per_axis_in(table, "coulomb_friction_N", axes, kFriction, 0);
  const auto viscous = per_axis_in(table, "viscous_friction_N_s_per_m", axes, kViscousFriction, 0);
  const auto offset = per_axis_in(table, "force_offset_N", axes, kOffset, 0);
  const double exponent = table.number_in("exponent", 0.1, 2, 1.0);
  const double rest = table.number_in("rest_velocity_m_per_s", 0, 1, 1.27e-3);
  ForceObserverSettings settings;
  settings.slope_samples =
      static_cast<int>(table.integer_in("slope_samples", 3, 1000, settings.slope_samples));
  for (std::size_t i = 0; i < axes.size(); ++i)
    settings.machine.push_back({mass[i], coulomb[i], viscous[i], exponent, offset[i], rest});
  return settings;
}

TableForceObserverSettings table_force_observer_settings(const Config& table,
                                                         const std::vector<std::string>& axes,
                                                         double period) {
  const auto mass = per_axis_in(table, "effective_mass_kg", axes, kMass, 0);
  const auto coulomb = per_axis_in(table, "coulomb_friction_N", axes, kFriction, 0);
  const auto load = per_axis_in(table, "load_friction", axes, kLoadFriction, 0);
  const auto viscous = per_axis_in(table, "viscous_friction_N_s_per_m", axes, kViscousFriction, 0);
  const auto offset = per_axis_in(table, "force_offset_N", axes, kOffset, 0);
  const auto presliding = per_axis_in(table, "presliding_m", axes, kPresliding, 1e-3);
  const auto delay = per_axis_in(table, "accelerometer_delay_s", axes, kDelay, 0);
  const auto lead = per_axis_in(table, "displacement_lead_s", axes, kDisplacementLead, 0);
  TableForceObserverSettings settings;
  settings.observer.period = period;
  settings.observer.velocity_bandwidth =
      table.number_in("velocity_bandwidth_Hz", 0.01, 100, settings.observer.velocity_bandwidth);
  settings.observer.cutoff = table.number_in("cutoff_Hz", 0, 1000, settings.observer.cutoff);
  for (std::size_t i = 0; i < axes.size(); ++i)
    settings.machine.push_back(
        {mass[i], coulomb[i], load[i], viscous[i], offset[i], presliding[i], delay[i], lead[i]});
  return settings;
}

namespace {

void replace_keys(std::vector<Config>& blocks, const Config& changes) {
  std::vector<std::string> names;
  for (auto& block : blocks) {
    names.push_back(block.text("name", ""));
    if (changes.has(names.back())) block = block.overlaid(changes.table(names.back()));
  }
  for (const auto& key : changes.keys())
    if (std::find(names.begin(), names.end(), key) == names.end())
      changes.fail(key,
                   fmt::format("the diagram has no block '{}'{}", key, did_you_mean(key, names)));
}

}  // namespace

DiagramChoice read_diagram_choice(const Config& table) {
  DiagramChoice choice{find_file(table, "diagram", "diagrams"), {}, {}};
  if (table.has("constants")) choice.constants = table.resolve(table.text("constants"));
  choice.blocks = table.table_or_empty("blocks");
  return choice;
}

std::vector<Config> blocks_of(const Config& diagram, const std::filesystem::path& constants,
                              const Config& experiment) {
  auto blocks = diagram.tables("block");
  if (!constants.empty()) replace_keys(blocks, Config::load(constants));
  replace_keys(blocks, experiment);
  return blocks;
}

}  // namespace rths::experiment
