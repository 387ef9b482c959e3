// SPDX-License-Identifier: Apache-2.0
//
// Scripts of OpenSees: their arguments, and the files of their recorders. A shell is Python's
// stand-in.
#include <rths/foreign/opensees.hpp>

#include <unistd.h>

#include <sstream>

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

TEST_F(OpenSeesScriptTest, MayBeNamedByARelativePath) {
  auto with = settings("printf '0 0 5\\n2 0 5\\n' > roof.out\n");
  with.script = std::filesystem::relative(with.script);

  const RunOutputs result = make_opensees(with)->run(four_rows());

  EXPECT_EQ(result.trouble, "");
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

// A script whose outputs are 'k', written with the number of the process that has started it.
class WarmScriptTest : public OpenSeesScriptTest {
 protected:
  [[nodiscard]] OpenSeesRunSettings settings_of(const std::string& body) const {
    OpenSeesRunSettings settings;
    settings.python = "python3";
    settings.script =
        folder_.write("frame.py",
                      "import os, sys, time\n"
                      "k = float(sys.argv[1])\n"
                      "open('" +
                          started_by() + "', 'a').write('%d\\n' % os.getppid())\n" + body +
                          "print('0', k, file=open('roof.out', 'w'))\n"
                          "print('9', k, file=open('roof.out', 'a'))\n");
    settings.arguments = {"{k}"};
    settings.inputs = {"ground"};
    settings.parameters = {"k"};
    settings.recorded = {{"roof.out", 1, 1}};
    settings.deadline = 2;
    return settings;
  }
  [[nodiscard]] std::string started_by() const { return (folder_.path() / "parents").string(); }
  [[nodiscard]] static RunInputs with(double k) {
    RunInputs inputs = four_rows();
    inputs.parameters = {k};
    return inputs;
  }
  // Of each run: whether another process than this one has started it.
  [[nodiscard]] std::vector<bool> were_warm() const {
    std::vector<bool> warm;
    std::istringstream parents{test::content_of(started_by())};
    for (pid_t parent = 0; parents >> parent;) warm.push_back(parent != getpid());
    return warm;
  }
};

TEST_F(WarmScriptTest, ForksAnInterpreterOnceItsRunsAreProvenEqual) {
  const auto simulation = make_opensees(settings_of(""));
  for (const double k : {1, 1, 2, 3})
    EXPECT_EQ(simulation->run(with(k)).outputs[0], std::vector<double>(4, k));

  // Two cold ones, the first one again for the proof, then both others.
  EXPECT_EQ(were_warm(), (std::vector<bool>{false, false, true, true, true}));
}

TEST_F(WarmScriptTest, StartsAnewForAScriptThatDiffersInAFork) {
  const auto simulation =
      make_opensees(settings_of("k += 'importlib' in sys.modules and '-c' in sys.orig_argv\n"));
  for (const double k : {1, 1, 2, 3})
    EXPECT_EQ(simulation->run(with(k)).outputs[0], std::vector<double>(4, k));

  EXPECT_EQ(were_warm(), (std::vector<bool>{false, false, true, false, false}));
}

TEST_F(WarmScriptTest, SaysWhyAForkHasNoOutputs) {
  const auto simulation =
      make_opensees(settings_of("if k == 3: sys.exit('no convergence')\n"
                                "if k == 4: os.kill(os.getpid(), 11)\n"
                                "if k == 5: os.fork(), time.sleep(60)\n"
                                "if k == 6: undefined()\n"));
  const auto trouble_at = [&](double k) { return simulation->run(with(k)).trouble; };
  for (int i = 0; i < 3; ++i) ASSERT_EQ(trouble_at(1), "");

  EXPECT_NE(trouble_at(3).find("ended with exit code 1; it wrote: no convergence"),
            std::string::npos);
  EXPECT_NE(trouble_at(4).find("was ended by signal 11"), std::string::npos);
  EXPECT_NE(trouble_at(5).find("did not end within 2 s (deadline_s)"), std::string::npos);
  EXPECT_NE(trouble_at(6).find("NameError: name 'undefined' is not defined"), std::string::npos);
  EXPECT_EQ(trouble_at(1), "");
  EXPECT_EQ(were_warm(),
            std::vector<bool>({false, false, true, true, true, true, true, true, true}));
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
