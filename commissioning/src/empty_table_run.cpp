// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/empty_table_run.hpp>

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/commissioning/recorded.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>

namespace rths::commissioning {
namespace {

using controller::EmptyTableFit;
using controller::EmptyTableRecord;
using controller::Estimate;
using Json = nlohmann::ordered_json;

EmptyTableRecord record_of(const recording::Reader& run, const recording::AxisRoles& axis,
                           const std::string& load) {
  std::vector<std::string> names{axis.machine_displacement, axis.machine_acceleration,
                                 axis.machine_force};
  if (run.has(load)) names.push_back(load);
  Recorded data = recorded(run, names);
  EmptyTableRecord record;
  record.period = data.interval;
  record.displacement = std::move(data.values[0]);
  record.acceleration = std::move(data.values[1]);
  record.force = std::move(data.values[2]);
  if (data.values.size() > 3) record.load = std::move(data.values[3]);
  return record;
}

/// A row of the table, and a member of the JSON document.
struct Quantity {
  const char *name, *key, *unit;
  const Estimate EmptyTableFit::*estimate;
  double scale;
};
constexpr Quantity kQuantities[] = {
    {"effective mass", "effective_mass_kg", "kg", &EmptyTableFit::effective_mass, 1},
    {"Coulomb friction", "coulomb_friction_N", "N", &EmptyTableFit::coulomb_friction, 1},
    {"  per vertical load", "load_coefficient", "", &EmptyTableFit::load_coefficient, 1},
    {"viscous friction", "viscous_friction_N_s_per_m", "N·s/m", &EmptyTableFit::viscous_friction,
     1},
    {"offset", "force_offset_N", "N", &EmptyTableFit::offset, 1},
    {"accelerometer's delay", "acceleration_delay_ms", "ms", &EmptyTableFit::acceleration_delay,
     1e3}};

// Values by axis in the order long, lat; an axis before the last identified one may be missing.
std::string list_of(const EmptyTableRuns& runs, double (*value)(const EmptyTableFit&, double)) {
  double values[2] = {0, 0};
  int count = 0;
  for (const auto& axis : runs.axes) {
    const int i = axis.name == "long" ? 0 : 1;
    values[i] = value(axis.fit, runs.load);
    count = std::max(count, i + 1);
  }
  return count == 2 ? fmt::format("[{:.6g}, {:.6g}]", values[0], values[1])
                    : fmt::format("[{:.6g}]", values[0]);
}

std::vector<EmptyTableRecord> records_of(const std::vector<std::filesystem::path>& files,
                                         const std::string& axis) {
  std::vector<EmptyTableRecord> records;
  for (const auto& file : files) {
    const recording::Reader run{file};
    const auto roles = recording::roles_of(run);
    for (const auto& names : roles.axes)
      if (names.axis == axis) records.push_back(record_of(run, names, roles.load));
  }
  return records;
}

}  // namespace

EmptyTableRuns identify_empty_table(const std::vector<std::filesystem::path>& files, double load) {
  EmptyTableRuns runs;
  runs.files = files;
  runs.load = load;
  for (const char* axis : {"long", "lat"}) {
    const auto records = records_of(files, axis);
    if (records.empty()) continue;
    try {
      runs.axes.push_back({axis, controller::identify_empty_table(records)});
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
    text += fmt::format("{}: {:.2f} m/s, {:.1f} m/s² at most; 95 % intervals\n", name,
                        fit.largest_speed, fit.largest_acceleration);
    for (const auto& quantity : kQuantities) {
      if (quantity.estimate == &EmptyTableFit::load_coefficient && !fit.load_varies) continue;
      const Estimate& e = fit.*quantity.estimate;
      text += fmt::format("  {:<24}{:>12.5g} ± {:<10.3g}{}\n", quantity.name,
                          quantity.scale * e.value, quantity.scale * e.half_width, quantity.unit);
    }
    text += fmt::format(
        "  residual                {:.2f} kN RMS, {:.1f} kN peak, of every sample; {:.2f} kN and "
        "{:.1f} kN smoothed\n"
        "  correlation of it       {:.2f} between neighbours, {:.0f} % of 20 lags beyond the bound "
        "of white noise (5 % if white)\n",
        fit.raw_rms / 1e3, fit.raw_peak / 1e3, fit.residual_rms / 1e3, fit.residual_peak / 1e3,
        fit.neighbour_correlation, 1e2 * fit.correlated_share);
  }
  return text;
}

std::string json_of(const EmptyTableRuns& runs) {
  Json document{{"load_N", runs.load}, {"axes", Json::object()}};
  for (const auto& [name, fit] : runs.axes) {
    Json axis;
    for (const auto& quantity : kQuantities) {
      const Estimate& e = fit.*quantity.estimate;
      axis[quantity.key] = {{"value", quantity.scale * e.value},
                            {"half_width_95", quantity.scale * e.half_width}};
    }
    axis["load_varies"] = fit.load_varies;
    axis["residual_rms_N"] = fit.raw_rms;
    axis["residual_peak_N"] = fit.raw_peak;
    axis["smoothed_residual_rms_N"] = fit.residual_rms;
    axis["smoothed_residual_peak_N"] = fit.residual_peak;
    axis["neighbour_correlation"] = fit.neighbour_correlation;
    axis["correlated_share"] = fit.correlated_share;
    axis["largest_speed_m_per_s"] = fit.largest_speed;
    axis["largest_acceleration_m_per_s2"] = fit.largest_acceleration;
    document["axes"][name] = axis;
  }
  return document.dump(2) + "\n";
}

std::string toml_of(const EmptyTableRuns& runs, const std::string& block) {
  std::string text = "# Force of the machine, identified without a specimen:";
  text += "\n#   rths identify empty-table";
  for (const auto& file : runs.files) text += " " + file.string();
  text += fmt::format("\n# Coulomb friction holds for a vertical load of {:.6g} N.\n", runs.load);
  for (const auto& [name, fit] : runs.axes)
    text += fmt::format("# {}: residual {:.2f} kN RMS; accelerometer {:.2f} ± {:.2f} ms late{}\n",
                        name, fit.raw_rms / 1e3, 1e3 * fit.acceleration_delay.value,
                        1e3 * fit.acceleration_delay.half_width,
                        fit.load_varies ? fmt::format("; friction {:.4g} N per N of load",
                                                      fit.load_coefficient.value)
                                        : "");
  text += fmt::format("[{}]\n", block);
  text += "effective_mass_kg = " +
          list_of(runs, [](const auto& f, double) { return f.effective_mass.value; }) + "\n";
  text += "coulomb_friction_N = " +
          list_of(runs, [](const auto& f, double n) { return f.machine(n).coulomb_friction; }) +
          "\n";
  text += "viscous_friction_N_s_per_m = " +
          list_of(runs, [](const auto& f, double) { return f.viscous_friction.value; }) + "\n";
  text +=
      "force_offset_N = " + list_of(runs, [](const auto& f, double) { return f.offset.value; }) +
      "\n";
  return text;
}

}  // namespace rths::commissioning
