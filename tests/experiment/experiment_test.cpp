// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/experiment/check.hpp>
#include <rths/launch/run.hpp>
#include <rths/replicated/images.hpp>

#include "support/files.hpp"

namespace rths::experiment {
namespace {

using app::load_experiment;
using launch::check_assembly;

/// An experiment and its record, in their own folder.
class ExperimentTest : public ::testing::Test {
 protected:
  ExperimentTest() {
    folder.write("record.csv", "0.00,0.1,0.2\n0.02,0.3,-0.1\n0.04,0,0\n");
    std::filesystem::copy_file(
        test::source_tree() / "adapters/simulink_like/diagrams/hybrid_controller.toml",
        folder.path() / "controller.toml");
    folder.write("other.toml", "title = \"other\"\n[polynomial_stiffness]\nlinear_N_per_m = 1e6\n");
    std::filesystem::copy_file(test::source_tree() / "memmap/maps/srmd.ringmap.toml",
                               folder.path() / "lab.ringmap.toml");
  }

  [[nodiscard]] std::filesystem::path write(const std::string& from = "",
                                            const std::string& to = "") const {
    std::string text = kText;
    if (!from.empty()) {
      EXPECT_NE(text.find(from), std::string::npos) << from;
      text.replace(text.find(from), from.size(), to);
    }
    return folder.write("lab.toml", text);
  }
  [[nodiscard]] std::string error_with(const std::string& from, const std::string& to) const {
    const auto file = write(from, to);
    std::string error = test::error_of([&] { check_assembly(load_experiment(file)); });
    const std::string prefix = folder.path().string() + "/";
    for (auto at = error.find(prefix); at != std::string::npos; at = error.find(prefix))
      error.erase(at, prefix.size());
    return error;
  }

  [[nodiscard]] static std::string text_named(const Experiment& e, const std::string& name) {
    for (const auto& [file, text] : e.config)
      if (file == name) return text;
    return "";
  }

  test::TemporaryFolder folder;
  static constexpr const char* kText = R"(format = 1
name = "lab"
map = "lab.ringmap.toml"
duration_s = 2.0
seed = 7
[motion]
file = "record.csv"
scale = 2.0
[node.recorder]
adapter = "recorder"
[node.opf]
adapter = "numerical"
[node.srmd]
adapter = "srmd"
[node.xpc]
adapter = "simulink_like"
diagram = "controller.toml"
tune.ats.enabled = 0
[uncompensated.xpc]
ats.enabled = 0
)";
};

TEST_F(ExperimentTest, HasANameThatStaysInItsFolder) {
  const std::string found = "lab.toml:2:8: name is '";
  for (const char* name : {"../lab", "a/b", "..", ".lab", "", "/tmp/lab"})
    EXPECT_EQ(error_with("\"lab\"", '"' + std::string{name} + '"'),
              found + name +
                  "', expected a file name: 1 to 200 characters without '/', and no '.' at the "
                  "start");
  EXPECT_NE(error_with("\"lab\"", '"' + std::string(201, 'x') + '"'), "");
  EXPECT_EQ(load_experiment(write("\"lab\"", "\"lab 2.b\"")).name, "lab 2.b");
}

TEST_F(ExperimentTest, IsReadWithItsDefaults) {
  const Experiment e = load_experiment(write());

  EXPECT_EQ(e.name, "lab");
  EXPECT_EQ(e.axes, (std::vector<std::string>{"long", "lat"}));
  EXPECT_EQ(e.time.integration_step, 0.01);
  EXPECT_EQ(e.time.simulation_step(), 0.01);
  EXPECT_EQ(e.machine.simulated.seed, 7U);
  EXPECT_NEAR(e.earthquake.motion.long_acceleration[1], 0.3 * 2 * 9.80665, 1e-12);
  EXPECT_NEAR(e.earthquake.motion.lat_acceleration[1], -0.1 * 2 * 9.80665, 1e-12);
  EXPECT_EQ(e.texts().size(), 5U);  // with the bearing, the model, its specimen and the diagram
  EXPECT_NEAR(e.specimen.axial_load, 480e6 * 9.80665 / 486, 1);
}

TEST_F(ExperimentTest, HasVerticalMotionOnlyOnRequest) {
  EXPECT_TRUE(load_experiment(write()).earthquake.motion.vert_acceleration.empty());
  const Experiment e = load_experiment(write(), {{"motion.column_vert", "1"}});

  EXPECT_EQ(e.earthquake.motion.vert_acceleration, e.earthquake.motion.long_acceleration);
  EXPECT_NE(error_with("scale = 2.0", "column_vert = 3").find("record.csv:1: 3 columns found"),
            std::string::npos);
}

TEST_F(ExperimentTest, ImprovesItsModelWithTheTermsOfADiagnosis) {
  const auto found = folder.write("found.toml",
                                  "[specimen.adiabatic_heating]\nkind = \"adiabatic_heating\"\n"
                                  "softening_1_per_J = 1e-7\n"
                                  "[specimen.bouc_wen]\ncharacteristic_strength_N = 9e5\n"
                                  "[machine.rub]\nkind = \"load_dependent_friction\"\n"
                                  "friction_coefficient = 0.002\n"
                                  "[machine.platen_inertia]\nmass_kg = 1.2e5\n"
                                  "[machine.machine_coulomb_friction]\n"
                                  "friction_force_N = [6000, 7000]\n");
  const Overrides changes{{"model.improvement", "[\"found.toml\"]"},
                          {"model.specimen.lead_heating.enabled", "false"},
                          {"model.machine.rub.enabled", "false"},
                          {"specimen.coulomb_friction.friction_force_N", "100"}};

  const Experiment e = load_experiment(write(), changes);

  const Config model = Config::parse(text_named(e, recording::kModelText), "model");
  EXPECT_FALSE(model.has("lead_heating"));
  EXPECT_EQ(model.table("adiabatic_heating").number("softening_1_per_J"), 1e-7);
  EXPECT_EQ(model.table("bouc_wen").number("characteristic_strength_N"), 9e5);
  EXPECT_EQ(model.table("rub").number("friction_coefficient"), 0.002);
  EXPECT_EQ(model.table("platen_inertia").numbers("mass_kg"), (std::vector<double>{1.2e5, 1.2e5}));
  EXPECT_FALSE(model.has("machine_platen_inertia"));
  EXPECT_EQ(model.table("coulomb_friction").number("friction_force_N"), 100);
  EXPECT_EQ(model.table("machine_coulomb_friction").numbers("friction_force_N"),
            (std::vector<double>{6000, 7000}));
  // The laboratory is unchanged.
  EXPECT_EQ(e.machine.simulated.axes[0].effective_mass, 113'371);
  EXPECT_EQ(e.specimen.terms.size(), load_experiment(write()).specimen.terms.size() + 1);
  EXPECT_EQ(e.machine.simulated.terms.size(),
            load_experiment(write()).machine.simulated.terms.size());
}

// A diagnosis writes a parameter with a value for each axis as a list.
TEST_F(ExperimentTest, ImprovesInertiaAndForceOffsetOfEachAxis) {
  folder.write("found.toml",
               "[machine.platen_inertia]\nmass_kg = [1.1e5, 1.2e5]\n"
               "[machine.force_offset]\noffset_N = [900, -800]\n");

  const Experiment e = load_experiment(write(), {{"model.improvement", "[\"found.toml\"]"}});

  const Config model = Config::parse(text_named(e, recording::kModelText), "model");
  EXPECT_EQ(model.table("platen_inertia").numbers("mass_kg"), (std::vector<double>{1.1e5, 1.2e5}));
  EXPECT_EQ(model.table("force_offset").numbers("offset_N"), (std::vector<double>{900, -800}));
  EXPECT_EQ(e.model.machine.axes[1].effective_mass, 1.2e5);
  EXPECT_EQ(e.model.machine.axes[1].force_offset, -800);
}

TEST_F(ExperimentTest, SaysWhereAnImprovementHasTooManyAxes) {
  folder.write("found.toml", "[machine.force_offset]\noffset_N = [900, -800, 3]\n");

  const std::string error = test::error_of([&] {
    static_cast<void>(load_experiment(write(), {{"model.improvement", "[\"found.toml\"]"}}));
  });

  EXPECT_NE(error.find("found.toml:2:12: offset_N has 3 numbers, expected [long, lat]"),
            std::string::npos)
      << error;
}

TEST_F(ExperimentTest, ChangesABearingTermByTerm) {
  const Experiment plain = load_experiment(write());
  const Experiment changed =
      load_experiment(write(), {{"specimen.bouc_wen.characteristic_strength_N", "5e5"},
                                {"specimen.coulomb_friction.friction_force_N", "1e4"}});

  EXPECT_EQ(changed.specimen.terms.size(), plain.specimen.terms.size() + 1);
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(load_experiment(write(), {{"specimen.model", "\"lprc\""}}));
            }).find("model is 'lprc', expected a file or one of:") == std::string::npos,
            false);
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(load_experiment(write(), {{"specimen.modl", "\"lprb\""}}));
            }).find("unknown key 'modl' (did you mean 'model'?)"),
            std::string::npos);
}

TEST_F(ExperimentTest, AssumesTheLaboratoryByDefault) {
  const Experiment e =
      load_experiment(write(), {{"machine.load_dependent_friction.friction_coefficient", "0.002"}});

  EXPECT_EQ(e.model.bearing.terms.size(), e.specimen.terms.size());
  const Config model = Config::parse(text_named(e, recording::kModelText), "model");
  EXPECT_EQ(model.text("kind"), "platen");
  EXPECT_EQ(model.table("lead_heating").number("lead_radius_m"), 0.1793);
  EXPECT_EQ(model.table("load_dependent_friction").number("friction_coefficient"), 0.002);
  EXPECT_EQ(model.table("coulomb_friction").numbers("friction_force_N"),
            (std::vector<double>{5100, 8600}));
  EXPECT_EQ(model.table("platen_inertia").numbers("mass_kg"),
            (std::vector<double>{113'371, 116'836}));
  EXPECT_EQ(model.table("force_offset").numbers("offset_N"), (std::vector<double>{2000, -1500}));
  EXPECT_FALSE(model.has("elastomeric_axial"));  // omitted in the bearing's file
}

TEST_F(ExperimentTest, OmitsFromTheModelEffectsThatAreDisabled) {
  const Experiment e = load_experiment(
      write(), {{"specimen.coulomb_friction.friction_force_N", "1e4"},
                {"machine.load_dependent_friction.friction_coefficient", "0.002"},
                {"model.specimen.lead_heating.enabled", "false"},
                {"model.specimen.bouc_wen.eta", "1.5"},
                {"model.machine.load_dependent_friction.enabled", "false"},
                {"model.machine.effective_mass_kg", "[1e5, 1e5]"},
                {"model.fitted", "[\"bouc_wen.eta\", \"machine_coulomb_friction.presliding\"]"}});

  const std::string text = text_named(e, recording::kModelText);
  EXPECT_EQ(text.find("lead_heating"), std::string::npos);
  EXPECT_EQ(text.find("load_dependent"), std::string::npos);
  EXPECT_EQ(e.model.bearing.terms.size() + 1, e.specimen.terms.size());
  const Config model = Config::parse(text, "model");
  EXPECT_EQ(model.table("bouc_wen").number("eta"), 1.5);
  EXPECT_EQ(model.table("coulomb_friction").number("friction_force_N"), 1e4);
  EXPECT_EQ(model.table("machine_coulomb_friction").text("kind"), "coulomb_friction");
  EXPECT_EQ(model.table("platen_inertia").numbers("mass_kg"), (std::vector<double>{1e5, 1e5}));
  EXPECT_EQ(sim::read_terms(model.without("fitted")).size(),
            10U);  // terms with two values count twice
}

TEST_F(ExperimentTest, MayAssumeAnotherBearing) {
  const Experiment e = load_experiment(write(), {{"model.specimen.model", "\"other.toml\""}});

  EXPECT_EQ(e.model.bearing.title, "other");
  EXPECT_EQ(e.specimen.title, "LPRB");
}

TEST_F(ExperimentTest, SaysWhereTheModelIsWrong) {
  const auto error = [&](const std::string& lines) {
    return error_with("[node.recorder]", lines + "\n[node.recorder]");
  };
  EXPECT_EQ(error("[model]\nspecimn.lead_heating.enabled = false"),
            "lab.toml:10:1: unknown key 'specimn' (did you mean 'specimen'?)");
  EXPECT_EQ(error("[model.specimen.lead_heeting]\nenabled = false").find("lab.toml:9:1: "), 0U);
  EXPECT_EQ(
      error("[model.machine.bouc_wen]\neta = 2").find("lab.toml:9:1: term 'bouc_wen' belongs to"),
      0U);
  EXPECT_EQ(error("[model]\nfitted = [\"bouc_wen.eta_\"]"),
            "lab.toml:10:10: the model has no parameter 'bouc_wen.eta_' (did you mean "
            "'bouc_wen.eta'?)");
  EXPECT_EQ(error("[model]\nfitted = [\"triple_pendulum.friction\"]")
                .find("lab.toml:10:10: the model has no parameter 'triple_pendulum.friction', "
                      "expected \"term.parameter\" of the specimen"),
            0U);
}

TEST_F(ExperimentTest, SaysWhereATermDoesNotApply) {
  const auto error = [&](const std::string& key) {
    return test::error_of([&] { static_cast<void>(load_experiment(write(), {{key, "1.1"}})); });
  };
  EXPECT_EQ(error("machine.adiabatic_heating.cooling_time_s"),
            "--set machine.adiabatic_heating.cooling_time_s: term 'adiabatic_heating' belongs to "
            "the specimen (stage modifier), expected one of the stages actuator, motion, machine "
            "or sensor");
  EXPECT_EQ(
      error("specimen.gain.factor"),
      "--set specimen.gain.factor: term 'gain' belongs to the machine (stage sensor), not to a "
      "specimen");
}

TEST_F(ExperimentTest, StartsReadersBeforeWriters) {
  const Experiment e = load_experiment(write());

  std::vector<std::string> order;
  for (const auto& node : e.nodes) order.push_back(node.node);
  EXPECT_EQ(order, (std::vector<std::string>{"recorder", "srmd", "xpc", "opf"}));
}

TEST_F(ExperimentTest, ReadsTuningWithDottedNames) {
  const Experiment e = load_experiment(write());

  EXPECT_EQ(e.nodes[2].tune, (Tuning{{"ats.enabled", 0}}));
  EXPECT_EQ(e.nodes[2].uncompensated, (Tuning{{"ats.enabled", 0}}));
}

TEST_F(ExperimentTest, TakesChangesFromTheCommandLine) {
  const Experiment e = load_experiment(write(), {{"duration_s", "5"}, {"motion.scale", "1"}});

  EXPECT_EQ(e.time.duration, 5);
  EXPECT_NEAR(e.earthquake.motion.long_acceleration[1], 0.3 * 9.80665, 1e-12);
}

TEST_F(ExperimentTest, HasNoSecondEarthquakeIfItsTableIsEmpty) {
  const auto file = test::source_tree() / "examples/srmd_lprb_2d.toml";

  EXPECT_TRUE(load_experiment(file).held_out.has_value());
  EXPECT_FALSE(load_experiment(file, {{"held_out", "{}"}}).held_out.has_value());
}

// A step that is no whole number of reference steps.
TEST_F(ExperimentTest, ImposesTheExpectedMotionAtItsTimes) {
  const auto file = test::source_tree() / "examples/srmd_lprb_2d.toml";
  const auto motion_with = [&](const char* step) {
    return load_experiment(file, {{"targets", "{kind = \"response\"}"},
                                  {"integration_step_s", step},
                                  {"duration_s", "4"}})
        .history->displacement_long;
  };

  const auto fine = motion_with("0.0025"), coarse = motion_with("0.005");

  double largest = 0;
  for (std::size_t i = 0; i < coarse.size(); ++i) {
    ASSERT_EQ(fine.at(2 * i), coarse[i]) << i;
    largest = std::max(largest, std::abs(coarse[i]));
  }
  EXPECT_GT(largest, 1e-4);
}

TEST_F(ExperimentTest, ReportsErrorsWithTheirPosition) {
  EXPECT_EQ(error_with("format = 1", "format = 9"),
            "lab.toml:1:10: format is 9, this program reads 1");
  EXPECT_EQ(error_with("duration_s", "duration"),
            "lab.toml:4:12: unknown key 'duration' (did you mean 'duration_s'?)");
  EXPECT_EQ(error_with("seed = 7", "sed = 7"),
            "lab.toml:5:7: unknown key 'sed' (did you mean 'seed'?)");
  EXPECT_EQ(error_with("seed = 7", "axes = [\"up\"]"),
            "lab.toml:5:8: axes are [\"up\"], expected [\"long\"], [\"lat\"] or both");
  EXPECT_EQ(error_with("seed = 7", "rate = 0.5"), "lab.toml:5:8: rate is 0.5, expected 1 to 1000");
  EXPECT_EQ(error_with("\"srmd\"\n[node.xpc]", "\"smrd\"\n[node.xpc]"),
            "lab.toml:14:11: there is no adapter 'smrd', expected one of recorder, srmd, "
            "ideal_machine, echo, opensees_specimen, simulink_like, numerical, opensees, external, "
            "plugin, fmu, replay");
  EXPECT_EQ(
      error_with("adapter = \"srmd\"", "adapter = \"external\"\ncommand = [\"x\", \"{moton}\"]"),
      "lab.toml:15:11: unknown placeholder '{moton}', expected one of {motion}, {step_s}, "
      "{duration_s}, {ring}, {node}");
  EXPECT_EQ(error_with("adapter = \"srmd\"", "adapter = \"external\"\nperiod_s = 0.001"),
            "lab.toml:15:12: found period_s of a program of its own, expected none");
  EXPECT_EQ(error_with("record.csv", "records.csv"),
            "lab.toml:7:8: file is 'records.csv', expected a file or one of: "
            "imperial_valley_1979_meloland_freefield, petrolia_1992_riodell_freefield");
  EXPECT_NE(error_with("\"controller.toml\"", "\"none.toml\"")
                .find("lab.toml:17:11: diagram is 'none.toml', expected a file or one of:"),
            std::string::npos);
  EXPECT_EQ(error_with("[uncompensated.xpc]", "[uncompensated.xcp]"),
            "lab.toml:19:1: [uncompensated] names node 'xcp', expected a node of the experiment");
}

TEST_F(ExperimentTest, HasTheCardsOfAReplicatedRingAndTheirFaultsInOrder) {
  const auto file = write("seed = 7",
                          "seed = 7\nfidelity = \"replicated\"\ncards = {fibre_m = 25}\n"
                          "[[fault]]\nat_s = 2\nkind = \"cut_fibre\"\nnode = \"opf\"\n"
                          "[[fault]]\nat_s = 1\nkind = \"bit_error_rate\"\nrate = 1e-6");

  const Experiment experiment = load_experiment(file);

  ASSERT_TRUE(experiment.cards);
  const auto cards =
      replicated::read_cards(experiment.cards->cards, experiment.cards->faults, {"opf"});
  EXPECT_EQ(cards.fibre_m, 25);
  EXPECT_EQ(cards.csr2, 0xC040U);
  ASSERT_EQ(cards.faults.size(), 2U);
  EXPECT_EQ(cards.faults[0].action.rate, 1e-6);
  EXPECT_EQ(cards.faults[1].node, "opf");
  EXPECT_EQ(cards.faults[1].action.at, replicated::from_ns(2e9));
}

TEST_F(ExperimentTest, SaysWhereItsRingOfCardsIsWrong) {
  EXPECT_EQ(error_with("seed = 7", "fidelity = \"exact\""),
            "lab.toml:5:12: fidelity is 'exact', expected shared or replicated");
  EXPECT_EQ(error_with("seed = 7", "cards = {fibre_m = 5}"),
            "lab.toml:5:9: found cards on a shared ring, expected fidelity = \"replicated\"");
  EXPECT_NE(
      error_with("seed = 7",
                 "fidelity = \"replicated\"\n"
                 "fault = [{at_s = 1, kind = \"power_off\", node = \"of\"}]")
          .find("'of' is no node (did you mean 'opf'?); the nodes are recorder, srmd, xpc, opf"),
      std::string::npos);
}

TEST_F(ExperimentTest, RefusesToTuneUnknownParameters) {
  EXPECT_EQ(error_with("tune.ats.enabled", "tune.ats.enable"),
            "node 'xpc' has no parameter 'ats.enable' (did you mean 'ats.enabled'?)");
}

TEST_F(ExperimentTest, RefusesANodeThatWritesAnothersWords) {
  EXPECT_EQ(error_with("[node.srmd]\nadapter = \"srmd\"", "[node.machine]\nadapter = \"srmd\""),
            "node 'machine' cannot write 'srmd.long.displ.ref_echo', which belongs to 'srmd'");
}

TEST_F(ExperimentTest, RefusesATuningOutsideItsRange) {
  EXPECT_EQ(error_with("tune.ats.enabled = 0", "tune.feed_forward.velocity_gain_s = 1e6"),
            "node 'xpc': feed_forward.velocity_gain_s is 1000000, expected 0 to 0.1");
}

// The run without compensation starts after the test; its parameters are checked before it.
TEST_F(ExperimentTest, RefusesUncompensatedParametersThatDoNotExist) {
  EXPECT_EQ(error_with("[uncompensated.xpc]\nats.enabled", "[uncompensated.xpc]\natz.enabled"),
            "[uncompensated]: node 'xpc' has no parameter 'atz.enabled' (did you mean "
            "'ats.enabled'?)");
}

TEST_F(ExperimentTest, FindsMistakesOfADiagramThatConcernTheMap) {
  const std::string controller = test::content_of(folder.path() / "controller.toml");
  const auto error_with_diagram = [&](const std::string& from, const std::string& to) {
    std::string text = controller;
    text.replace(text.find(from), from.size(), to);
    folder.write("controller.toml", text);
    return error_with("seed = 7", "seed = 7");
  };
  EXPECT_EQ(error_with_diagram("srmd.{axis}.accel.fbk", "srmd.{axis}.acel.fbk"),
            "controller.toml:28:1: block 'acceleration': the map has no signal "
            "'srmd.long.acel.fbk' (did you mean 'srmd.long.accel.fbk'?)");
  EXPECT_EQ(error_with_diagram("in.in = \"limits\"", "in.in = \"observer.force\""),
            "controller.toml:94:1: 'reference.in' takes [m], the unit of 'xpc.long.displ.ref', "
            "'observer.force' gives [N]");
}

TEST_F(ExperimentTest, FindsAScriptWhoseProgramIsMissing) {
  folder.write("model.py", "");
  EXPECT_EQ(error_with("adapter = \"numerical\"",
                       "adapter = \"opensees\"\nscript = \"model.py\"\n"
                       "python = \"no_such_python\"\nelement = [{ name = \"b\", port = 8090, "
                       "dofs = [\"long\", \"lat\"] }]"),
            "node 'opf': there is no program 'no_such_python' to run its script, expected one as "
            "its key python or as RTHS_OPENSEES_PYTHON");
}

TEST_F(ExperimentTest, TakesATextOfTheCommandLineWithoutQuotes) {
  EXPECT_EQ(load_experiment(write(), {{"name", "other"}}).name, "other");
  EXPECT_EQ(test::error_of([&] {
              static_cast<void>(load_experiment(write(), {{"duration_s", "long"}}));
            }),
            "--set duration_s: duration_s is a string, expected a number");
}

}  // namespace
}  // namespace rths::experiment
