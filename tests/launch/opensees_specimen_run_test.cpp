// SPDX-License-Identifier: Apache-2.0
// Runs with a model in OpenSees as the specimen.
#include <signal.h>

#include <utility>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "opensees_run.hpp"
#include "support/waiting.hpp"

namespace rths {
namespace {

/// OpenSees at both ends of the ring: the frame, and its column as a separate model.
class OpenSeesSpecimen : public OpenSeesRun {
 protected:
  [[nodiscard]] std::vector<std::string> command(const std::string& column_arguments,
                                                 const std::string& protocol) const {
    const std::string units = "dofs=[\"long\"], length_unit_m=0.0254, force_unit_N=4448.2216";
    return {
        test::rths_command(),
        "run",
        (test::source_tree() / "examples/opensees/one_bay_frame.toml").string(),
        "--clock",
        "virtual",
        "--out",
        out().string(),
        "--force",
        "--set",
        fmt::format("duration_s={}", duration_),
        "--set",
        fmt::format(
            "node.xpc={{adapter=\"opensees_specimen\", python=\"{}\", script=\"column.py\", "
            "arguments=[\"{}\"{}], connect_deadline_s=10, element=[{{name=\"column\", "
            "port={}, protocol=\"{}\", {}}}]}}",
            python_, column_port_, column_arguments, column_port_, protocol, units),
        "--set",
        fmt::format("node.opf={{adapter=\"opensees\", python=\"{}\", script=\"one_bay_frame.py\", "
                    "arguments=[\"{{motion}}\", \"--port\", \"{}\", \"--duration\", \"{}\", "
                    "\"--response\", \"{}\"], "
                    "element=[{{name=\"left_column\", port={}, initial_stiffness=[[2.8]], {}}}]}}",
                    python_, port_, duration_, "{results}.csv", port_, units)};
  }
  std::uint16_t column_port_ = test::free_port();
};

TEST_F(OpenSeesSpecimen, IsDrivenByASolverAsIfItWereOneModel) {
  const auto own = folder_.path() / "own.csv";
  for (const auto& [arguments, protocol] : std::vector<std::pair<std::string, std::string>>{
           {"", "tcp"}, {R"(, "--element", "actuator")", "tcp"}, {R"(, "--udp")", "udp"}}) {
    test::Running running{command(arguments, protocol)};
    const auto finished = running.wait(60);
    ASSERT_EQ(finished.exit_code, 0) << arguments << finished.err;
    if (!std::filesystem::exists(own)) {
      test::Running alone{{python_,
                           (test::source_tree() / "examples/opensees/one_bay_frame.py").string(),
                           (out() / "run.opf.motion.csv").string(), "--column", "steel",
                           "--duration", std::to_string(duration_), "--response", own.string()}};
      ASSERT_EQ(alone.wait(60).exit_code, 0);
    }
    const Rows found = ring_response(), expected = read_rows(own);
    ASSERT_EQ(found.size(), steps());
    // Errors: float32, and 1e-7 from the stiffness that holds the column at its target.
    for (const std::size_t column : {1U, 2U}) EXPECT_LT(nrmse(found, expected, column), 1e-5);
  }
}

TEST_F(OpenSeesSpecimen, EndsTheRunWhenItDies) {
  test::Running laboratory{command("", "tcp")};
  int column = 0;
  ASSERT_TRUE(test::comes_true([&] {
    for (const int child : test::programs_of(laboratory.pid()))
      if (test::command_line_of(child).find("column.py") != std::string::npos) column = child;
    return column != 0 && std::filesystem::exists(out() / "run.csv");
  }));
  kill(column, SIGKILL);
  const auto finished = laboratory.wait(20);
  EXPECT_EQ(finished.exit_code, 2) << finished.out << finished.err;
  EXPECT_NE(finished.err.find("xpc: element 'column': OpenSees closed the connection"),
            std::string::npos)
      << finished.err;
  EXPECT_NE(finished.err.find("column.py was killed by signal 9"), std::string::npos)
      << finished.err;
}

TEST_F(OpenSeesSpecimen, SaysThatItsScriptCannotStart) {
  test::Running laboratory{command(R"(, "--element", "spring")", "tcp")};
  const auto finished = laboratory.wait(20);
  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_NE(finished.err.find("column.py ended with 2: column.py: error: argument --element"),
            std::string::npos)
      << finished.err;
}

}  // namespace
}  // namespace rths
