// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/recording/table.hpp>
#include <rths/report/diagnosis.hpp>

#include "example_verdict.hpp"
#include "support/files.hpp"

namespace rths::report {
namespace {

using test_support::missing_verdict;
using test_support::none_verdict;
using test_support::unknown_verdict;

nlohmann::json parsed(const diagnosis::Verdict& verdict) {
  return nlohmann::json::parse(verdict_json(verdict));
}

TEST(VerdictJson, HasOneOfThreeOutcomes) {
  EXPECT_EQ(parsed(missing_verdict())["verdict"], "missing");
  EXPECT_EQ(parsed(none_verdict())["verdict"], "none");
  EXPECT_EQ(parsed(unknown_verdict())["verdict"], "unknown");
}

TEST(VerdictJson, HasTheSameKeysForEveryOutcome) {
  const auto missing = parsed(missing_verdict());
  for (const auto& other : {parsed(none_verdict()), parsed(diagnosis::Verdict{})}) {
    for (const auto& [key, value] : missing.items()) EXPECT_TRUE(other.contains(key)) << key;
    for (const auto& [key, value] : missing["where"].items())
      EXPECT_TRUE(other["where"].contains(key)) << key;
  }
}

TEST(VerdictJson, HoldsPlaceCauseAndProof) {
  const auto json = parsed(missing_verdict());

  EXPECT_EQ(json["format"], 1);
  EXPECT_EQ(json["where"]["part"], "machine");
  EXPECT_EQ(json["where"]["of"], "residual");
  const auto place = missing_verdict().conclusion.where;
  EXPECT_NEAR(json["where"]["intervals_s"][0][1], place.intervals[0].second, 1e-6);
  EXPECT_NEAR(json["where"]["band_Hz"].back()[1], place.bands.back().second, 1e-6);
  const auto& cause = json["causes"][0];
  EXPECT_EQ(cause["name"], "coulomb_friction");
  EXPECT_EQ(cause["explained_fraction"], 0.97);
  const auto& parameter = cause["parameters"]["coulomb_friction.friction_force"];
  EXPECT_EQ(parameter["value"], 41200);
  EXPECT_EQ(parameter["ci95"], nlohmann::json::parse("[40500, 41900]"));
  EXPECT_EQ(parameter["unit"], "N");
  EXPECT_EQ(cause["alternatives"][0]["sigma"], 218);
  EXPECT_EQ(json["fit"]["petrolia.csv"]["nrmse_before"], 0.091);
  EXPECT_EQ(json["fit"]["petrolia.csv"]["noise_floor"], 0.0061);
  EXPECT_EQ(json["refitted"]["bouc_wen.post_yield_stiffness"]["before"], 4.61e6);
  EXPECT_EQ(json["proof_record"], "petrolia.csv");
  EXPECT_EQ(json["residual_white"], true);
  EXPECT_EQ(json["evidence"][5]["ci90"], nlohmann::json::parse("[-0.04, 0.06]"));
}

TEST(VerdictJson, HoldsTheIntervalsOfTheImprovedResponse) {
  auto verdict = missing_verdict();
  EXPECT_TRUE(parsed(verdict)["improved_response"].is_null());
  verdict.bands = test_support::example_bands();

  const auto response = parsed(verdict)["improved_response"];

  EXPECT_EQ(response["peaks"][0]["name"], "displacement.long");
  EXPECT_EQ(response["peaks"][0]["value"], 0.2125);
  EXPECT_EQ(response["peaks"][1]["ci95"], nlohmann::json::parse("[1.88e6, 1.94e6]"));
  EXPECT_EQ(response["spectra"][0]["high"][1], 4.5);
  EXPECT_EQ(response["frequency_Hz"].size(), response["spectra"][0]["low"].size());
  EXPECT_EQ(response["runs"], 21);
  EXPECT_EQ(response["remainder_counted"], true);
}

TEST(VerdictJson, DescribesTheFormOfAnUnknownCause) {
  const auto form = parsed(unknown_verdict())["descriptions"][0];

  EXPECT_EQ(form["form"], "f(u)");
  EXPECT_EQ(form["x"].size(), form["y"].size());
  EXPECT_EQ(form["x"].size(), form["band"].size());
}

TEST(VerdictJson, TellsWhatEachRelationShows) {
  diagnosis::Verdict verdict = missing_verdict();
  verdict.relations = {{"motion to force",
                        {"force.long"},
                        diagnosis::Outcome::Missing,
                        true,
                        {"coulomb_friction"},
                        "f(v)",
                        true,
                        12.5,
                        {0.09, 0.006, std::nan(""), 0.99, false, false, false}}};

  const auto relation = parsed(verdict)["relations"][0];

  EXPECT_EQ(relation["name"], "motion to force");
  EXPECT_EQ(relation["outputs"][0], "force.long");
  EXPECT_EQ(relation["verdict"], "missing");
  EXPECT_EQ(relation["remainder"], true);
  EXPECT_EQ(relation["causes"][0], "coulomb_friction");
  EXPECT_EQ(relation["common_law"], "f(v)");
  EXPECT_EQ(relation["left_nat"], 12.5);
  EXPECT_EQ(relation["proof"]["nrmse_after"], 0.006);
  EXPECT_TRUE(relation["proof"]["noise_floor"].is_null());
}

TEST(VerdictJson, TellsGuessesFromCauses) {
  diagnosis::Verdict verdict = missing_verdict();
  diagnosis::Cause guess = verdict.conclusion.causes[0];
  guess.name = "quadratic_drag";
  guess.confidence = 0.49;
  verdict.conclusion.causes.push_back(guess);

  const auto json = parsed(verdict);

  ASSERT_EQ(json["causes"].size(), 1U);
  EXPECT_EQ(json["causes"][0]["name"], "coulomb_friction");
  ASSERT_EQ(json["guesses"].size(), 1U);
  EXPECT_EQ(json["guesses"][0]["name"], "quadratic_drag");
}

TEST(VerdictJson, HoldsWhatSpeaksForACause) {
  diagnosis::Verdict verdict = missing_verdict();
  auto& cause = verdict.conclusion.causes[0];
  cause.support = {310.5, 0.25, 0.75};
  cause.parameters[0].absent = 0;

  const auto told = parsed(verdict)["causes"][0];

  EXPECT_EQ(told["gain_nat"], 310.5);
  EXPECT_EQ(told["lead"], 0.25);
  EXPECT_EQ(told["best_share"], 0.75);
  EXPECT_EQ(told["parameters"]["coulomb_friction.friction_force"]["absent"], 0);
}

TEST(VerdictJson, HasNullForNanAndInfinity) {
  diagnosis::Verdict verdict = none_verdict();
  verdict.evaluation.fit[0].noise_floor = std::nan("");
  verdict.evaluation.fit[0].variance_after = std::numeric_limits<double>::infinity();

  const auto score = parsed(verdict)["fit"]["petrolia.csv"];

  EXPECT_TRUE(score["noise_floor"].is_null());
  EXPECT_TRUE(score["variance_after"].is_null());
  EXPECT_EQ(score["nrmse_after"], 0.0061);
}

TEST(VerdictJson, KeepsEightDigitsOfNumbersOfAnySize) {
  diagnosis::Verdict verdict = none_verdict();
  for (const double value : {1.2345678e-30, -6.2831853e-5, 0.1, 123456.78, 9.8765432e25}) {
    verdict.seconds = value * (1 + 1e-10);
    EXPECT_NEAR(parsed(verdict)["seconds"].get<double>() / value, 1, 1e-8) << value;
  }
  verdict.seconds = 0.1 + 0.2;  // 0.30000000000000004
  EXPECT_NE(verdict_json(verdict).find("\"seconds\": 0.3\n"), std::string::npos);
}

TEST(VerdictSummary, BeginsWithTheHeadline) {
  for (const auto& verdict : {missing_verdict(), none_verdict(), unknown_verdict()}) {
    const std::string text = verdict_summary(verdict);

    EXPECT_EQ(text.rfind(answers_of(verdict).headline + "\n", 0), 0U);
    EXPECT_NE(text.find("\n" + verdict.sentence + "\n"), std::string::npos);
  }
}

TEST(VerdictJson, HoldsTheHeadlineAndThreeAnswers) {
  const auto verdict = parsed(missing_verdict());
  const auto expected = answers_of(missing_verdict());

  EXPECT_EQ(verdict["headline"], expected.headline);
  EXPECT_EQ(verdict["answers"]["missing"], expected.missing);
  EXPECT_EQ(verdict["answers"]["certainty"], expected.certainty);
  EXPECT_EQ(verdict["answers"]["next"], expected.next);
  EXPECT_TRUE(verdict["specimen"].is_null());
}

TEST(VerdictSummary, ListsErrorsWithTheNoiseFloor) {
  const std::string text = verdict_summary(missing_verdict());

  EXPECT_NE(text.find("petrolia.csv    proof          9.1 %     0.63 %     0.61 %"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("or        load_dep_friction (97 % of the gain)"), std::string::npos);
}

// Seconds since 1970.
TEST(WriteDiagnosis, TellsTheInstantsOfAClockApart) {
  constexpr double kStart = 1.7e9;
  const test::TemporaryFolder folder;
  auto verdict = missing_verdict();
  for (auto& trace : verdict.evaluation.traces)
    for (double& time : trace.time) time += kStart;
  verdict.conclusion.where.record = verdict.evaluation.traces[0].record;
  verdict.conclusion.where.intervals = {{kStart + 2.25, kStart + 2.75}};

  const auto files = write_diagnosis(verdict, folder.path());

  EXPECT_NE(verdict_summary(verdict).find("; 1700000002.2 to 1700000002.8 s"), std::string::npos)
      << verdict_summary(verdict);
  const auto numbers = nlohmann::json::parse(test::content_of(files.numbers));
  EXPECT_EQ(numbers["where"]["intervals_s"][0][1], kStart + 2.75);
  const auto table = recording::Table::load(files.predictions[0]);
  const auto &written = table.column("time [s]"), &time = verdict.evaluation.traces[0].time;
  ASSERT_EQ(written.size(), time.size());
  for (std::size_t i = 0; i < time.size(); ++i) EXPECT_NEAR(written[i], time[i], 2e-3);
  const std::string page = verdict_page(verdict);
  EXPECT_NE(page.find("The times of this page begin at 17000000"), std::string::npos);
  EXPECT_NE(page.find("\"intervals_s\":[[2.2"), std::string::npos);
  EXPECT_EQ(verdict_page(missing_verdict()).find("The times of this page"), std::string::npos);
}

TEST(WriteDiagnosis, RemovesTheModelOfAnEarlierDiagnosis) {
  const test::TemporaryFolder folder;
  const auto out = folder.path() / "a/b";

  const auto first = write_diagnosis(missing_verdict(), out);
  EXPECT_FALSE(first.improved) << "the case has no file";
  ASSERT_TRUE(first.fragment);
  EXPECT_EQ(test::content_of(*first.fragment), missing_verdict().improvement.fragment);
  const auto second = write_diagnosis(none_verdict(), out);

  EXPECT_FALSE(second.fragment);
  EXPECT_FALSE(std::filesystem::exists(out / "improved.toml"));
  EXPECT_EQ(test::content_of(second.numbers), verdict_json(none_verdict()));
}

TEST(WriteDiagnosis, LeavesNoEmptyFolderOfAnEarlierDiagnosis) {
  const test::TemporaryFolder folder;
  for (const char* name : {"improved", "predictions"})
    std::filesystem::create_directory(folder.path() / name);
  folder.write("improved/case.toml", "");
  folder.write("predictions/mine.txt", "");
  auto verdict = none_verdict();
  verdict.evaluation.traces.clear();

  static_cast<void>(write_diagnosis(verdict, folder.path()));

  EXPECT_FALSE(std::filesystem::exists(folder.path() / "improved"));
  EXPECT_TRUE(std::filesystem::exists(folder.path() / "predictions/mine.txt"));
}

TEST(WriteDiagnosis, WritesATableOfPredictionsForEachRecord) {
  const test::TemporaryFolder folder;
  auto verdict = missing_verdict();
  verdict.evaluation.traces[1].record = "rig/northridge.csv";

  const auto files = write_diagnosis(verdict, folder.path());

  ASSERT_EQ(files.predictions.size(), 2U);
  EXPECT_EQ(files.predictions[0], folder.path() / "predictions/northridge.csv");
  EXPECT_EQ(files.predictions[1], folder.path() / "predictions/rig_northridge.csv");
  EXPECT_NE(test::content_of(files.predictions[0]).find("low-pass filter at 25 Hz"),
            std::string::npos);
  // The diagnosis reads its own tables.
  const auto table = recording::Table::load(files.predictions[0]);
  const auto& trace = verdict.evaluation.traces[0];
  const auto& measured = table.column("force.long measured [N]");
  const auto& after = table.column("force.long after [N]");
  const auto& residual = table.column("force.long residual [N]");
  ASSERT_EQ(measured.size(), trace.time.size());
  for (std::size_t i = 0; i < measured.size(); i += 100) {
    // Eight digits.
    EXPECT_NEAR(measured[i], trace.measured[i], 1e-7 * std::abs(trace.measured[i]) + 1e-300);
    EXPECT_NEAR(residual[i], measured[i] - after[i], 1e-7 * std::abs(measured[i]));
  }
  EXPECT_EQ(table.column("force.long noise [N]")[5], trace.noise[5]);

  verdict.evaluation.traces.pop_back();
  EXPECT_EQ(write_diagnosis(verdict, folder.path()).predictions.size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(files.predictions[1])) << "of an earlier diagnosis";
}

TEST(WriteDiagnosis, CutsTheFileNamesOfLongRecords) {
  const test::TemporaryFolder folder;
  auto verdict = missing_verdict();
  std::string start(199, 'a');
  verdict.evaluation.traces[0].record = start + "ééé" + std::string(1000, 'b');
  verdict.evaluation.traces[1].record = start + "ééé" + std::string(1000, 'c');

  const auto files = write_diagnosis(verdict, folder.path());

  ASSERT_EQ(files.predictions.size(), 2U);
  EXPECT_EQ(files.predictions[0], folder.path() / ("predictions/" + start + ".csv"));
  EXPECT_EQ(files.predictions[1], folder.path() / ("predictions/" + start + " (2).csv"));
  EXPECT_EQ(write_diagnosis(verdict, folder.path()).predictions, files.predictions);
}

TEST(WriteDiagnosis, KeepsTablesThatItHasNotWritten) {
  const test::TemporaryFolder folder;
  const auto verdict = missing_verdict();
  const auto first = write_diagnosis(verdict, folder.path());
  const auto& table = first.predictions.at(0);
  const auto numbered = table.parent_path() / (table.stem().string() + " (2).csv");
  std::filesystem::rename(table, table.parent_path() / "old.csv");
  folder.write("predictions/" + table.filename().string(), "mine");
  folder.write("predictions/mine.csv", "mine");
  folder.write("predictions/mine.part", "mine");
  std::filesystem::create_symlink("nowhere", table.parent_path() / "link.csv");

  const auto second = write_diagnosis(verdict, folder.path());

  EXPECT_EQ(second.predictions.at(0), numbered);
  for (const auto& file :
       {table, table.parent_path() / "mine.csv", table.parent_path() / "mine.part"})
    EXPECT_EQ(test::content_of(file), "mine") << file;
  EXPECT_TRUE(std::filesystem::is_symlink(table.parent_path() / "link.csv"));
  EXPECT_FALSE(std::filesystem::exists(table.parent_path() / "old.csv"));
  EXPECT_EQ(write_diagnosis(verdict, folder.path()).predictions.at(0), numbered);
}

TEST(WriteDiagnosis, WritesTheMotionOfTheNextTest) {
  const test::TemporaryFolder folder;
  auto verdict = missing_verdict();
  verdict.next.motion = {0.5, {{"displacement.long", {0, 0.25}}, {"vertical_force", {8e6, 9e6}}}};

  const auto first = write_diagnosis(verdict, folder.path());
  ASSERT_TRUE(first.motion);
  EXPECT_EQ(test::content_of(*first.motion),
            "time,displacement.long,vertical_force\n0,0,8000000\n0.5,0.25,9000000\n");
  const auto second = write_diagnosis(none_verdict(), folder.path());

  EXPECT_FALSE(second.motion);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "next_test.csv"));
}

// The last file finds no space.
TEST(WriteDiagnosis, KeepsAllEarlierFilesIfTheDiskIsFull) {
  const test::TemporaryFolder folder;
  const auto earlier = write_diagnosis(missing_verdict(), folder.path());
  const std::string page = test::content_of(earlier.page);
  auto verdict = none_verdict();
  verdict.next.motion = {0.5, {{"displacement.long", {0, 0.25}}}};
  std::filesystem::create_symlink("/dev/full", folder.path() / "next_test.csv.part");

  const auto message = test::error_of([&] { write_diagnosis(verdict, folder.path()); });

  EXPECT_EQ(message, (folder.path() / "next_test.csv").string() +
                         ": cannot be written: No space left on device");
  EXPECT_EQ(test::content_of(earlier.page), page);
  ASSERT_TRUE(earlier.fragment);
  EXPECT_TRUE(std::filesystem::exists(*earlier.fragment));
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder.path()})
    EXPECT_NE(entry.path().extension(), ".part") << entry.path();
}

TEST(WriteDiagnosis, NamesTheFolderItCannotWrite) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("taken", "");

  const auto message = test::error_of([&] { write_diagnosis(none_verdict(), file); });

  EXPECT_EQ(message.rfind(file.string() + ": cannot create the folder", 0), 0U) << message;
}

}  // namespace
}  // namespace rths::report
