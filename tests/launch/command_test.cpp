// SPDX-License-Identifier: Apache-2.0
//
// The command's exit codes, output streams and one-line errors.
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>

#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>
#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths {
namespace {

using test::Finished;
using test::run_rths;

long lines(const std::string& text) { return std::count(text.begin(), text.end(), '\n'); }

TEST(Command, ExitsWithThreeOnWrongUsage) {
  EXPECT_EQ(run_rths({}).exit_code, 3);
  EXPECT_EQ(run_rths({"fly"}).exit_code, 3);
  EXPECT_EQ(run_rths({"run"}).exit_code, 3);
  EXPECT_EQ(run_rths({"run", "x.toml", "--clock", "sun"}).exit_code, 3);
  EXPECT_EQ(run_rths({"run", "x.toml", "--set", "novalue"}).exit_code, 3);
}

TEST(Command, ReportsWrongUsageInOneLineWithTheHelpToRead) {
  const Finished unfinished = run_rths({"map", "gen"});
  EXPECT_EQ(unfinished.err, "rths: map is required; see rths map gen --help\n");
  EXPECT_EQ(unfinished.out, "");
  EXPECT_EQ(run_rths({"run", "x.toml", "--set", "\x1b[31m"}).err,
            "rths: --set \\x1b[31m: expected key=value; see rths run --help\n");
}

TEST(Command, PrintsNoControlCharactersOfNames) {
  EXPECT_EQ(run_rths({"check", "a\nb\x1b[31m"}).err,
            "rths: a\\nb\\x1b[31m: cannot be read: No such file or directory\n");
}

TEST(Command, HasHelpForEverySubcommand) {
  for (const char* command : {"run", "check", "dump", "export", "who", "watch", "fault", "send",
                              "loop", "terms", "map", "report", "doctor", "clean"}) {
    const Finished help = run_rths({command, "--help"});
    EXPECT_EQ(help.exit_code, 0) << command;
    EXPECT_GT(lines(help.out), 2) << command;
  }
  EXPECT_EQ(run_rths({"--version"}).exit_code, 0);
}

TEST(Command, SaysHowToGetTheBenchmarks) {
  const test::TemporaryFolder folder;
  const auto alone = folder.path() / "rths";
  std::filesystem::copy_file(test::rths_command(), alone);

  const Finished bench = test::Running{{alone.string(), "bench", "ring"}}.wait();

  EXPECT_EQ(bench.exit_code, 2);
  EXPECT_EQ(bench.err, "rths: " + alone.string() +
                           "-bench: No such file or directory, expected the program of the "
                           "benchmarks there; ./lab rths bench builds it, as does cmake with "
                           "-DRTHS_BENCHMARKS=ON\n");
}

TEST(Command, ReportsAFailureInOneLine) {
  const Finished failed = run_rths({"run", "/no/such.toml"});

  EXPECT_EQ(failed.exit_code, 2);
  EXPECT_EQ(failed.err, "rths: /no/such.toml: cannot be read: No such file or directory\n");
  EXPECT_EQ(failed.out, "");
}

struct Checked {
  const char* name;
  std::string file;
  const char* kind;
};

class Check : public ::testing::TestWithParam<Checked> {};

TEST_P(Check, RecognisesAFileByItsContent) {
  const Finished checked = run_rths({"check", GetParam().file});

  EXPECT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_NE(checked.out.find(GetParam().kind), std::string::npos) << checked.out;
  // The second line of an experiment has the sizes of its motion, those of a case its channels.
  const std::string name = GetParam().name;
  EXPECT_EQ(lines(checked.out), name == "experiment" ? 2 : name == "case" ? 7 : 1) << checked.out;
}

std::string in_tree(const char* file) { return (test::source_tree() / file).string(); }

INSTANTIATE_TEST_SUITE_P(
    Kinds, Check,
    ::testing::Values(
        Checked{"map", in_tree("memmap/maps/srmd.ringmap.toml"), ": map 'srmd'"},
        Checked{"diagram", in_tree("adapters/simulink_like/diagrams/hybrid_controller.toml"),
                ": block diagram, "},
        Checked{"bearing", in_tree("sim/bearings/tpfb.toml"), ": bearing 'TPFB', 2 terms, "},
        Checked{"machine", in_tree("sim/machines/srmd.toml"),
                ": machine 'SRMD with six degrees of freedom', lowest natural frequency "},
        Checked{"limits", in_tree("adapters/safety/limits/srmd.toml"),
                ": limits of a safety layer"},
        Checked{"constants", in_tree("examples/srmd_constants.toml"),
                ": constants of observer for the diagram '"},
        Checked{"experiment", in_tree("examples/srmd_lprb_2d.toml"), ": experiment 'srmd_lprb_2d'"},
        Checked{"columns", in_tree("examples/records/petrolia_1992_riodell_freefield.csv"),
                "ground motion (columns), 3000 samples, interval 0.02 s, peak 0.3857 g of column 1 "
                "'h1_g' (in g)"},
        Checked{"scenario", in_tree("examples/cards/dead_node.toml"), ": scenario of 4 cards, 400"},
        Checked{"case", in_tree("examples/diagnosis/actuator/case.toml"), ": case '"}),
    [](const auto& checked) { return std::string{checked.param.name}; });

TEST(Check, RefusesAWrongBoundOfAConclusiveTest) {
  const test::TemporaryFolder folder;
  std::string example = test::content_of(test::source_tree() / "examples/srmd_lprb_2d.toml");
  constexpr std::string_view kBound = "response = 0.2";
  example.replace(example.find(kBound), kBound.size(), "nrmse = 0.1");
  for (const char* used : {"records", "srmd_constants.toml"})
    std::filesystem::copy(test::source_tree() / "examples" / used, folder.path() / used);
  const auto file = folder.write("wrong.toml", example);
  for (const char* command : {"check", "run"}) {
    const Finished refused = run_rths({command, file.string()});
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.err.find("unknown key 'nrmse' (did you mean 'nrms'?)"), std::string::npos)
        << refused.err;
  }
}

TEST(Check, SaysWhatIsWrongWithAMachineLimitsOrConstants) {
  const test::TemporaryFolder folder;
  const auto expect = [&](const char* file, const std::string& from, const std::string& to,
                          const std::string& line) {
    std::string text = test::content_of(test::source_tree() / file);
    text.replace(text.find(from), from.size(), to);
    const Finished refused = run_rths({"check", folder.write("wrong.toml", text).string()});
    EXPECT_EQ(refused.exit_code, 2) << refused.out;
    EXPECT_NE(refused.err.find(line), std::string::npos) << refused.err;
    EXPECT_EQ(lines(refused.err), 1) << refused.err;
  };
  expect("sim/machines/srmd.toml", "machine = 1", "machine = 1\nfamily_member = 3",
         "unknown key 'family_member'");
  expect("sim/machines/srmd.toml", "stroke_m = [1.22, 0.61, 0.127]", "stroke_m = [1.22, 0.61]",
         "stroke_m has 2 numbers, expected 3");
  expect("adapters/safety/limits/srmd.toml", "jump_m = [0.08, 0.035, 0.0127]", "jump_m = [0.08]",
         "jump_m has 1 numbers, expected [long, lat]");
  expect("examples/srmd_constants.toml", "force_offset_N", "force_ofset_N",
         "unknown key 'force_ofset_N'");
}

TEST(Check, ListsTheColumnsOfARecording) {
  const test::TemporaryFolder folder;
  const auto log = folder.write("log.csv", "t [s];u [mm];F\n;;kN\n0;1,5;2\n0,1;-2,5;4\n0,2;3;7\n");

  const Finished checked = run_rths({"check", log.string()});

  EXPECT_EQ(checked.out, log.string() +
                             ": table of 3 columns for the records of a case\n"
                             "  't [s]': 3 values, 0 to 0.2 in steps of 0.1\n"
                             "  'u [mm]': 3 values, -2.5 to 3\n"
                             "  'F' [kN]: 3 values, 2 to 7\n");
  const auto lvm = folder.write("a.lvm",
                                "LabVIEW Measurement\nX_Columns\tOne\n***End_of_Header***\n"
                                "Channels\t1\n***End_of_Header***\nX_Value\tF\n0\t1\n1\t0\n");
  EXPECT_NE(run_rths({"check", lvm.string()}).out.find("table of 2 columns"), std::string::npos);
  // A damaged motion, or a velocity, is no recording.
  for (const char* text : {"t,ns [g]\n0,1\n.01,x\n", "t,v [cm/s]\n0,1\n.01,2\n.02,3\n"})
    EXPECT_EQ(run_rths({"check", folder.write("m.csv", text).string()}).exit_code, 2) << text;
}

TEST(Check, ListsTheChannelsOfAStation) {
  const test::TemporaryFolder folder;
  const auto file = folder.write(
      "a.dat",
      "#StationCode: ABC\n#RecordLength(sec): .06\n#SampleRate(Hz): 50\n#AmplitudeUnit:  gal.\n"
      "#DataSequence: Time U(+); N(+); E(+)\n#Data: 4F10.3\n0 0 0 0\n.02 98.0665 196.133 0\n"
      ".04 0 0 -98.0665\n");

  EXPECT_EQ(run_rths({"check", file.string()}).out,
            file.string() +
                ": ground motion (CWA), 3 samples, interval 0.02 s, peak 0.1 g of column 1 'U' (in "
                "gal (cm/s²)), 0.2 g of column 2 'N' (in gal (cm/s²)), 0.1 g of column 3 'E' (in "
                "gal (cm/s²))\n");
}

TEST(Check, RefusesUnknownFiles) {
  const test::TemporaryFolder folder;
  const auto binary = folder.write("a.bin", std::string("\x7f"
                                                        "ELF\0\0\0\0",
                                                        8));
  const auto empty = folder.write("empty", "");
  const auto other = folder.write("other.toml", "[tool]\nname = \"x\"\n");

  EXPECT_EQ(run_rths({"check", binary.string()}).exit_code, 2);
  EXPECT_EQ(run_rths({"check", empty.string()}).err, "rths: " + empty.string() + ": is empty\n");
  EXPECT_NE(run_rths({"check", other.string()}).err.find("expected one of the keys ringmap"),
            std::string::npos);
  EXPECT_EQ(run_rths({"check", "/no/such"}).exit_code, 2);
}

TEST(Check, SaysHowAnImprovedModelIsUsed) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("improved.toml",
                                 "[specimen.adiabatic_heating]\nkind = \"adiabatic_heating\"\n"
                                 "softening_1_per_J = 1e-7\n"
                                 "[machine.coulomb_friction]\nfriction_force_N = 6000\n");

  const Finished checked = run_rths({"check", file.string()});

  EXPECT_EQ(checked.out, file.string() +
                             ": improved model of a diagnosis, 2 terms; apply it with 'rths run "
                             "EXPERIMENT --improve " +
                             file.string() + "'\n")
      << checked.err;
  folder.write("improved.toml", "[specimen.heat]\nkind = \"adiabatic_heating\"\nsoftening = 1\n");
  EXPECT_NE(run_rths({"check", file.string()}).err.find("unknown key 'softening'"),
            std::string::npos);
}

TEST(Check, SaysWhereACaseIsWrong) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("mine.toml", "format = 1\n[channels]\n[[record]]\nfil = \"a\"\n");

  const Finished checked = run_rths({"check", file.string()});

  EXPECT_EQ(checked.exit_code, 2);
  EXPECT_EQ(checked.err.rfind("rths: " + file.string() + ":", 0), 0U) << checked.err;
}

TEST(Check, RefusesAnUnknownKeyOfTheModelOfACase) {
  const test::TemporaryFolder folder;
  const auto copy = folder.path() / "actuator";
  std::filesystem::copy(test::source_tree() / "examples/diagnosis/actuator", copy,
                        std::filesystem::copy_options::recursive);
  std::string text = test::content_of(copy / "case.toml");
  text.insert(text.find("[model]\n") + 8, "delai_s = 0\n");
  std::ofstream{copy / "case.toml"} << text;

  const Finished checked = run_rths({"check", (copy / "case.toml").string()});

  EXPECT_EQ(checked.exit_code, 2) << checked.out;
  EXPECT_NE(checked.err.find("unknown key 'delai_s'"), std::string::npos) << checked.err;
}

TEST(Run, TakesATextWithoutQuotes) {
  const std::string example = in_tree("examples/srmd_lprb_2d.toml");
  EXPECT_NE(run_rths({"run", example, "--set", "map=stz"})
                .err.find("map is 'stz', expected a file or one of:"),
            std::string::npos);
  EXPECT_EQ(run_rths({"run", example, "--set", "axes=[long]"}).err,
            "rths: --set axes: the value is [long], expected a number, true, false, a text or a "
            "list such as [\"a\", \"b\"]; a shell needs quotes around it: '[\"a\", \"b\"]'\n");
}

TEST(MapCommand, ChecksAndGeneratesBuiltInMaps) {
  EXPECT_NE(run_rths({"map", "check", "srmd"}).out.find("136 signals"), std::string::npos);
  EXPECT_NE(
      run_rths({"map", "gen", "srmd", "--lang", "c"}).out.find("#define SRMD_OPF_NEWTARGET 1024u"),
      std::string::npos);
  EXPECT_NE(
      run_rths({"map", "check", "smrd"}).err.find("expected a file or one of: flextest_osu, "),
      std::string::npos);
}

memmap::Map map_with_a_parameter() {
  memmap::MapDescription description = test::small_map().description();
  memmap::Signal gain;
  gain.name = "gain";
  gain.unit = "s";
  gain.range = {0, 0.1};
  gain.offset = LongwordOffset{600};
  memmap::Partition parameters;
  parameters.name = "tune.machine";
  parameters.node = "controller";
  parameters.base = gain.offset;
  parameters.longwords = 1;
  parameters.signals = {gain};
  description.partitions.push_back(parameters);
  return memmap::Map{description};
}

/// A ring with a live node of this test, so that `rths clean` keeps it.
class RingCommand : public ::testing::Test {
 protected:
  std::string name = test::unique_ring("command");
  test::RingRemoval removal{name};
  broker::Ring ring = broker::Ring::create(name, map_with_a_parameter());
  broker::Node machine = ring.join("machine", 0);
};

TEST_F(RingCommand, SendConvertsTheGivenUnit) {
  EXPECT_EQ(run_rths({"send", name, "ref.long=2inch"}).exit_code, 0);

  EXPECT_NE(run_rths({"dump", name, "--once", "ref.long"}).out.find(") ref.long = 50.8 mm\n"),
            std::string::npos);
}

TEST_F(RingCommand, DumpPrintsARecordingInTheUnitsOfTheRing) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.h5";
  {
    recording::Writer writer{file, ring.map(), {ring.map().signal("ref.long")}, {}};
    const double metres = 0.0508;
    writer.append(Duration{0}, {&metres, 1});
    writer.close();
  }

  for (const auto& source : {file, folder.path()})
    EXPECT_NE(run_rths({"dump", source.string()}).out.find(") ref.long = 50.8 mm\n"),
              std::string::npos);
  EXPECT_NE(run_rths({"check", folder.path().string()}).out.find(": recording, 1 rows"),
            std::string::npos);
  const test::TemporaryFolder empty;
  for (const char* command : {"dump", "check"})
    EXPECT_NE(run_rths({command, empty.path().string()})
                  .err.find(": the folder has no run.h5, expected that of a run"),
              std::string::npos);
}

TEST_F(RingCommand, SuggestsRingsAndCompletesTheirSignals) {
  EXPECT_NE(run_rths({"dump", name + "x"})
                .err.find("there is no ring '" + name + "x' (did you mean '" + name + "'?)"),
            std::string::npos);
  EXPECT_EQ(run_rths({"complete", "dump", name, "ref.lo"}).out, "ref.long\n");
  EXPECT_EQ(run_rths({"complete", "send", name, "ref.lo"}).out, "ref.long=\n");
  EXPECT_EQ(run_rths({"complete", "dump", name + "x", "ref.lo"}).out, "\n");
}

TEST_F(RingCommand, WhoReportsWriterAndTimeOfAWord) {
  EXPECT_NE(run_rths({"who", name, "ref.long"})
                .out.find(": belongs to controller, no write in its journal"),
            std::string::npos);

  EXPECT_EQ(run_rths({"send", name, "ref.long=2inch"}).exit_code, 0);

  EXPECT_NE(run_rths({"who", name, "ref.long"}).out.find("ref.long = 50.8 mm: by controller, "),
            std::string::npos);
}

TEST_F(RingCommand, WatchReportsNothingOfNodesWithAJournal) {
  test::Running watch{{test::rths_command(), "watch", name, "-T", "400"}};
  EXPECT_EQ(run_rths({"send", name, "ref.long=2inch"}).exit_code, 0);

  const Finished finished = watch.wait(10);

  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(finished.out, "");
}

TEST_F(RingCommand, SendChecksAllArgumentsBeforeItWrites) {
  EXPECT_EQ(run_rths({"send", name, "ref.long=1", "ref.lng=2"}).exit_code, 2);

  EXPECT_NE(run_rths({"dump", name, "--once", "--format", "csv"}).out.find("ref.long,2.5,mm"),
            std::string::npos);
}

TEST_F(RingCommand, SendReportsWrongArguments) {
  EXPECT_EQ(run_rths({"send", name, "ref.long=2kN"}).err,
            "rths: ref.long=2kN: the unit 'kN' does not convert to mm, the signal's unit\n");
  EXPECT_EQ(run_rths({"send", name, "ref.long=x"}).err, "rths: ref.long=x: expected a number\n");
  EXPECT_EQ(run_rths({"send", name, "ref.long"}).err, "rths: 'ref.long': expected name=value\n");
  EXPECT_NE(run_rths({"send", "no_such_ring", "a=1"}).err.find("there is no ring 'no_such_ring'"),
            std::string::npos);
}

// The parameters of a run are words with a range.
TEST_F(RingCommand, SendRefusesAValueOutsideItsRange) {
  const Finished refused = run_rths({"send", name, "tune.machine.gain=1e6"});

  EXPECT_EQ(refused.err, "rths: tune.machine.gain=1e6: expected 0 to 0.1 s\n");
  EXPECT_EQ(run_rths({"send", name, "tune.machine.gain=100ms"}).exit_code, 0);
}

TEST_F(RingCommand, SendListsTheSignalsBesideAnUnknownOne) {
  EXPECT_EQ(run_rths({"send", name, "tune.machine.gian=1"}).err,
            "rths: the ring's map 'small' has no signal 'tune.machine.gian' (did you mean "
            "'tune.machine.gain'?)\n");
  EXPECT_EQ(run_rths({"send", name, "tune.machine.stiffness_of_spring=1"}).err,
            "rths: the ring's map 'small' has no signal 'tune.machine.stiffness_of_spring', "
            "expected one of tune.machine.gain\n");
  EXPECT_EQ(run_rths({"send", name, "nothing.like.this=1"}).err,
            "rths: the ring's map 'small' has no signal 'nothing.like.this', expected one of "
            "fbk.…, echo.…, ref.…, tune.machine.…\n");
}

TEST_F(RingCommand, DumpExitsWithOneAtItsTimeout) {
  const Finished waited = run_rths({"dump", name, "ref.long", "-n", "3", "-T", "200"});

  EXPECT_EQ(waited.exit_code, 1);
  EXPECT_EQ(lines(waited.out), 1);  // the initial value only
}

TEST_F(RingCommand, DumpPrintsJsonThatParses) {
  const Finished dumped = run_rths({"dump", name, "--once", "--format", "json"});

  EXPECT_EQ(dumped.out.rfind("{\"time_s\": ", 0), 0U);
  EXPECT_NE(dumped.out.find("\"signal\": \"ref.long\", \"value\": 2.5, \"unit\": \"mm\"}"),
            std::string::npos);
}

TEST_F(RingCommand, DumpAndWhoRefuseAPatternThatMatchesNothing) {
  const std::string refusal =
      "rths: ring '" + name + "': no signal matches 'ref.lng' (did you mean 'ref.long'?)\n";
  EXPECT_EQ(run_rths({"dump", name, "--once", "ref.l*", "ref.lng"}).err, refusal);
  EXPECT_EQ(run_rths({"who", name, "ref.l*", "ref.lng"}).err, refusal);
}

TEST_F(RingCommand, DoctorListsTheNodesOfARing) {
  const Finished doctor = run_rths({"doctor"});

  EXPECT_NE(doctor.out.find(name + ": "), std::string::npos);
  EXPECT_NE(doctor.out.find("machine"), std::string::npos);
}

TEST_F(RingCommand, EndsWithOneLineWhenTheRingIsTruncated) {
  test::Running dump{{test::rths_command(), "dump", name, "-T", "20000"}};
  std::this_thread::sleep_for(std::chrono::milliseconds{500});

  std::filesystem::resize_file("/dev/shm/rths." + name, 0);
  const Finished finished = dump.wait(10);

  EXPECT_EQ(finished.exit_code, 2);
  EXPECT_EQ(finished.err,
            "rths: memory of the ring was lost: its shared-memory object was truncated\n");
  broker::on_lost_memory(broker::OnLostMemory::Continue);  // this test has nodes on it, too
}

TEST(DoctorAndClean, NameAndSkipRingsOfOtherUsers) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a ring to another user";
  const std::string name = test::unique_ring("other_user");
  const test::RingRemoval removal{name};
  { const broker::Ring ring = broker::Ring::create(name, test::small_map()); }
  ASSERT_EQ(chown(("/dev/shm/rths." + name).c_str(), 54321, 54321), 0);

  const std::string trouble = "ring '" + name + "' belongs to user 54321\n";
  EXPECT_NE(run_rths({"doctor"}).out.find(" bytes: " + trouble), std::string::npos);
  EXPECT_NE(run_rths({"clean"}).out.find("skipped " + name + ": " + trouble), std::string::npos);
  EXPECT_TRUE(std::filesystem::exists("/dev/shm/rths." + name));
  EXPECT_EQ(run_rths({"stop", name}).err, "rths: " + trouble);
}

// A recording is a large file of another kind, and a case has keys of its own.
TEST(Command, RunNamesAFileThatIsNoExperiment) {
  const test::TemporaryFolder folder;
  const auto recording = folder.write("run.h5", "\x89HDF\r\n\x1a\n and so on");
  const auto found = test::run_rths({"run", recording.string()});
  const auto from_case = test::run_rths(
      {"run", (test::source_tree() / "examples/diagnosis/synthetic/structure/case.toml").string()});

  EXPECT_EQ(found.exit_code, 2);
  EXPECT_NE(found.err.find("run.h5: is a recording, expected an experiment"), std::string::npos)
      << found.err;
  EXPECT_EQ(from_case.exit_code, 2);
  EXPECT_NE(from_case.err.find("belongs to a case of the diagnosis, expected an experiment"),
            std::string::npos)
      << from_case.err;
}

TEST(Command, RunRefusesAKeyOfACaseInAnExperiment) {
  for (const char* key : {"record", "channels", "run"}) {
    const auto found =
        test::run_rths({"run", (test::source_tree() / "examples/srmd_lprb_2d.toml").string(),
                        "--set", std::string{key} + "=1", "--clock", "virtual"});

    EXPECT_EQ(found.exit_code, 2);
    EXPECT_NE(found.err.find("unknown key '" + std::string{key} + "'"), std::string::npos)
        << found.err;
  }
}

TEST(Command, NamesAPathThatTheSystemRefuses) {
  const std::string path(300, 'a');

  EXPECT_EQ(run_rths({"check", path}).err, "rths: " + path + ": File name too long\n");
}

TEST(CleanCommand, RemovesOnlyUnusedRings) {
  const std::string used = test::unique_ring("used");
  const std::string abandoned = test::unique_ring("left");
  const test::RingRemoval first{used};
  const test::RingRemoval second{abandoned};
  broker::Ring ring = broker::Ring::create(used, test::small_map());
  const broker::Node machine = ring.join("machine", 0);
  { const broker::Ring left = broker::Ring::create(abandoned, test::small_map()); }
  EXPECT_EQ(run_rths({"doctor"}).exit_code, 1);

  const Finished clean = run_rths({"clean"});

  EXPECT_NE(clean.out.find("removed " + abandoned), std::string::npos);
  EXPECT_EQ(clean.out.find("removed " + used), std::string::npos);
}

}  // namespace
}  // namespace rths
