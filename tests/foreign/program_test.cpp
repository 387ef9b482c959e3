// SPDX-License-Identifier: Apache-2.0
#include <rths/foreign/program.hpp>

#include <sys/stat.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include <gtest/gtest.h>

#include <rths/core/interrupted.hpp>
#include <rths/foreign/runs.hpp>

#include "support/files.hpp"

namespace rths::foreign {
namespace {

RunInputs three_rows() { return {1, 0.5, 3, {{1, 2, 3}}, {10}, {}}; }

/// A program as a script of the shell, with the input `u`, the output `y` and the parameter `k`.
class ProgramTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::unique_ptr<Simulation> program(const std::string& script,
                                                    double deadline = 30) const {
    const auto file = folder_.write("simulate", "#!/bin/sh\n" + script);
    chmod(file.c_str(), 0700);
    return make_program({{"./simulate"}, folder_.path(), {"u"}, {"y"}, {"k"}, deadline});
  }
  [[nodiscard]] std::string trouble_of(const std::string& script, double deadline = 30) const {
    const std::string trouble = program(script, deadline)->run(three_rows()).trouble;
    const std::string start = (folder_.path() / "simulate").string() + ": ";
    EXPECT_EQ(trouble.substr(0, start.size()), start);
    return trouble.substr(std::min(start.size(), trouble.size()));
  }

  test::TemporaryFolder folder_;
};

constexpr const char* kTimesTen =
    "k=$(sed 's/.*= //' parameters.toml)\n"
    "awk -F, -v k=$k 'NR == 1 {print \"y\"; next} {print $2 * k}' inputs.csv > outputs.csv\n";

TEST_F(ProgramTest, ReadsInputsAndParametersAndWritesOutputs) {
  const RunOutputs result = program(kTimesTen)->run(three_rows());

  EXPECT_EQ(result.trouble, "");
  EXPECT_EQ(result.outputs, (std::vector<std::vector<double>>{{10, 20, 30}}));
}

TEST_F(ProgramTest, GetsFilesAndValuesAsArguments) {
  static_cast<void>(program(""));  // writes the script
  const auto script = folder_.write("model.sh",
                                    "awk -F, -v k=$2 'NR == 1 {print \"y\"; next} "
                                    "{print $2 + k}' $1 > $3; test -f parameters.toml\n");
  const auto simulation = make_program({{"sh", "model.sh", "{inputs}", "{k}", "{outputs}"},
                                        folder_.path(),
                                        {"u"},
                                        {"y"},
                                        {"k"},
                                        30});

  EXPECT_EQ(simulation->run(three_rows()).outputs[0], (std::vector<double>{11, 12, 13}));
}

TEST_F(ProgramTest, MayWriteOtherTimes) {
  const RunOutputs result =
      program("printf 'y,time\\n0,0\\n40,4\\n' > outputs.csv")->run(three_rows());

  EXPECT_EQ(result.outputs[0], (std::vector<double>{10, 15, 20}));
}

TEST_F(ProgramTest, ReportsWhyItHasNoOutputs) {
  EXPECT_EQ(trouble_of("echo no convergence >&2; exit 3"),
            "ended with exit code 3; it wrote: no convergence");
  EXPECT_EQ(trouble_of("true"), "wrote no outputs.csv");
  EXPECT_EQ(trouble_of("printf 'x\\n1\\n2\\n3\\n' > outputs.csv"),
            "outputs.csv has no column 'y', only x");
  EXPECT_EQ(trouble_of("printf 'y\\n1\\n2\\n' > outputs.csv"),
            "outputs.csv has 2 rows, expected 3, or a column 'time'");
  EXPECT_EQ(trouble_of("printf 'y\\n1\\nnan\\n3\\n' > outputs.csv"),
            "outputs.csv:3: found 'nan' in column 'y', expected a finite number");
  EXPECT_EQ(trouble_of("printf 'time,y\\n1,1\\n1.5,2\\n' > outputs.csv"),
            "outputs.csv covers 1 to 1.5 s, expected 1 to 2 s");
  EXPECT_EQ(trouble_of("kill -SEGV $$"), "was ended by signal 11 (Segmentation fault)");
}

TEST_F(ProgramTest, EndsAtItsDeadlineWithAllItsProcesses) {
  EXPECT_EQ(
      trouble_of("sleep 1000 & echo $! > " + (folder_.path() / "pid").string() + "; wait", 0.3),
      "did not end within 0.3 s (deadline_s)");

  const int pid = std::atoi(test::content_of(folder_.path() / "pid").c_str());
  ASSERT_GT(pid, 0);
  for (int i = 0; i < 100 && kill(pid, 0) == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{20});
  // A killed orphan may wait for its new parent to reap it.
  const auto stat = std::filesystem::path{"/proc"} / std::to_string(pid) / "stat";
  EXPECT_TRUE(kill(pid, 0) != 0 || test::content_of(stat).find(") Z") != std::string::npos);
}

TEST_F(ProgramTest, IsRefusedIfItCannotRun) {
  const auto error = [&](std::vector<std::string> command) {
    return test::error_of([&] {
      static_cast<void>(make_program({std::move(command), folder_.path(), {"u"}, {"y"}, {"k"}, 1}));
    });
  };
  folder_.write("notes.txt", "");

  EXPECT_EQ(error({}), "the command is empty, expected a program and arguments");
  EXPECT_EQ(error({"no_such_program"}), "there is no program 'no_such_program' on PATH");
  EXPECT_EQ(error({"./gone"}), (folder_.path() / "gone").string() + " is not a file");
  EXPECT_EQ(error({"./notes.txt"}),
            (folder_.path() / "notes.txt").string() + " cannot be executed");
  EXPECT_EQ(error({"sh", "{mass}"}),
            "unknown placeholder '{mass}', expected one of inputs, outputs, parameters, k");
}

using RunsTest = ProgramTest;

std::string counting(const std::filesystem::path& folder) {
  return "echo run >> " + (folder / "count").string() + "\n" + kTimesTen;
}

TEST_F(RunsTest, MakeEachRunOnceAndKeepTheOrder) {
  Runs runs{program(counting(folder_.path())), 10};
  RunInputs other = three_rows();
  other.parameters = {100};

  const auto results = runs.results({other, three_rows(), other});
  static_cast<void>(runs.result(other));

  EXPECT_EQ(results[0].outputs[0][1], 200);
  EXPECT_EQ(results[1].outputs[0][1], 20);
  EXPECT_EQ(results[2].outputs, results[0].outputs);
  EXPECT_EQ(runs.made(), 2U);
  EXPECT_EQ(test::content_of(folder_.path() / "count"), "run\nrun\n");
}

TEST_F(RunsTest, EndWhenTheyAreSpent) {
  Runs runs{program(kTimesTen), 1};
  static_cast<void>(runs.result(three_rows()));
  RunInputs other = three_rows();
  other.parameters = {100};

  EXPECT_EQ(runs.result(three_rows()).outputs[0][1], 20);
  EXPECT_EQ(test::error_of([&] { static_cast<void>(runs.result(other)); }),
            "1 of 1 runs are made and 1 more are needed: allow more (most_runs), or fit less");
}

TEST_F(RunsTest, RefuseASimulationThatDiffersFromRunToRun) {
  EXPECT_NO_THROW((Runs{program(kTimesTen), 10}.check_repeats(three_rows())));
  Runs random{program("(echo y; for i in 1 2 3; do date +%N | sed 's/^0*//'; done) > outputs.csv"),
              10};

  EXPECT_NE(test::error_of([&] {
              random.check_repeats(three_rows());
            }).find("two runs with the same inputs differ by up to "),
            std::string::npos);
}

TEST_F(RunsTest, EndOnAnInterrupt) {
  const Interruptible interruptible;
  Runs runs{program("sleep 1000"), 10};
  std::raise(SIGINT);

  EXPECT_THROW(static_cast<void>(runs.result(three_rows())), Interrupted);
}

}  // namespace
}  // namespace rths::foreign
