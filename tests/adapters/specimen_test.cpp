// SPDX-License-Identifier: Apache-2.0
// Transforms between a script's degrees of freedom and the machine's axes: closed forms and work.
#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <rths/core/error.hpp>

#include "identification.hpp"
#include "machine_axes.hpp"
#include "specimen.hpp"

namespace rths::adapters {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

Trial trial_at(const VectorXd& displacement) {
  const VectorXd rest = VectorXd::Zero(displacement.size());
  return {displacement, rest, rest, 0};
}

// Both nodes are listed and all six components are moved; local x is the script's z.
OpenSeesElement bearing_of(double height, double shear_distance) {
  OpenSeesElement element;
  element.name = "bearing";
  element.bearing.emplace();
  element.bearing->i_dofs = element.bearing->j_dofs;
  element.bearing->height = height;
  element.bearing->shear_distance = shear_distance;
  for (std::size_t i = 0; i < kComponents; ++i) element.axes.push_back({std::to_string(i), i});
  for (int i = 0; i < 12; ++i) element.is_rotation.push_back(i % 6 >= 3);
  element.initial_stiffness = SquareMatrix::diagonal(6, 1);
  element.damping = element.mass = SquareMatrix::diagonal(6, 0);
  return element;
}

TEST(ExperimentalElement, SeesNoDeformationInARigidMotion) {
  constexpr double kHeight = 0.7;
  const auto element = bearing_of(kHeight, 0.3);
  ExperimentalElement coordinates{element};
  // A translation and a small rotation about the lower node.
  const Vector3d turn{2e-3, -1e-3, 3e-3}, shift{0.1, -0.2, 0.05};
  VectorXd u{12};
  u << shift, turn, shift + turn.cross(Vector3d{0, 0, kHeight}), turn;
  EXPECT_LT(coordinates.apply(trial_at(u)).displacement.norm(), 1e-15);
}

TEST(ExperimentalElement, ShearsAlongItsOwnAxes) {
  const auto element = bearing_of(0, 0.5);
  ExperimentalElement coordinates{element};
  VectorXd u = VectorXd::Zero(12);
  u[6] = 0.1;     // the script's x: local y
  u[7] = 0.2;     // the script's y: local z
  u[8] = -0.003;  // the script's z: axial, shortening
  VectorXd expected = VectorXd::Zero(6);
  expected << -0.003, 0.1, 0.2, 0, 0, 0;
  EXPECT_LT((coordinates.apply(trial_at(u)).displacement - expected).norm(), 1e-15);
}

TEST(ExperimentalElement, DoesAsMuchWorkAtTheNodesAsInTheBearing) {
  auto element = bearing_of(0.7, 0.3);
  element.bearing->has_p_delta = false;
  ExperimentalElement coordinates{element};
  std::mt19937 random{7};
  std::normal_distribution<double> normal;
  for (int i = 0; i < 100; ++i) {
    const VectorXd u = VectorXd::NullaryExpr(12, [&] { return normal(random); });
    const VectorXd q = VectorXd::NullaryExpr(6, [&] { return normal(random); });
    const VectorXd deformation = coordinates.apply(trial_at(u)).displacement;
    EXPECT_NEAR(coordinates.resisting_forces(q).dot(u), q.dot(deformation), 1e-12);
  }
}

// Sheared by Δ under N, the bearing carries the couple N·Δ in addition to its shear.
TEST(ExperimentalElement, IsInEquilibriumWhenSheared) {
  constexpr double kHeight = 0.7, kShift = 0.1, kAxial = -5e6, kShear = 2e5;
  const auto element = bearing_of(kHeight, 0.3);
  ExperimentalElement coordinates{element};
  VectorXd u = VectorXd::Zero(12);
  u[6] = kShift;
  static_cast<void>(coordinates.apply(trial_at(u)));
  VectorXd q = VectorXd::Zero(6);
  q[kAxial > 0 ? 1 : 0] = kAxial;
  q[kShearY] = kShear;
  const VectorXd p = coordinates.resisting_forces(q);
  EXPECT_LT((p.segment<3>(0) + p.segment<3>(6)).norm(), 1e-9);
  const Vector3d arm{kShift, 0, kHeight}, upper = p.segment<3>(6);
  EXPECT_LT((p.segment<3>(3) + p.segment<3>(9) + arm.cross(upper)).norm(), 1e-9 * 5e6);
}

TEST(ExperimentalElement, UsesTheUnitsOfTheScript) {
  OpenSeesElement element;
  element.is_rotation = {false, true};
  element.axes = {{"long", 0}, {"yaw", 1}};
  element.length_unit = 0.0254;
  element.force_unit = 4448.2216;
  element.initial_stiffness = SquareMatrix::diagonal(2, 1);  // 1 N/m, 1 N·m/rad
  element.damping = element.mass = SquareMatrix::diagonal(2, 0);
  Specimen specimen{element, 0.01};
  const auto& command = specimen.command_for(trial_at(VectorXd::Constant(2, 10)));
  EXPECT_DOUBLE_EQ(command.displacement[0], 0.254);
  EXPECT_DOUBLE_EQ(command.displacement[1], 10);
  const VectorXd force = specimen.measured({{}, VectorXd::Constant(2, 4448.2216)}).force;
  EXPECT_DOUBLE_EQ(force[0], 1);           // [kip]
  EXPECT_DOUBLE_EQ(force[1], 1 / 0.0254);  // [kip·in]
  EXPECT_DOUBLE_EQ(specimen.matrices().stiffness(0, 0), 0.0254 / 4448.2216);
  EXPECT_DOUBLE_EQ(specimen.matrices().stiffness(1, 1), 1 / (4448.2216 * 0.0254));
}

TEST(ComponentSpring, FollowsItsPolygonBeyondItsEnds) {
  const ComponentSpring spring{{{-0.002, -8e6}, {0, 0}, {0.01, 1e6}}};
  EXPECT_DOUBLE_EQ(spring.elastic_force(-0.001), -4e6);
  EXPECT_DOUBLE_EQ(spring.elastic_force(-0.004), -16e6);
  EXPECT_DOUBLE_EQ(spring.elastic_force(0.02), 2e6);
  EXPECT_NEAR(spring.stiffness(), 4e9, 1);
}

TEST(ExperimentalElement, LoadsTheMachineWithTheForceOfItsAxialSpring) {
  auto element = bearing_of(0, 0.5);
  element.axes.erase(element.axes.begin());
  element.bearing->axial_load = MovedAxis{"vert"};
  element.bearing->springs[kAxial] = {{{-0.002, -8e6}, {0, 0}, {0.01, 1e6}}, 1e5};
  element.initial_stiffness = element.damping = element.mass = SquareMatrix::diagonal(5, 0);
  Specimen specimen{element, 0.01};
  Trial trial = trial_at(VectorXd::Zero(12));
  trial.displacement[8] = -0.001;
  trial.velocity[8] = -2;
  EXPECT_DOUBLE_EQ(specimen.command_for(trial).load, -4e6 - 2e5);
  // The answer is the elastic force: OpenSees adds damping times velocity itself.
  EXPECT_DOUBLE_EQ(specimen.measured({{}, VectorXd::Zero(5)}).force[8], -4e6);
  EXPECT_DOUBLE_EQ(specimen.matrices().damping(8, 8), 1e5);
  EXPECT_NEAR(specimen.matrices().stiffness(8, 8), 4e9, 1);
}

// Six actuators on a platen two metres wide.
OpenSeesElement hexapod() {
  auto element = bearing_of(0, 0.5);
  const Vector3 fixed[] = {{-2, 1, 0.2}, {-2.1, -1, 0.5}, {-2, 0.3, -1},
                           {0.1, 3, 1},  {0, 3, -1},      {0.2, -0.5, 3}};
  const Vector3 pins[] = {{0, 1, 0}, {0, -1, 0}, {0, 0, -1}, {0, 1, 1}, {0, 1, -1}, {0, 0, 1}};
  for (std::size_t i = 0; i < 6; ++i)
    element.actuators.push_back({"a" + std::to_string(i), fixed[i], pins[i]});
  return element;
}

TEST(MachineAxes, KeepsAnActuatorsLengthWhenThePlatenTurnsAboutItsPin) {
  auto element = hexapod();
  element.actuators[0].fixed_pin = {0, 0, 0};  // at the platen's origin: rotation keeps the length
  MachineAxes machine{element};
  VectorXd turned = VectorXd::Zero(6);
  turned.tail<3>() << 0.3, -0.5, 0.4;
  EXPECT_NEAR(machine.set_position(turned)[0], 0, 1e-15);
  VectorXd shifted = VectorXd::Zero(6);
  shifted[1] = 0.25;  // along the actuator
  EXPECT_NEAR(machine.set_position(shifted)[0], 0.25, 1e-15);
}

TEST(MachineAxes, RefuseActuatorsThatLeaveAComponentUncontrolled) {
  auto element = hexapod();
  for (auto& actuator : element.actuators) actuator.platen_pin = {0, 0, 0};  // rotations are free
  EXPECT_THROW(MachineAxes{element}, Error);
}

TEST(MachineAxes, TurnsAPlatenAsRodriguesDoes) {
  auto element = hexapod();
  element.actuators[3].fixed_pin = {0, 5, 0};
  element.actuators[3].platen_pin = {0, 1, 0};
  MachineAxes machine{element};
  VectorXd turned = VectorXd::Zero(6);
  const double angle = 0.6;
  turned[3] = angle;  // about x: the pin goes to (0, cos, sin)
  EXPECT_NEAR(machine.set_position(turned)[3], std::hypot(std::cos(angle) - 5, std::sin(angle)) - 4,
              1e-14);
}

TEST(MachineAxes, RatesAndForcesFollowTheLengths) {
  const auto element = hexapod();
  MachineAxes machine{element};
  std::mt19937 random{11};
  std::uniform_real_distribution<double> uniform{-0.3, 0.3};
  for (int i = 0; i < 50; ++i) {
    const VectorXd d = VectorXd::NullaryExpr(6, [&] { return uniform(random); });
    const VectorXd v = VectorXd::NullaryExpr(6, [&] { return uniform(random); });
    constexpr double kStep = 1e-6;
    const VectorXd ahead = machine.set_position(d + kStep * v),
                   behind = machine.set_position(d - kStep * v);
    static_cast<void>(machine.set_position(d));
    // Central differences: error O(step²) + rounding/step.
    EXPECT_LT((machine.rate(v) - (ahead - behind) / (2 * kStep)).norm(), 1e-8);
    const VectorXd f = VectorXd::NullaryExpr(6, [&] { return uniform(random); });
    EXPECT_NEAR(machine.force(f).dot(v), f.dot(machine.rate(v)), 1e-14);
  }
}

TEST(MachineAxes, FindsThePlatenNearItsRestPosition) {
  const auto element = hexapod();
  MachineAxes machine{element};
  const VectorXd d = VectorXd::LinSpaced(6, 1e-5, 6e-5);
  // Linearised: the error is the displacement squared over lengths of at least a metre.
  EXPECT_LT((machine.displacement(machine.set_position(d)) - d).norm(), 20 * d.squaredNorm());
}

// A linear specimen in a machine with lag and amplitude error.
struct Plant {
  MatrixXd stiffness{2, 2}, damping{2, 2}, mass{2, 2};
  Plant() {
    stiffness << 3e8, 2e7, 2e7, 1e8;
    damping << 4e5, 0, 0, 2e5;
    mass << 3e4, 0, 0, 1e4;
  }
};

SpecimenIdentification::Properties identified(const Plant& plant, double noise) {
  constexpr double kStep = 0.01, kLag = 0.06, kOffset = -8e6;
  SpecimenIdentification identification{2, VectorXd::Constant(2, 1e-3), kStep};
  std::mt19937 random{3};
  std::normal_distribution<double> normal;
  // The machine moves linearly between targets, through two first-order lags.
  VectorXd d = VectorXd::Zero(2), v = d, a = d;
  const double decay = std::exp(-1e-4 / kLag);
  VectorXd smooth = d, last = d;
  while (!identification.is_done()) {
    const VectorXd target = identification.target();
    for (int i = 0; i < 100; ++i) {
      const VectorXd command = last + (target - last) * ((i + 1) / 100.0);
      smooth = command + (smooth - command) * decay;
      const VectorXd next = smooth + (d - smooth) * decay, rate = (next - d) / 1e-4;
      a = (rate - v) / 1e-4;
      v = rate;
      d = next;
    }
    last = target;
    VectorXd force = plant.stiffness * d + plant.damping * v + plant.mass * a;
    const VectorXd measured =
        d + noise * 1e-6 * VectorXd::NullaryExpr(2, [&] { return normal(random); });
    for (Eigen::Index i = 0; i < 2; ++i) force[i] += kOffset + noise * 1e3 * normal(random);
    identification.measure(measured, force);
  }
  return identification.properties();
}

TEST(SpecimenIdentification, FindsStiffnessDampingAndMassBehindALaggingMachine) {
  const Plant plant;
  const auto found = identified(plant, 0);
  // Tolerances: the velocity has kinks at the targets, and start-up transients have not fully
  // decayed.
  EXPECT_LT((found.stiffness - plant.stiffness).norm() / plant.stiffness.norm(), 1e-3);
  EXPECT_LT((found.damping - plant.damping).norm() / plant.damping.norm(), 0.03);
  EXPECT_LT((found.mass - plant.mass).norm() / plant.mass.norm(), 0.03);
}

TEST(SpecimenIdentification, AveragesNoiseOut) {
  const Plant plant;
  const auto found = identified(plant, 1);
  EXPECT_LT((found.stiffness - plant.stiffness).norm() / plant.stiffness.norm(), 0.01);
}

TEST(SpecimenIdentification, ReportsThatNothingMoves) {
  SpecimenIdentification identification{1, VectorXd::Constant(1, 1e-3), 0.01};
  while (!identification.is_done()) identification.measure(VectorXd::Zero(1), VectorXd::Zero(1));
  try {
    static_cast<void>(identification.properties());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(std::string{error.what()},
              "identification: component 1 moved 0 at 1 Hz, expected about 0.001: is the machine "
              "on?");
  }
}

TEST(Specimen, SubtractsTheForcesThatOpenSeesAdds) {
  OpenSeesElement element;
  element.is_rotation = {false};
  element.axes = {{"long", 0}};
  element.damping = SquareMatrix::diagonal(1, 0);  // stated, so not identified
  Specimen specimen{element, 0.01};
  ASSERT_FALSE(specimen.is_identified());
  // A mass on a spring that reaches its target at once.
  constexpr double kStiffness = 1e6, kMass = 500;
  VectorXd before = VectorXd::Zero(1), last = before, force = before;
  while (!specimen.is_identified()) {
    const VectorXd now = specimen.probe().displacement;
    // Central difference: the acceleration is known at the middle of three targets.
    force = kStiffness * last + kMass * (now - 2 * last + before) / 1e-4;
    specimen.measure({last, force});
    before = last;
    last = now;
  }
  EXPECT_NEAR(specimen.matrices().stiffness(0, 0), kStiffness, 0.005 * kStiffness);
  EXPECT_NEAR(specimen.matrices().mass(0, 0), kMass, 0.02 * kMass);
  Trial trial = trial_at(VectorXd::Constant(1, 0.1));
  trial.acceleration[0] = 3;
  static_cast<void>(specimen.command_for(trial));
  const double mass = specimen.matrices().mass(0, 0);
  EXPECT_DOUBLE_EQ(specimen.measured({{}, VectorXd::Constant(1, 1e5)}).force[0], 1e5 - 3 * mass);
}

}  // namespace
}  // namespace rths::adapters
