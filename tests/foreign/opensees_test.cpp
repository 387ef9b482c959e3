// SPDX-License-Identifier: Apache-2.0
//
// Scripts of OpenSees: their arguments, and the files of their recorders. A shell is Python's
// stand-in.
#include <rths/foreign/opensees.hpp>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/opensees.hpp"

namespace rths::foreign {
namespace {

RunInputs four_rows() { return {3, 0.5, 4, {{1, 2, 3, 4}}, {10}, {}}; }

class OpenSeesScriptTest : public ::testing::Test {
 protected:
  [[nodiscard]] OpenSeesRunSettings settings(const std::string& script) const {
    OpenSeesRunSettings settings;
    settings.python = "sh";
    settings.script = folder_.write("frame.sh", script);
    settings.inputs = {"ground"};
    settings.parameters = {"k"};
    settings.recorded = {{"roof.out", 2, 0.1}};
    return settings;
  }
  [[nodiscard]] RunOutputs run(const OpenSeesRunSettings& settings) const {
    return make_opensees(settings)->run(four_rows());
  }
  [[nodiscard]] std::string trouble_of(const std::string& script) const {
    const std::string trouble = run(settings(script)).trouble;
    return trouble.substr(trouble.find(": ") + 2);
  }

  test::TemporaryFolder folder_;
};

TEST_F(OpenSeesScriptTest, GetsMotionAndValuesAsArguments) {
  auto with = settings(
      "(cat $1; cat $2; echo $3 $4 $5; echo $6 | sed 's|.*/||') > said; "
      "printf '0 0 0\\n9 0 0\\n' > roof.out; cp said " +
      (folder_.path() / "said").string() + "\n");
  with.arguments = {"{motion}", "{ground}", "{step_s}", "{duration_s}", "{k}", "{results}"};

  ASSERT_EQ(run(with).trouble, "");

  EXPECT_EQ(test::content_of(folder_.path() / "said"),
            "0 1\n0.5 2\n1 3\n1.5 4\n1\n2\n3\n4\n0.5 1.5 10\nresults\n");
}

TEST_F(OpenSeesScriptTest, ReadsRecordersAfterTheirStaticAnalysis) {
  const RunOutputs result =
      run(settings("printf '0.5 7 7\\n1 7 7\\n0.25 0 10\\n0.75 0 30\\n1.5 0 60\\n' > roof.out\n"));

  ASSERT_EQ(result.trouble, "");
  // Row 0 is before the first row of the recorder: 10. Then linear, times 0.1.
  EXPECT_NEAR(result.outputs[0][0], 1, 1e-12);
  EXPECT_NEAR(result.outputs[0][1], 2, 1e-12);
  EXPECT_NEAR(result.outputs[0][2], 4, 1e-12);
  EXPECT_NEAR(result.outputs[0][3], 6, 1e-12);
}

TEST_F(OpenSeesScriptTest, CopiesFilesBesideItsRun) {
  auto with = settings("cp rows.txt roof.out\n");
  with.files = {folder_.write("rows.txt", "0 0 5\n2 0 5\n")};

  EXPECT_EQ(run(with).outputs[0], (std::vector<double>(4, 0.5)));
}

TEST_F(OpenSeesScriptTest, ReportsWhyItHasNoOutputs) {
  EXPECT_EQ(trouble_of("echo no convergence; exit 3\n"),
            "ended with exit code 3; it wrote: no convergence");
  EXPECT_EQ(trouble_of("true\n"), "wrote no roof.out");
  EXPECT_EQ(trouble_of("printf '0 1\\n2 1\\n' > roof.out\n"),
            "roof.out has 1 columns beside time, expected at least 2");
  EXPECT_EQ(trouble_of("printf '0 1 1\\n1 1 1\\n' > roof.out\n"),
            "roof.out covers 3 to 4 s, expected 3 to 4.5 s");
  EXPECT_EQ(trouble_of("printf '0 1 1\\n2 nan 1\\n' > roof.out\n"),
            "roof.out:2: found 'nan', expected a finite number");
  EXPECT_EQ(trouble_of("echo 0 1 1 > roof.out\n"),
            "roof.out has less than two rows, expected time and responses");
}

TEST_F(OpenSeesScriptTest, CallsAFunction) {
  OpenSeesRunSettings with;
  with.python = "python3";
  with.script = folder_.write("frame.py",
                              "def simulate(time, inputs, parameters):\n"
                              "    return {'roof': [t + parameters['k'] * u for t, u in "
                              "zip(time, inputs['ground'])]}\n");
  with.function = "simulate";
  with.inputs = {"ground"};
  with.parameters = {"k"};
  with.outputs = {"roof"};

  const RunOutputs result = run(with);

  ASSERT_EQ(result.trouble, "");
  EXPECT_EQ(result.outputs[0], (std::vector<double>{13, 23.5, 34, 44.5}));
}

TEST_F(OpenSeesScriptTest, RunsOpenSees) {
  const auto python = test::opensees_python();
  if (!python) GTEST_SKIP() << "OpenSees is not installed";
  OpenSeesRunSettings with;
  with.python = *python;
  with.script = folder_.write("mass.py", R"(import sys
import openseespy.opensees as ops
motion, step, stiffness = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
ops.model('basic', '-ndm', 1, '-ndf', 1)
ops.node(1, 0.0)
ops.fix(1, 1)
ops.node(2, 0.0)
ops.uniaxialMaterial('Elastic', 1, stiffness)
ops.element('zeroLength', 1, 1, 2, '-mat', 1, '-dir', 1)
ops.timeSeries('Path', 1, '-dt', step, '-filePath', motion, '-useLast')
ops.pattern('Plain', 1, 1)
ops.load(2, 1.0)
ops.recorder('Node', '-file', 'x.out', '-time', '-node', 2, '-dof', 1, 'disp')
ops.constraints('Plain')
ops.numberer('Plain')
ops.system('FullGeneral')
ops.integrator('LoadControl', step)
ops.algorithm('Linear')
ops.analysis('Static')
ops.analyze(3)
ops.wipe()
)");
  with.arguments = {"{push}", "{step_s}", "{k}"};
  with.inputs = {"push"};
  with.parameters = {"k"};
  with.recorded = {{"x.out", 1, 1}};

  const RunOutputs result = run(with);

  // push ÷ stiffness at the ends of the steps
  ASSERT_EQ(result.trouble, "");
  EXPECT_NEAR(result.outputs[0][1], 0.2, 1e-6);
  EXPECT_NEAR(result.outputs[0][3], 0.4, 1e-6);
}

}  // namespace
}  // namespace rths::foreign
