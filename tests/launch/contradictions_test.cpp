// SPDX-License-Identifier: Apache-2.0
//
// Contradictions in time, owner, unit, output and capacity. Each run is refused or not conclusive,
// and a line names the time and the signal, or the key or file.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>

#include "contrary_runs.hpp"
#include "support/ring_maps.hpp"
#include "support/waiting.hpp"

namespace rths::launch {
namespace {

struct Contradiction {
  const char* name;
  const char* experiment;
  std::vector<std::string> sets;
  const char* line;  ///< regular expression of a part of the line
};

std::string fault(const std::string& name) { return "node.opf.config.fault=\"" + name + "\""; }

std::string sensor(const std::string& kind, const std::string& channel, const std::string& value) {
  return "machine.sensor={kind=\"" + kind + "\", channel=\"" + channel + "\", axes=[\"long\"], " +
         value + "}";
}

constexpr const char* kExample = "srmd_lprb_2d_ats";

const Contradiction kInTime[] = {
    {"GoesBack", "solver", {fault("goes back")}, "time at .* s: opf.1.time.target: .* 1 go back"},
    {"Iterates", "solver", {fault("iterates")}, "time at .* s: opf.1.time.target: .* 100 repeat"},
    {"StopsItsTime",
     "solver",
     {fault("stops its time")},
     "time at .* opf.1.time.target: .* repeat"},
    {"HasUnevenSteps",
     "solver",
     {fault("has uneven steps")},
     "time at .* s: opf.1.time.target: .* 100 advance it by less .* 100 advance it by more"},
    {"HasDoubleSteps",
     "solver",
     {fault("has double steps")},
     "time at 1.* s: opf.1.time.target: .* 200 advance it by more"},
    {"HasDoubleStepsWithAController",
     "controlled",
     {fault("has double steps")},
     "time at 1.* s: opf.1.time.target: .* 200 advance it by more"},
    {"CountsSteps", "solver", {fault("counts steps")}, "time at .*: opf.1.time.target: .* by more"},
    {"LeavesEarly", "solver", {fault("leaves early")}, "end at .* opf.1.time.target: found 0.99 s"},
    {"Hangs",
     "solver",
     {fault("hangs")},
     "opf: did not end the test until 7.000 s, expected its end 3 s after its first target"},
    {"NeverEnds",
     "solver",
     {fault("never ends")},
     "opf: did not end the test until 7.000 s, expected its end 3 s after its first target"},
    {"IsTooFast",
     "solver",
     {fault("asks for no switch")},
     "rate at .* s: opf.1.time.target: found 0.5 s for|rate at .* opf.1.time.target: found 0.49"},
    {"IsTooSlow", "solver", {fault("is slow")}, "rate at .* s: opf.1.time.target: found 1.68 s"},
    {"IsTooSlowWithAController", "controlled", {fault("is slow")}, "rate at .* opf.1.time.target"},
    {"ComputesLongerThanItsStep",
     kExample,
     {"solver.computing_time_s=0.02"},
     "rate at .* s: opf.1.time.target: found 3.* s for each second"},
    {"RecordGoesBack", kExample, {"motion={file=\"{files}/back.csv\"}"}, "back.csv.* not equally"},
    {"RecordRepeatsATime",
     kExample,
     {"motion={file=\"{files}/repeated.csv\"}"},
     "repeated.csv.* time is not equally spaced"},
    {"RecordIsUneven",
     kExample,
     {"motion={file=\"{files}/uneven.csv\"}"},
     "uneven.csv.* not equally"},
    {"ComponentsHaveTwoTimeSteps",
     kExample,
     {"motion={file_long=\"{files}/g.csv\", file_lat=\"{files}/slow.csv\"}"},
     "the components differ in length or time step"},
    {"ReferenceGoesBack",
     kExample,
     {"reference={file=\"{files}/back.csv\"}"},
     "back.csv.* time is not equally spaced"},
};

const Contradiction kOfUnit[] = {
    {"TargetsInMillimetres",
     "solver",
     {fault("sends millimetres")},
     "limit at .* s: opf.long.displ.target: found .* m, expected .*: is it in mm"},
    {"TargetsInMillimetresOnAMachine",
     "controlled",
     {fault("sends millimetres")},
     "safety trip at .* s: long: jump of the command"},
    {"TargetsInCentimetresOnAMachine",
     "controlled",
     {fault("sends centimetres")},
     "safety trip at .* s: long: jump of the command"},
    {"ForceInKilonewton",
     kExample,
     {sensor("gain", "force", "factor=0.001")},
     "before it: force at .* s: srmd.long.force.fbk"},
    {"ForceInPounds",
     kExample,
     {sensor("gain", "force", "factor=0.2248")},
     "force at .* s: srmd.long.force.fbk"},
    {"DisplacementInKilometres",
     kExample,
     {sensor("gain", "displacement", "factor=0.001")},
     "before it: motion at .* s: srmd.long.displ.fbk"},
    {"DisplacementInInches",
     kExample,
     {sensor("gain", "displacement", "factor=0.0254")},
     "before it: motion at .* s: srmd.long.displ.fbk"},
    {"AccelerationInG",
     kExample,
     {sensor("gain", "acceleration", "factor=0.101972")},
     "motion at .* s: srmd.long.accel.fbk"},
    {"RecordInDegrees",
     kExample,
     {"motion={file=\"{files}/degrees.csv\"}"},
     "the column 'h1 \\[deg\\]' is no acceleration"},
    {"RecordInMillimetres",
     kExample,
     {"motion={file=\"{files}/mm_per_s2.csv\"}"},
     "is the record in mm/s²"},
    {"ReferenceInCentimetres",
     kExample,
     {"reference={file=\"{files}/cm.csv\"}"},
     "response at .* s: opf.long.displ.target: found .* % from the numerical result"},
    {"CommandsInCentimetres",
     kExample,
     {"targets={kind=\"file\", file=\"{files}/cm.csv\"}", "duration_s=8"},
     "safety trip at .* s: long: |are they in mm"},
    {"LoadInKilonewton",
     kExample,
     {"node.xpc.tune.compression.value=9685.6"},
     "load at .* s: srmd.compression.force.fbk: found .* kN, expected 10 kN"},
    {"SafetyLimitInMillimetres",
     kExample,
     {"node.srmd.safety.displacement_m=[1200, 600]"},
     "safety.displacement_m.* is it in another unit"},
    {"YieldDisplacementInMillimetres",
     kExample,
     {"specimen.bouc_wen.yield_displacement_m=20"},
     "specimen.bouc_wen.yield_displacement_m: "},
};

const Contradiction kOfOutput[] = {
    {"TargetIsNan",
     "solver",
     {fault("sends nan")},
     "wrote nan to 'opf.long.displ.target'.* at .* s"},
    {"TargetStops",
     "solver",
     {fault("sends the last target")},
     "live at .* s: opf.long.displ.target: found the same target in"},
    {"SolverIsSilent",
     "solver",
     {fault("sends nothing")},
     "set none of its .* outputs, such as 'opf.newTarget', for 2 s at 2.000 s"},
    {"MachineHasNoForce", "machine", {}, "srmd.long.force.fbk"},
    {"ForceStands",
     kExample,
     {sensor("saturation", "force", "limit_N=1000")},
     "(force|live) at .* s: srmd.long.force.fbk"},
    {"AccelerationIsZero",
     kExample,
     {sensor("gain", "acceleration", "factor=0")},
     "motion at .* s: srmd.long.accel.fbk"},
};

const Contradiction kOfCapacity[] = {
    {"Vertical",
     kExample,
     {"plant.bearings=20"},
     "the specimen carries 235.4 MN, expected at most"},
    {"LoadIsNegative",
     kExample,
     {"node.xpc.tune.compression.value=-1e6"},
     "compression.value is -1000000, expected 0 to"},
    {"LoadIsMissing",
     kExample,
     {"node.xpc.tune.compression.value=0"},
     "load at .* s: srmd.compression.force.fbk: found"},
    {"Stroke",
     kExample,
     {"targets={kind=\"file\", file=\"{files}/inch.csv\"}", "duration_s=8"},
     "commanded displacements of long are up to .* m, the machine's stroke is 1.22 m"},
    {"Velocity",
     kExample,
     {"targets={kind=\"file\", file=\"{files}/fast.csv\"}", "duration_s=1"},
     "safety trip at .* s: lat: velocity of the command is .* m/s, expected at most 0.95"},
    {"HorizontalForce",
     kExample,
     {sensor("gain", "force", "factor=4.448")},
     "before it: limit at .* s: srmd.long.force.fbk: found 8900 kN"},
    {"ValvesAtTheirLimit",
     kExample,
     {"plant.basemat_mass_kg=1e5"},
     "limit at .* s: monitor.srmd.host.status"},
};

class ContradictionInVirtualTime : public ::testing::TestWithParam<Contradiction> {};

bool has_line(const std::string& text, const std::string& expression) {
  std::istringstream lines{text};
  std::string line;
  while (std::getline(lines, line))
    if (std::regex_search(line, std::regex{expression})) return true;
  return false;
}

TEST_P(ContradictionInVirtualTime, IsNamed) {
  const auto& contradiction = GetParam();
  const ContraryRuns runs;

  const auto finished = runs.run(contradiction.experiment, contradiction.sets);

  EXPECT_GT(finished.exit_code, 0) << "conclusive";
  EXPECT_TRUE(has_line(finished.out + finished.err, contradiction.line))
      << finished.out << finished.err;
}

std::string name_of(const ::testing::TestParamInfo<Contradiction>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Time, ContradictionInVirtualTime, ::testing::ValuesIn(kInTime), name_of);
INSTANTIATE_TEST_SUITE_P(Unit, ContradictionInVirtualTime, ::testing::ValuesIn(kOfUnit), name_of);
INSTANTIATE_TEST_SUITE_P(Output, ContradictionInVirtualTime, ::testing::ValuesIn(kOfOutput),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Capacity, ContradictionInVirtualTime, ::testing::ValuesIn(kOfCapacity),
                         name_of);

// The runs above contradict themselves, and these do not.
TEST(ContraryRuns, AreConclusiveWithoutAContradiction) {
  for (const char* experiment : {"solver", "controlled", "ideal", kExample}) {
    const ContraryRuns runs;
    const auto finished = runs.run(experiment, {});
    EXPECT_EQ(finished.exit_code, 0) << experiment << finished.out << finished.err;
  }
  const ContraryRuns runs;
  EXPECT_EQ(runs.run(kExample, {"reference={file=\"{files}/m.csv\"}", "conclusive.response=100"})
                .exit_code,
            0);
}

/// A word that a process stores that does not own it.
struct Stolen {
  const char* name;
  const char* signal;  ///< "": a word that no node owns
  const char* line;
};

class StoreInRealTime : public ::testing::TestWithParam<Stolen> {};

/// A word between the partitions.
std::size_t unowned_word(const memmap::Map& map) {
  const auto& partitions = map.description().partitions;
  for (std::size_t word = 0;; ++word) {
    const bool is_owned =
        std::any_of(partitions.begin(), partitions.end(), [&](const auto& partition) {
          return word >= partition.base.value() &&
                 word < partition.base.value() + partition.longwords;
        });
    if (!is_owned) return word;
  }
}

TEST_P(StoreInRealTime, IntoTheWordOfAnotherIsNamed) {
  const ContraryRuns runs;
  const test::RingRemoval removal{runs.ring()};
  auto command = runs.command("ideal", {}, "wall");
  command.insert(command.begin(), test::rths_command());
  test::Running running{command};
  ASSERT_TRUE(test::comes_true([&] {
    const auto report = broker::inspect_ring(runs.ring());
    return report &&
           std::any_of(report->occupants.begin(), report->occupants.end(),
                       [](const auto& one) { return one.node == "recorder" && one.beats > 300; });
  }));
  {
    auto ring = broker::Ring::attach(runs.ring());
    auto thief = ring.join_plain("");
    const std::string signal = GetParam().signal;
    const std::size_t word =
        signal.empty() ? unowned_word(ring.map())
                       : ring.map().entry(ring.map().signal(signal)).signal->offset.value();
    for (std::uint32_t i = 1; i <= 300; ++i) {
      std::atomic_ref{thief.plain_memory()[word]}.store(0x3A000000 + i);
      std::this_thread::sleep_for(std::chrono::microseconds{500});
    }
  }

  const auto finished = running.wait();

  EXPECT_GT(finished.exit_code, 0);
  EXPECT_TRUE(has_line(finished.out + finished.err, GetParam().line))
      << finished.out << finished.err;
}

INSTANTIATE_TEST_SUITE_P(
    Contradictions, StoreInRealTime,
    ::testing::Values(
        Stolen{"Force", "daq.long.force.fbk", "owner at .* s: daq.long.force.fbk: .* owner xpc"},
        Stolen{"Flag", "daq.switchPC", "owner at .* s: daq.switchPC: .* owner xpc"},
        Stolen{"Target", "opf.long.displ.target", "owner at .* s: opf.long.displ.target: .* opf"},
        Stolen{"Monitor", "monitor.opf.step", "owner at .* s: monitor.opf.step: .* owner opf"},
        Stolen{"NobodysWord", "", "owner at .* s: longword .* no node owns the word"}),
    [](const auto& one) { return std::string{one.param.name}; });

// The launcher ends it at twice its duration, and a second later.
TEST(SolverInRealTime, ThatNeverEndsIsStoppedWithAnErrorThatNamesIt) {
  const ContraryRuns runs;

  const auto finished = runs.run(
      "solver", {fault("never ends"), "duration_s=1", "node.opf.config.duration_s=1"}, "wall");

  EXPECT_EQ(finished.exit_code, 2) << finished.out;
  EXPECT_TRUE(has_line(finished.err,
                       "the run ended early: opf: did not end the test until 3\\..* s, expected "
                       "its end 1 s after its first target"))
      << finished.err;
  EXPECT_LT(finished.host_seconds, 15);
}

}  // namespace
}  // namespace rths::launch
