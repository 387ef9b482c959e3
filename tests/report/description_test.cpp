// SPDX-License-Identifier: Apache-2.0
//
// Facts of a run that a report takes from its recording.
#include <algorithm>

#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>
#include <rths/report/report.hpp>

#include "report/src/analysis.hpp"
#include "report/src/numbers.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

memmap::Map map_with_a_parameter() {
  return memmap::parse_map(R"(
ringmap = 1
[ring]
name = "sample"
version = 1
size_bytes = 4096
[nodes]
machine = 1
operator = 200
[[partition]]
name = "monitor.machine"
node = "machine"
offset = 0
longwords = 1
[[partition.signal]]
name = "host.step"
offset = 0
type = "f32"
[[partition]]
name = "tune.machine"
node = "operator"
offset = 16
longwords = 2
[[partition.signal]]
name = "gain"
offset = 16
type = "f32"
unit = "ms"
[[partition.signal]]
name = "stream"
offset = 17
type = "f32"
)",
                           "sample");
}

constexpr const char* kExperiment = R"(
format = 1
name = "shake"
axes = ["long"]
duration_s = 20
[motion]
name = "Petrolia"
column_vert = 3
[specimen]
model = "tpfb"
[plant]
spectrum_elevation_m = 33
[machine.load_dependent_friction]
friction_coefficient = 0.002
[model.specimen.lead_heating]
enabled = false
[node.opf]
adapter = "numerical"
[node.srmd]
adapter = "srmd"
)";

/// A recording of 100 rows, in which the operator sets a gain at 0.04 s.
class Recorded {
 public:
  explicit Recorded(recording::NamedTexts meta, const std::string& overrides = "",
                    const std::string& experiment = kExperiment) {
    const memmap::Map map = map_with_a_parameter();
    meta.emplace_back("experiment", "shake.toml");
    meta.emplace_back("experiment_path", "my tests/shake.toml");
    recording::RecordingInfo info{{{"shake.toml", experiment}}, meta, {{"machine", 1}}};
    if (!overrides.empty()) info.config.emplace_back(recording::kOverridesText, overrides);
    std::vector<SignalId> signals;
    for (std::uint32_t i = 0; i < map.signals().size(); ++i) signals.push_back(SignalId{i});
    recording::Writer writer{file_, map, signals, info};
    for (int row = 0; row < 100; ++row)
      writer.append(std::chrono::milliseconds{row},
                    std::vector<double>{row + 1.0, row < 40 ? 0.5 : 0.25, 1.0 * row});
    writer.close();
  }
  [[nodiscard]] recording::Reader reader() const { return recording::Reader{file_}; }
  [[nodiscard]] RunDescription described() const { return describe(reader()); }

 private:
  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "run.h5";
};

bool says(const RunDescription& test, const std::string& part) {
  return std::any_of(test.scope.begin(), test.scope.end(), [&](const auto& sentence) {
    return sentence.find(part) != std::string::npos;
  });
}

TEST(Description, QuotesTheExperimentOfTheRecording) {
  const RunDescription test = Recorded{{{"clock", "wall"}, {"ending", "completed"}}}.described();

  EXPECT_EQ(test.name, "shake");
  EXPECT_EQ(test.planned_duration, 20);
  EXPECT_EQ(test.spectrum_elevation, 33);
  EXPECT_TRUE(test.synthetic);
  EXPECT_TRUE(says(test, "Specimen (tpfb)"));
  EXPECT_TRUE(says(test, "terms of specimen and machine: machine.load_dependent_friction."));
  EXPECT_TRUE(says(test, "differs in: specimen.lead_heating (off)."));
  EXPECT_TRUE(says(test, "Tested axis: long."));
  EXPECT_TRUE(says(test, "assumptions of this project"));
  EXPECT_TRUE(says(test, "load of the bearing varies by vertical motion of the ground."));
}

// An experiment with only these nodes, by their adapters.
RunDescription described_with(const std::string& nodes, const std::string& more = "[motion]\n") {
  return Recorded{{}, "", "name = \"shake\"\n" + more + nodes}.described();
}

// Other structures have floors at places of their own.
TEST(Description, KnowsTheElevationOfSticksAlone) {
  EXPECT_TRUE(described_with("[node.opf]\nadapter = \"numerical\"\n").spectrum_elevation);
  EXPECT_FALSE(described_with("[node.opf]\nadapter = \"numerical\"\n", "[plant]\nmodel = \"ant\"\n")
                   .spectrum_elevation);
  EXPECT_FALSE(described_with("[node.opf]\nadapter = \"opensees\"\n"
                              "[[node.opf.floor]]\nname = \"roof\"\n")
                   .spectrum_elevation);
}

TEST(Description, SaysWhatVariesTheVerticalLoad) {
  const std::string nodes =
      "[node.opf]\nadapter = \"numerical\"\n[node.srmd]\nadapter = \"srmd\"\n";
  const auto load_is = [&](const std::string& tables, const std::string& expected) {
    return says(described_with(nodes, tables), "The vertical load of the bearing " + expected);
  };
  const std::string corner = "[plant]\nbearing_long_m = -40\n";
  EXPECT_TRUE(load_is("[motion]\n", "is constant."));
  EXPECT_TRUE(load_is(corner, "varies by overturning of the structure."));
  EXPECT_TRUE(load_is(corner + "[motion]\nfile_vert = \"up.AT2\"\n",
                      "varies by vertical motion of the ground and by overturning of the "
                      "structure."));
  EXPECT_TRUE(
      load_is("[plant]\nmodel = \"ant\"\n", "varies by overturning and bending of the structure."));
  EXPECT_TRUE(load_is("[plant]\nmodel = \"ant\"\nbearings = 1\n", "is constant."));
  EXPECT_TRUE(says(described_with("[node.opf]\nadapter = \"opensees\"\n", corner),
                   "The vertical load of the bearing is constant."));
}

TEST(Description, IsOfModelsWhereAModelPlaysTheMachine) {
  for (const std::string machine : {"srmd", "ideal_machine", "echo", "opensees_specimen"}) {
    const RunDescription test = described_with(
        "[node.opf]\nadapter = \"external\"\n[node.xpc]\nadapter = \"" + machine + "\"\n");
    EXPECT_TRUE(test.synthetic) << machine;
    EXPECT_TRUE(says(test, "No value was measured in a laboratory.")) << machine;
  }
}

TEST(Description, IsOfModelsWhereOnlyTheSolverIsTheUsersOwn) {
  const Recorded recorded{{}, "node.opf={adapter=\"external\"}\n"};

  EXPECT_TRUE(recorded.described().synthetic);
  EXPECT_TRUE(is_of_models(recorded.reader()).value_or(false));
}

TEST(Description, SaysThatAMachineOfTheUsersOwnMayBeReal) {
  for (const std::string adapter : {"external", "plugin", "fmu"})
    for (const std::string node : {"srmd", "xpc"}) {
      const RunDescription test = described_with("[node.opf]\nadapter = \"numerical\"\n[node." +
                                                 node + "]\nadapter = \"" + adapter + "\"\n");
      EXPECT_FALSE(test.synthetic) << adapter << node;
      EXPECT_TRUE(says(test, "Node " + node + " with adapter " + adapter +
                                 " represents specimen and machine. It is the user's own and "
                                 "may drive a real machine."))
          << adapter << node;
    }
}

TEST(Description, SaysThatAnIdealMachineHasNoVerticalAxis) {
  const RunDescription test =
      described_with("[node.xpc]\nadapter = \"ideal_machine\"\n", "[motion]\ncolumn_vert = 3\n");

  EXPECT_TRUE(says(test, "has no vertical axis, so the vertical load of the bearing is constant."));
}

TEST(Description, NamesCommandedDisplacementsWhereThereIsNoEarthquake) {
  const RunDescription test =
      described_with("[node.srmd]\nadapter = \"srmd\"\n", "[targets]\nkind = \"sine\"\n");

  EXPECT_EQ(test.motion, "commanded displacements");
}

TEST(Description, HasTheCommandThatRepeatsTheRun) {
  const Recorded recorded{{{"clock", "virtual"}}, "duration_s=10\nname=\"a b\"\n"};

  EXPECT_EQ(
      recorded.described().command,
      "rths run 'my tests/shake.toml' --set duration_s=10 --set 'name=\"a b\"' --clock virtual");
  EXPECT_EQ(recorded.described().planned_duration, 10);
}

TEST(Ending, IsEmptyOnlyForACompletedRun) {
  const auto ending = [](const recording::NamedTexts& meta) {
    return Recorded{meta}.described().ending;
  };

  EXPECT_EQ(ending({{"ending", "completed"}}), "");
  EXPECT_EQ(ending({{"ending", "srmd: limit exceeded"}}), "srmd: limit exceeded");
  EXPECT_NE(ending({}).find("no ending was recorded"), std::string::npos);
}

TEST(Ending, MakesARunInconclusive) {
  Analysis analysis;
  analysis.test.planned_duration = 12;
  analysis.timing.duration = 7.26;
  EXPECT_TRUE(is_conclusive(analysis));

  analysis.test.ending = "interrupted";

  EXPECT_FALSE(is_conclusive(analysis));
  EXPECT_NE(summary_of(analysis).find("ended at 7.260 of 12 s: interrupted"), std::string::npos);
  EXPECT_EQ(numbers_of(analysis)["ending"], "interrupted");
}

TEST(OperatorChanges, HoldTimeSignalAndBothValues) {
  const auto changes = operator_changes(Recorded{recording::NamedTexts{}}.reader());

  ASSERT_EQ(changes.size(), 1U);  // neither the machine's steps nor a stream of data
  EXPECT_EQ(changes[0].signal, "tune.machine.gain");
  EXPECT_EQ(changes[0].time, 0.040);
  EXPECT_EQ(changes[0].from, 0.5);
  EXPECT_EQ(changes[0].to, 0.25);
  EXPECT_EQ(changes[0].unit, "s");
}

}  // namespace
}  // namespace rths::report
