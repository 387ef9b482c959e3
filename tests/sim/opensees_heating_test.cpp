// SPDX-License-Identifier: Apache-2.0
// Reasons why a heated LeadRubberX differs from ours: its law is reimplemented here, and its
// assumptions are changed one by one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include <gtest/gtest.h>

#include "opensees_rows.hpp"
#include "support/with_opensees.hpp"

namespace rths::sim {
namespace {

using std::numbers::pi;

/// Heat input of the lead.
enum class HeatInput {
  Speed,  ///< Q |z| |v|: positive even while the bearing returns work
  Work,   ///< Q z.v
};

// Step response of a disc on a half-space at dimensionless time: docs/theory/lead_rubber.md.
double disc(double tau) {
  if (tau < 0.6) {
    const double q = tau / 4;
    return 2 * std::sqrt(tau / pi) - tau / pi * (2 - q - q * q - 15.0 / 4 * q * q * q);
  }
  const double q = 4 * tau;
  return 8 / (3 * pi) -
         (1 - 1 / (3 * q) + 1 / (6 * q * q) - 1 / (12 * q * q * q)) / (2 * std::sqrt(pi * tau));
}

// Kalpakidis & Constantinou 2009 as integrated in OpenSees: cooling depends on the time since the
// start of the analysis; Heun's method, whose predictor is clamped to ≥ 0.
class LeadPlug {
 public:
  LeadPlug(const LeadRubberDesign& design, double time_step) : d_{design}, step_{time_step} {}

  /// @param power  into the plug at the end of the step [W]
  void heat(double power, double time) {
    const double first = std::max(0.0, increment(power, time, temperature_));
    const double second = increment(power, time + step_, temperature_ + first);
    temperature_ += (first + second) / 2;
  }
  [[nodiscard]] double strength() const {
    return d_.characteristic_strength * std::exp(-d_.softening * temperature_);
  }

 private:
  [[nodiscard]] double increment(double power, double time, double temperature) const {
    const double a = d_.lead_diameter / 2, tau = d_.steel_diffusivity * time / (a * a);
    const double shims = (d_.rubber_layers - 1) * d_.shim_thickness;
    const double lost = d_.steel_conductivity * temperature / a *
                        (1 / disc(tau) + 1.274 * shims / a / std::cbrt(tau));
    const double capacity = d_.lead_density * d_.lead_specific_heat * height(d_);
    return step_ / capacity * (power / lead_area(d_) - lost);
  }

  LeadRubberDesign d_;
  double step_, temperature_ = 0;
};

// z, computed as the force of a bearing of 1 N strength without rubber.
class Hysteresis {
 public:
  Hysteresis(const LeadRubberDesign& design, double time_step)
      : yield_displacement_{yield_displacement(design)},
        composition_{{{"bouc_wen_nagarajaiah",
                       "",
                       {{"characteristic_strength", 1},
                        {"yield_displacement", yield_displacement_},
                        {"beta", 0.9}}}},
                     time_step},
        index_{composition_.parameter_index("bouc_wen_nagarajaiah", "yield_displacement")},
        parameters_{composition_.parameters().begin(), composition_.parameters().end()},
        state_(composition_.states(), 0.0) {}

  /// @param strength  relative to the cold strength [-]; the yield displacement is scaled by it
  Horizontal<double> at(const test_support::PathPoint& point, double strength) {
    parameters_[index_] = yield_displacement_ * strength;
    Quantities<double> q;
    q.displacement = {point.displacement_long, point.displacement_lat};
    composition_.advance(parameters_, state_, q);
    return q.force;
  }

 private:
  double yield_displacement_;
  Composition composition_;
  std::size_t index_;
  std::vector<double> parameters_, state_;
};

test_support::Forces law_along(const test_support::Path& path, HeatInput input) {
  const LeadRubberDesign design = test_support::compared_design();
  LeadPlug plug{design, path.time_step};
  Hysteresis hysteresis{design, path.time_step};
  const double rubber = post_yield_stiffness(design);
  test_support::Forces forces;
  for (std::size_t i = 1; i < path.points.size(); ++i) {
    const test_support::PathPoint& point = path.points[i];
    const double strength = plug.strength();
    const double ratio = strength / design.characteristic_strength;
    const auto [zx, zy] = hysteresis.at(point, ratio);
    const double along = zx * point.velocity_long + zy * point.velocity_lat;
    const double across = std::hypot(zx, zy) * std::hypot(point.velocity_long, point.velocity_lat);
    forces.push_back({strength * zx + rubber * point.displacement_long,
                      strength * zy + rubber * point.displacement_lat, 0});
    plug.heat(strength * (input == HeatInput::Speed ? across : along),
              static_cast<double>(i) * path.time_step);
  }
  return forces;
}

// The last burst only: during the rest before it, OpenSees does not update the strength.
test_support::Forces last_burst(const test_support::Forces& forces) {
  const auto steps = static_cast<std::ptrdiff_t>(forces.size() / 10);
  return {forces.end() - steps, forces.end()};
}

void compare(const test_support::Path& path,
             test_support::Forces (*select)(const test_support::Forces&)) {
  const test_support::TwoBearings bearing = test_support::heated_bearing();
  const auto theirs = select(test_support::opensees_forces(bearing, path));
  const auto ours = select(test_support::our_forces(bearing, path));
  const auto again = select(law_along(path, HeatInput::Speed));
  const auto by_work = select(law_along(path, HeatInput::Work));

  const double written_down = test_support::nrmse(again, theirs).shear;
  const double heated_by_work = test_support::nrmse(by_work, again).shear;
  const double ours_from_that = test_support::nrmse(ours, by_work).shear;

  std::printf(
      "  %-11s OpenSees to its law reimplemented %7.4f %%; that law to itself heated by work "
      "%7.4f %%; the latter to ours %7.4f %%\n",
      path.name.c_str(), 100 * written_down, 100 * heated_by_work, 100 * ours_from_that);
  const auto record = [&](const char* name, double share) {
    testing::Test::RecordProperty(path.name + "_" + name, std::to_string(100 * share));
  };
  record("law_again_percent", written_down);
  record("by_work_percent", heated_by_work);
  record("ours_percent", ours_from_that);
  EXPECT_LE(written_down, 0.005) << path.name;
}

using OpenseesHeating = test::WithOpenSees<>;

TEST_F(OpenseesHeating, DiffersByHeatInputAndByCooling) {
  for (const auto& path : test_support::all_paths(0.2, 5e-4))
    compare(path, [](const test_support::Forces& forces) { return forces; });
  compare(test_support::two_bursts(0.2, 5e-4), last_burst);
}

}  // namespace
}  // namespace rths::sim
