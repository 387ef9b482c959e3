// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/empty_table_run.hpp>

#include <cmath>
#include <span>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/commissioning/recorded.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>

namespace rths::commissioning {
namespace {

constexpr std::string_view kKeyCharacters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";  // of a bare key in TOML
constexpr double kSameInterval = 1e-3;  // of recordings that are fitted together [-]

using controller::TableForce;
using controller::TableIdentification;
using Json = nlohmann::ordered_json;

/// The signals of one axis in one recording.
struct Run {
  Recorded signals;
  bool has_load = false;
  [[nodiscard]] controller::TableRecording view() const {
    const auto& values = signals.values;
    return {values[0], values[1], values[2],
            has_load ? std::span<const double>{values[3]} : std::span<const double>{}};
  }
};

Run read_run(const recording::Reader& run, const recording::AxisRoles& axis,
             const std::string& load) {
  std::vector<std::string> names{axis.machine_displacement, axis.machine_acceleration,
                                 axis.machine_force};
  const bool has_load = run.has(load);
  if (has_load) names.push_back(load);
  return {recorded(run, names), has_load};
}

TableIdentification identify(const std::vector<Run>& runs) {
  controller::TableIdentificationSettings settings;
  settings.period = runs.front().signals.interval;
  std::vector<controller::TableRecording> views;
  for (const auto& run : runs) {
    if (std::abs(run.signals.interval / settings.period - 1) > kSameInterval)
      throw Error{fmt::format("recorded every {} s and every {} s, expected one interval",
                              settings.period, run.signals.interval)};
    views.push_back(run.view());
  }
  return controller::identify_table_force(views, settings);
}

bool is_of_table(const std::string& type) { return type == "table_force_observer"; }

/// A row of the table, and a member of the JSON document.
struct Quantity {
  const char *name, *key, *unit;
  double TableForce::*value;
  double scale;
};
constexpr Quantity kQuantities[] = {
    {"effective mass", "effective_mass_kg", "kg", &TableForce::effective_mass, 1},
    {"Coulomb friction", "coulomb_friction_N", "N", &TableForce::coulomb_friction, 1},
    {"  per vertical load", "load_coefficient", "", &TableForce::load_friction, 1},
    {"viscous friction", "viscous_friction_N_s_per_m", "N·s/m", &TableForce::viscous_friction, 1},
    {"offset", "force_offset_N", "N", &TableForce::offset, 1},
    {"presliding length", "presliding_mm", "mm", &TableForce::presliding, 1e3},
    {"accelerometer's delay", "acceleration_delay_ms", "ms", &TableForce::accelerometer_delay, 1e3},
    {"displacement's lead", "displacement_lead_ms", "ms", &TableForce::displacement_lead, 1e3}};

// A key of a block: values by axis in the order long, lat. Without a test along long, its value is
// that of lat: a key cannot omit it.
template <class Value>
std::string key_of(const EmptyTableRuns& runs, const char* key, Value value) {
  double values[2] = {0, 0};
  int count = 0;
  for (const auto& axis : runs.axes) {
    const int i = axis.name == name_of(Axis::Long) ? 0 : 1;
    values[i] = value(axis.fit.machine);
    count = std::max(count, i + 1);
  }
  if (count == 2 && runs.axes.size() == 1) values[0] = values[1];
  return count == 2 ? fmt::format("{} = [{:.6g}, {:.6g}]\n", key, values[0], values[1])
                    : fmt::format("{} = [{:.6g}]\n", key, values[0]);
}

// A real machine does not state whether it has a specimen.
bool has_virtual_specimen(const recording::Reader& run, const recording::Roles& roles) {
  const auto experiment = recording::experiment_in(run);
  if (!experiment) return false;
  const auto machine = experiment->table_or_empty("node").table_or_empty(roles.machine);
  return machine.text("adapter", "") == "srmd" &&
         !experiment->table_or_empty("machine").flag("empty_table", false);
}

std::vector<Run> recordings_of(const std::vector<std::filesystem::path>& files,
                               const std::string& axis) {
  std::vector<Run> recordings;
  for (const auto& file : files) {
    const recording::Reader run{file};
    const auto roles = recording::roles_of(run);
    if (has_virtual_specimen(run, roles))
      throw Error{file.string() +
                  ": is a test with a specimen, expected [machine] empty_table = true"};
    for (const auto& names : roles.axes)
      if (names.axis == axis)
        recordings.push_back(
            recording::of_file(file, [&] { return read_run(run, names, roles.load); }));
  }
  return recordings;
}

}  // namespace

EmptyTableRuns identify_empty_table(const std::vector<std::filesystem::path>& files, double load) {
  EmptyTableRuns runs;
  runs.files = files;
  runs.load = load;
  for (const std::string& axis : names_of(kHorizontal)) {
    const auto recordings = recordings_of(files, axis);
    if (recordings.empty()) continue;
    try {
      runs.axes.push_back({axis, identify(recordings)});
      if (std::isnan(runs.load)) runs.load = std::round(runs.axes.back().fit.mean_load);
    } catch (const Error& error) {
      throw Error{fmt::format("{}: {}", axis, error.what())};
    }
  }
  if (runs.axes.empty()) throw Error{"the recordings have no axis long or lat"};
  return runs;
}

std::string text_of(const EmptyTableRuns& runs) {
  std::string text;
  for (const auto& [name, fit] : runs.axes) {
    text += fmt::format("{}: {:.2f} m/s at most; 95 % intervals\n", name, fit.largest_speed);
    for (const auto& quantity : kQuantities) {
      if (quantity.value == &TableForce::load_friction && !fit.has_load_friction) continue;
      text += fmt::format("  {:<24}{:>12.5g} ± {:<10.3g}{}\n", quantity.name,
                          quantity.scale * fit.machine.*quantity.value,
                          quantity.scale * fit.half_width.*quantity.value, quantity.unit);
    }
    text += fmt::format(
        "  residual                {:.2f} kN RMS, {:.1f} kN peak, of samples in motion; {:.2f} kN "
        "and {:.1f} kN below 25 Hz\n"
        "  correlation of it       {:.2f} between means of 40 ms, {:.0f} % of 20 lags beyond the "
        "bound of white noise (5 % if white)\n",
        fit.sample_rms / 1e3, fit.sample_peak / 1e3, fit.residual_rms / 1e3,
        fit.residual_peak / 1e3, fit.neighbour_correlation, 1e2 * fit.correlated_share);
  }
  return text;
}

std::string json_of(const EmptyTableRuns& runs) {
  Json document{{"load_N", runs.load}, {"axes", Json::object()}};
  for (const auto& [name, fit] : runs.axes) {
    Json axis;
    for (const auto& quantity : kQuantities)
      axis[quantity.key] = {{"value", quantity.scale * fit.machine.*quantity.value},
                            {"half_width_95", quantity.scale * fit.half_width.*quantity.value}};
    axis["load_varies"] = fit.has_load_friction;
    axis["residual_rms_N"] = fit.sample_rms;
    axis["residual_peak_N"] = fit.sample_peak;
    axis["smoothed_residual_rms_N"] = fit.residual_rms;
    axis["smoothed_residual_peak_N"] = fit.residual_peak;
    axis["neighbour_correlation"] = fit.neighbour_correlation;
    axis["correlated_share"] = fit.correlated_share;
    axis["largest_speed_m_per_s"] = fit.largest_speed;
    document["axes"][name] = axis;
  }
  return document.dump(2) + "\n";
}

std::string toml_of(const EmptyTableRuns& runs, const std::string& block, const std::string& type) {
  if (block.empty() || block.find_first_not_of(kKeyCharacters) != std::string::npos)
    throw Error{fmt::format("--block: the name is '{}', expected letters, digits, - and _", block)};
  const bool of_table = is_of_table(type);
  std::string text = "# Force of the machine, identified without a specimen:";
  text += "\n#   rths identify empty-table";
  for (const auto& file : runs.files) text += " " + file.string();
  text += "\n";
  if (!of_table)
    text += fmt::format("# Coulomb friction holds for a vertical load of {:.6g} N.\n", runs.load);
  for (const auto& [name, fit] : runs.axes) {
    if (of_table && !fit.has_load_friction)
      throw Error{
          fmt::format("{}: a {} needs recordings under different vertical loads, expected "
                      "loads that vary by 2 % or more",
                      name, type)};
    text += fmt::format("# {}: residual {:.2f} kN RMS; accelerometer {:.2f} ± {:.2f} ms late{}\n",
                        name, fit.sample_rms / 1e3, 1e3 * fit.machine.accelerometer_delay,
                        1e3 * fit.half_width.accelerometer_delay,
                        fit.has_load_friction ? fmt::format("; friction {:.4g} N per N of load",
                                                            fit.machine.load_friction)
                                              : "");
  }
  if (runs.axes.front().name == name_of(Axis::Lat))
    text += "# long: not identified; its zeros keep the place\n";
  const double load = of_table ? 0 : runs.load;
  text += fmt::format("[{}]\n", block);
  text += key_of(runs, "effective_mass_kg", [](const auto& m) { return m.effective_mass; });
  text += key_of(runs, "coulomb_friction_N",
                 [&](const auto& m) { return m.coulomb_friction + m.load_friction * load; });
  text +=
      key_of(runs, "viscous_friction_N_s_per_m", [](const auto& m) { return m.viscous_friction; });
  text += key_of(runs, "force_offset_N", [](const auto& m) { return m.offset; });
  if (!of_table) return text;
  text += key_of(runs, "load_friction", [](const auto& m) { return m.load_friction; });
  text += key_of(runs, "presliding_m", [](const auto& m) { return m.presliding; });
  text +=
      key_of(runs, "accelerometer_delay_s", [](const auto& m) { return m.accelerometer_delay; });
  text += key_of(runs, "displacement_lead_s", [](const auto& m) { return m.displacement_lead; });
  return text;
}

}  // namespace rths::commissioning
