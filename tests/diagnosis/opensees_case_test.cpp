// SPDX-License-Identifier: Apache-2.0
// The user's simulation is a script of OpenSees, whose coarse steps no model of this project
// shares.
#include <algorithm>
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include <rths/report/diagnosis.hpp>

#include "dynamic_case.hpp"
#include "support/opensees.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kStep = 0.01, kSpring = 200, kDamper = 0.8;  // of a unit mass
constexpr std::size_t kSamples = 1000, kAtRest = 200;

constexpr const char* kScript = R"(import sys
import openseespy.opensees as ops

ground, step, stiffness = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
ops.model('basic', '-ndm', 1, '-ndf', 1)
ops.node(1, 0.0)
ops.fix(1, 1)
ops.node(2, 0.0)
ops.mass(2, 1.0)
ops.uniaxialMaterial('Elastic', 1, stiffness, 0.8)
ops.element('zeroLength', 1, 1, 2, '-mat', 1, '-dir', 1, '-doRayleigh', 0)
ops.timeSeries('Path', 1, '-dt', step, '-filePath', ground, '-useLast')
ops.pattern('UniformExcitation', 1, 1, '-accel', 1)
ops.recorder('Node', '-file', 'x.out', '-time', '-precision', 12, '-node', 2, '-dof', 1, 'disp')
ops.constraints('Plain')
ops.numberer('Plain')
ops.system('FullGeneral')
ops.test('NormUnbalance', 1e-10, 20)
ops.algorithm('Newton')
ops.integrator('Newmark', 0.5, 0.25)
ops.analysis('Transient')
steps = sum(1 for _ in open(ground)) - 1
sys.exit(0 if ops.analyze(steps, step) == 0 else 1)
)";

// Newmark's method of constant average acceleration, one step per sample.
std::vector<double> response(const std::vector<double>& ground, double stiffness) {
  const double h = kStep;
  std::vector<double> motion{0};
  double x = 0, v = 0, a = -ground[0];
  for (std::size_t row = 1; row < ground.size(); ++row) {
    const double known = 4 / (h * h) * x + 4 / h * v + a, damped = 2 / h * x + v;
    const double next =
        (-ground[row] + known + kDamper * damped) / (4 / (h * h) + 2 / h * kDamper + stiffness);
    const double speed = 2 / h * (next - x) - v;
    a = 4 / (h * h) * (next - x) - 4 / h * v - a;
    x = next;
    v = speed;
    motion.push_back(x);
  }
  return motion;
}

class OpenSeesCase : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto python = test::opensees_python();
    if (!python) GTEST_SKIP() << "OpenSees is not installed";
    python_ = *python;
    std::ofstream{folder_.path() / "frame.py"} << kScript;
  }

  void record(double stiffness, double limit) const {
    for (unsigned k = 0; k < 2; ++k) {
      auto ground = test_support::random_signal(10 + k, kSamples, kStep, 0.5, 6, 2);
      std::fill_n(ground.begin(), kAtRest, 0.0);
      auto real_ground = ground;
      for (double& value : real_ground) value = std::clamp(value, -limit, limit);
      auto measured = response(real_ground, stiffness);
      const auto noise = test_support::noise(100 + k, kSamples, 5e-5);
      for (std::size_t i = 0; i < kSamples; ++i) measured[i] += noise[i];
      folder_.write(k == 0 ? "fit.csv" : "unseen.csv", {{"a", ground}, {"y", measured}});
    }
  }
  [[nodiscard]] Verdict verdict() const {
    return diagnose(folder_.load(R"(format = 1
name = "frame"
[[record]]
file = "fit.csv"
use = "fit"
quiet_s = [0, 1.9]
[[record]]
file = "unseen.csv"
use = "held_out"
quiet_s = [0, 1.9]
[channels]
rate_Hz = 100
input.ground = "a [m/s2]"
output.roof = "y [m]"
[model]
kind = "opensees"
script = "frame.py"
arguments = ["{ground}", "{step_s}", "{stiffness}"]
fitted = ["stiffness"]
python = ")" + python_ + R"("
[model.inputs]
"input.ground" = "ground"
[model.outputs]
"output.roof" = {file = "x.out"}
[model.parameters.stiffness]
value = 190
unit = "N/m"
)"));
  }

  std::string python_;
  test_support::CaseFolder folder_;
};

TEST_F(OpenSeesCase, IsRefittedAndSilentIfNothingIsMissing) {
  record(kSpring, 1e9);

  const Verdict silent = verdict();

  EXPECT_EQ(silent.conclusion.outcome, Outcome::None) << silent.sentence;
  EXPECT_NEAR(silent.evaluation.refitted.at(0).after, kSpring, 0.2);
}

TEST_F(OpenSeesCase, NamesAnEffectAtItsInputAndRunsImproved) {
  record(kSpring, 3);

  const Verdict found = verdict();
  ASSERT_EQ(found.conclusion.causes.size(), 1U) << found.sentence;
  EXPECT_EQ(found.conclusion.causes[0].name, "saturation") << found.sentence;
  EXPECT_NEAR(found.conclusion.causes[0].parameters[0].value, 3, 0.05);
  const RecordScore& proof = found.evaluation.fit.back();
  EXPECT_LT(proof.nrmse_after, 1.15 * proof.noise_floor) << found.sentence;
  const auto files = report::write_diagnosis(found, folder_.path() / "out");

  ASSERT_TRUE(files.improved);
  const Verdict improved = diagnose(load_case(*files.improved));
  EXPECT_EQ(improved.conclusion.outcome, Outcome::None) << improved.sentence;
}

}  // namespace
}  // namespace rths::diagnosis
