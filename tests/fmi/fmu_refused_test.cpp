// SPDX-License-Identifier: Apache-2.0
//
// FMUs and tables of nodes that are refused, each with one line.
#include <gtest/gtest.h>

#include "bench_node.hpp"
#include "test_fmu.hpp"

namespace rths::fmi {
namespace {

using test::Change;

/// What makes an FMU unusable.
struct Refused {
  const char* name;  ///< of the case
  int version;
  std::vector<Change> changes;  ///< of its description
  const char* tables;           ///< empty: the usual ones
  const char* keys;
  const char* message;
  friend std::ostream& operator<<(std::ostream& out, const Refused& r) { return out << r.name; }
};

class RefusedFmu : public ::testing::TestWithParam<Refused> {};

TEST_P(RefusedFmu, SaysWhatIsWrong) {
  const Refused& refused = GetParam();
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto file = test::lag_fmu(folder, refused.version, "correct", refused.changes);
  const std::string tables =
      *refused.tables != '\0' ? refused.tables : test::lag_table(refused.version);

  const auto error = test::error_of([&] {
    const auto adapter = node.make(file, tables, refused.keys);
    adapter->activate();
  });

  EXPECT_NE(error.find(refused.message), std::string::npos) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
}

const char* const kInput3 =
    "<Float64 name=\"u\" valueReference=\"1\" causality=\"input\" start=\"0\" unit=\"mm\"/>";

INSTANTIATE_TEST_SUITE_P(
    Fmi, RefusedFmu,
    ::testing::Values(
        Refused{"token",
                3,
                {{"8c4e", "0000"}},
                "",
                "",
                "fmi3Instantiate failed: wrong instantiation token"},
        Refused{"guid",
                2,
                {{"8c4e", "0000"}},
                "",
                "",
                "fmi2Instantiate failed: wrong GUID '{0000810f-3df3-4a00-8276-176fa3c9f9e0}'"},
        Refused{"version",
                2,
                {{"fmiVersion=\"2.0\"", "fmiVersion=\"1.0\""}},
                "",
                "",
                "fmiVersion is '1.0', expected 2.0 or 3.0"},
        Refused{"xml", 3, {{"</ModelVariables>", ""}}, "", "", "is no XML"},
        Refused{"exchange",
                3,
                {{"<CoSimulation", "<ModelExchange"}},
                "",
                "",
                "has no <CoSimulation>, but <ModelExchange>"},
        Refused{"tool",
                2,
                {{"<CoSimulation ", "<CoSimulation needsExecutionTool=\"true\" "}},
                "",
                "",
                "needsExecutionTool is true"},
        Refused{"identifier",
                3,
                {{"modelIdentifier=\"correct\"", "modelIdentifier=\"other\""}},
                "",
                "",
                "has no binaries/x86_64-linux/other.so: it has binaries for x86_64-linux"},
        Refused{"unknown unit",
                3,
                {{kInput3,
                  "<Float64 name=\"u\" valueReference=\"1\" causality=\"input\" "
                  "unit=\"furlongish\"/>"}},
                "",
                "",
                "unit 'furlongish' of 'u': unit 'furlongish' does not parse"},
        Refused{"other quantity",
                3,
                {{"m=\"1\" factor=\"0.001\"", "mol=\"1\" s=\"-1\""}},
                "",
                "",
                "unit 'mm' of 'u': the quantity of unit 's-1.mol' is not supported"},
        Refused{"wrong unit",
                3,
                {},
                "[signals]\nu = \"ref.force\"\ny = \"fbk.y\"\nenabled = "
                "\"ref.enabled\"\n[start]\nlevel = 0\n",
                "",
                "node 'mac' reads 'ref.force' in [m], the map gives [N]"},
        Refused{"no unit",
                3,
                {{"unit=\"mm\"/>", "/>"}},
                "",
                "",
                "node 'mac' reads 'ref.u' in [1], the map gives [m]"},
        Refused{"two units",
                2,
                {},
                "[units]\nu = \"mm\"\n",
                "",
                "node.toml:4:5: the FMU states [mm] for 'u'"},
        Refused{"unit of a flag",
                2,
                {},
                "[units]\nenabled = \"mm\"\n",
                "",
                "'enabled' is of type Boolean, which has no unit"},
        Refused{"no signal",
                3,
                {},
                "[signals]\nu = \"ref.u\"\n",
                "",
                "node 'mac': node.toml:1:1: input 'enabled' has no signal"},
        Refused{"no output",
                2,
                {},
                "[signals]\nu = \"ref.u\"\nenabled = \"ref.enabled\"\ny = \"fbk.z\"\n",
                "",
                "no signal 'fbk.z'"},
        Refused{"no variable",
                2,
                {},
                "[signals]\nenabed = \"ref.u\"\n",
                "",
                "the FMU has no variable 'enabed' (did you mean 'enabled'?)"},
        Refused{"array",
                3,
                {},
                "[signals]\nrow = \"ref.u\"\n",
                "",
                "'row' is an array, expected a scalar"},
        Refused{"text", 3, {}, "[start]\ntitle = 1\n", "", "'title' is of type String"},
        Refused{"text 2", 2, {}, "[start]\ntitle = 1\n", "", "'title' is of type String"},
        Refused{
            "clock", 3, {}, "[signals]\ntick = \"ref.enabled\"\n", "", "'tick' is of type Clock"},
        Refused{"clocked",
                3,
                {},
                "[signals]\nsampled = \"fbk.y\"\n",
                "",
                "'sampled' belongs to a clock"},
        Refused{"parameter as signal",
                3,
                {},
                "[signals]\ntau = \"ref.u\"\n",
                "",
                "'tau' has causality parameter, expected input or output"},
        Refused{"start of an output",
                3,
                {},
                "[start]\ny = 1\n",
                "",
                "'y' has causality output, expected parameter or input"},
        Refused{
            "start outside", 3, {}, "[start]\ntau = 2\n", "", "tau is 2, the FMU allows 0 to 1"},
        Refused{"start beyond its type",
                3,
                {},
                "[start]\nlevel = 300\nu = 0\nenabled = true\n",
                "",
                "a value of [start] is outside the range of its type"},
        Refused{"start of a flag", 3, {}, "[start]\nenabled = 1\n", "", "expected true or false"},
        Refused{"fixed parameter",
                3,
                {},
                "",
                "tunable = [\"tau\"]\n",
                "'tau' is a fixed parameter, expected a tunable parameter"},
        Refused{
            "ramp of an input", 3, {}, "", "ramp = [\"u\"]\n", "'u' is no output with a signal"},
        Refused{"key", 3, {}, "", "files = 1\n", "did you mean 'file'?"},
        Refused{"reference",
                3,
                {{"valueReference=\"1\"", "valueReference=\"-1\""}},
                "",
                "",
                "valueReference is '-1', expected a number"},
        Refused{"factor",
                3,
                {{"factor=\"0.001\"", "factor=\"0\""}},
                "",
                "",
                "factor of unit 'mm' is 0"}));

TEST(Fmu, WithAFixedStepIsRefusedAtAnotherPeriod) {
  const test::TemporaryFolder folder;
  const test::BenchNode node;
  const auto file = test::lag_fmu(folder, 3, "correct");

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(node.make(file, test::lag_table(3), "", 0.0015));
            }).find("period_s is 0.0015, expected a multiple of the FMU's fixed step, 0.001 s"),
            std::string::npos);
  EXPECT_EQ(
      test::error_of([&] { static_cast<void>(node.make(file, test::lag_table(3), "", 0.003)); }),
      "");
}

TEST(Fmu, GivesItsNodeItsPreferredStep) {
  const test::TemporaryFolder folder;
  const auto file =
      test::lag_fmu(folder, 2, "correct", {{"stepSize=\"0.001\"", "stepSize=\"0.004\""}});
  const Config table =
      Config::parse("file = \"" + file.string() + "\"\nrole = \"machine\"\n", "node");

  EXPECT_EQ(read_fmu("mac", table, {}).schedule.period, from_seconds(0.004));
}

}  // namespace
}  // namespace rths::fmi
