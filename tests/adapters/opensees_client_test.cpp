// SPDX-License-Identifier: Apache-2.0
// The real, unmodified OpenSees with a spring of the test. The expected displacements and message
// orders follow from its sources and from independent runs.
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <gtest/gtest.h>

#include "spring_server.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/with_opensees.hpp"

namespace rths::adapters {
namespace {

struct Analysis {
  const char* name;
  std::vector<std::string> arguments;  ///< integrator and its options
  std::vector<double> displacements;   ///< of the first steps, if known
  std::vector<int> start, first,
      step;  ///< messages before the first step, in it, in each further step
};

void PrintTo(const Analysis& analysis, std::ostream* out) { *out << analysis.name; }

class RealOpenSees : public test::WithOpenSees<> {
 protected:
  [[nodiscard]] std::vector<std::string> command(std::uint16_t port, Transport transport,
                                                 std::vector<std::string> arguments) const {
    const auto script = test::source_tree() / "tests/opensees/oscillator.py";
    std::vector<std::string> words{python_, script.string(), std::to_string(port),
                                   transport == Transport::Tcp ? "tcp" : "udp"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return words;
  }
};

class Integrators : public RealOpenSees,
                    public testing::WithParamInterface<std::tuple<Transport, Analysis>> {};

TEST_P(Integrators, MovesTheSpringLikeItsOwn) {
  const auto& [transport, analysis] = GetParam();
  test_support::SpringServer server{transport};
  constexpr std::size_t kSteps = 3;
  std::vector<std::string> arguments{std::to_string(kSteps)};
  arguments.insert(arguments.end(), analysis.arguments.begin(), analysis.arguments.end());
  test::Running running{command(server.port(), transport, arguments)};
  const auto finished = running.wait(30);
  const test_support::Received received = server.received();

  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(received.error, "");
  std::istringstream lines{finished.out};
  for (const double expected : analysis.displacements) {
    double displacement = 0;
    ASSERT_TRUE(lines >> displacement) << finished.out;
    EXPECT_NEAR(displacement, expected, 5e-9 * std::max(1.0, std::abs(expected)));
  }
  std::vector<int> expected{0};
  const auto append = [&](const std::vector<int>& codes) {
    expected.insert(expected.end(), codes.begin(), codes.end());
  };
  append(analysis.start);
  append(analysis.first);
  for (std::size_t i = 1; i < kSteps; ++i) append(analysis.step);
  expected.push_back(99);
  EXPECT_EQ(received.codes, expected);
}

using Words = std::vector<std::string>;
const Words kInitial{"--algorithm", "Linear,-initial"};
const Words kFourTimes{"--algorithm", "Newton,-initial", "--iterations", "4"};

Words with(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

// The ground is still at rest, so explicit integrators do not move in the first step.
const Analysis kAnalyses[] = {
    {"NewmarkExplicit",
     {"NewmarkExplicit", "0.5"},
     {0, -0.00994759549, -0.0388868053},
     {-3, 15},
     {-3, 14, 10, 14, -3, 5},
     {3, 14, 10, 14, -3, 5}},
    {"AlphaOS",
     {"AlphaOS", "0.9"},
     {-0.00269314635, -0.0152357525, -0.0461809084},
     {-3, 15},
     {-3, 13, 14, 10, 14, 13, -3, 5},
     {3, 13, 14, 10, 14, 13, -3, 5}},
    {"AlphaOSInitial",
     with({"AlphaOS", "0.9"}, kInitial),
     {-0.00269314635, -0.0152357525, -0.0461809084},
     {-3, 15},
     {-3, 12, 14, 10, 14, -3, 5},
     {3, 14, 10, 14, -3, 5}},
    {"AlphaOSGeneralized",
     with({"AlphaOSGeneralized", "0.8"}, kInitial),
     {},
     {-3, 15},
     {-3, 12, 14, 10, 14, -3, 5},
     {3, 14, 10, 14, -3, 5}},
    {"KRAlphaExplicit",
     {"KRAlphaExplicit", "0.5"},
     {0, -0.00882115028, -0.0366971138},
     {-3, 12, 14, 15, 14},
     {-3, 10, 14, -3, 5},
     {3, 10, 14, -3, 5}},
    {"HHTHSFixedNumIter",
     with({"HHTHSFixedNumIter", "0.8"}, kFourTimes),
     {},
     {-3, 15},
     {10, 14, 12, 14, 3, 10, 14, 14, 3, 10, 14, 14, 3, 10, 14, 14, 3, 10, 14, 14, 5},
     {10, 14, 14, 3, 10, 14, 14, 3, 10, 14, 14, 3, 10, 14, 14, 3, 10, 14, 14, 5}},
};

std::string name_of(const testing::TestParamInfo<Integrators::ParamType>& test) {
  const auto& [transport, analysis] = test.param;
  return std::string{transport == Transport::Tcp ? "Tcp" : "Udp"} + analysis.name;
}

INSTANTIATE_TEST_SUITE_P(Analyses, Integrators,
                         testing::Combine(testing::Values(Transport::Tcp, Transport::Udp),
                                          testing::ValuesIn(kAnalyses)),
                         name_of);

// Nagle's algorithm in OpenSees and a delayed acknowledgement in the server would take 44 ms a
// step.
TEST_F(RealOpenSees, DoesNotWaitForAcknowledgements) {
  constexpr double kSteps = 300, kStall = 0.044;
  test_support::SpringServer server{Transport::Tcp};
  test::Running running{command(server.port(), Transport::Tcp, {"300", "AlphaOS", "0.9"})};
  const auto finished = running.wait(30);
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_LT(finished.seconds, 0.5 * kSteps * kStall);
}

}  // namespace
}  // namespace rths::adapters
