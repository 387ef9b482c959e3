// SPDX-License-Identifier: Apache-2.0
// The real OpenSees, unmodified, against a spring of ours. Displacements and the order of messages
// are those that its own sources and others' runs give.
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "spring_server.hpp"
#include "support/files.hpp"
#include "support/opensees.hpp"
#include "support/process.hpp"

namespace rths::adapters {
namespace {

struct Analysis {
  const char* name;
  std::vector<std::string> arguments;  ///< integrator, and what belongs to it
  std::vector<double> displacements;   ///< of the first steps
  std::vector<int> start, step;        ///< messages before, and in each
};

void PrintTo(const Analysis& analysis, std::ostream* out) { *out << analysis.name; }

class RealOpenSees : public testing::TestWithParam<std::tuple<Transport, Analysis>> {
 protected:
  void SetUp() override {
    python_ = rths::test::opensees_python();
    if (!python_)
      GTEST_SKIP()
          << "SKIPPED: there is no OpenSees here; ./lab test installs it in build/opensees";
  }
  [[nodiscard]] std::vector<std::string> command(std::uint16_t port, Transport transport,
                                                 std::vector<std::string> arguments) const {
    const auto script = rths::test::source_tree() / "tests/opensees/oscillator.py";
    std::vector<std::string> words{*python_, script.string(), std::to_string(port),
                                   transport == Transport::Tcp ? "tcp" : "udp"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
  }
  std::optional<std::string> python_;
};

TEST_P(RealOpenSees, MovesTheSpringAsItMovesItsOwn) {
  const auto& [transport, analysis] = GetParam();
  test::SpringServer server{transport};
  std::vector<std::string> arguments{std::to_string(analysis.displacements.size())};
  arguments.insert(arguments.end(), analysis.arguments.begin(), analysis.arguments.end());
  rths::test::Running running{command(server.port(), transport, arguments)};
  const auto finished = running.wait(30);
  const test::Heard heard = server.heard();

  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(heard.trouble, "");
  std::istringstream lines{finished.out};
  for (const double expected : analysis.displacements) {
    double displacement = 0;
    ASSERT_TRUE(lines >> displacement) << finished.out;
    EXPECT_NEAR(displacement, expected, 5e-9 * std::max(1.0, std::abs(expected)));
  }
  std::vector<int> expected{0};
  expected.insert(expected.end(), analysis.start.begin(), analysis.start.end());
  for (std::size_t i = 0; i < analysis.displacements.size(); ++i)
    expected.insert(expected.end(), analysis.step.begin(), analysis.step.end());
  // The ground has not moved yet: the first step stays where it is.
  expected[1 + analysis.start.size()] = -3;
  expected.push_back(99);
  EXPECT_EQ(heard.codes, expected);
}

const Analysis kAnalyses[] = {
    {"NewmarkExplicit",
     {"NewmarkExplicit", "0.5"},
     {0, -0.00994759549, -0.0388868053},
     {-3, 15},
     {3, 14, 10, 14, -3, 5}},
    {"AlphaOS",
     {"AlphaOS", "0.9"},
     {-0.00269314635, -0.0152357525, -0.0461809084},
     {-3, 15},
     {3, 13, 14, 10, 14, 13, -3, 5}},
    {"KRAlphaExplicit",
     {"KRAlphaExplicit", "0.5"},
     {0, -0.00882115028, -0.0366971138},
     {-3, 12, 14, 15, 14},
     {3, 10, 14, -3, 5}},
};

std::string name_of(const testing::TestParamInfo<RealOpenSees::ParamType>& test) {
  const auto& [transport, analysis] = test.param;
  return std::string{transport == Transport::Tcp ? "Tcp" : "Udp"} + analysis.name;
}

INSTANTIATE_TEST_SUITE_P(Analyses, RealOpenSees,
                         testing::Combine(testing::Values(Transport::Tcp, Transport::Udp),
                                          testing::ValuesIn(kAnalyses)),
                         name_of);

}  // namespace
}  // namespace rths::adapters
