// SPDX-License-Identifier: Apache-2.0
// The example cases of every kind of model: each verdict, and the synthetic recordings themselves.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <rths/recording/table.hpp>
#include <rths/verdict/diagnose.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/readable.hpp"

namespace rths::diagnosis {
namespace {

struct Example {
  std::string file, kind;           ///< in examples/diagnosis
  std::vector<std::string> causes;  ///< names of the first cause that are right
  double most_after;                ///< error on the record of the proof
};
void PrintTo(const Example& example, std::ostream* out) { *out << example.file; }

class ExampleCase : public ::testing::TestWithParam<Example> {};

TEST_P(ExampleCase, NamesItsMissingEffect) {
  const auto& [file, kind, causes, most_after] = GetParam();
  const Case c = load_case(test::source_tree() / "examples/diagnosis" / file);

  const Verdict verdict = diagnose(c);

  EXPECT_EQ(name_of(c.model.kind), kind);
  ASSERT_EQ(verdict.conclusion.outcome, Outcome::Missing) << verdict.sentence;
  const std::string& name = verdict.conclusion.causes[0].name;
  EXPECT_NE(std::find(causes.begin(), causes.end(), name), causes.end()) << verdict.sentence;
  EXPECT_LT(verdict.evaluation.fit.back().nrmse_after, most_after) << verdict.sentence;
  const Answers answers = answers_of(verdict);
  EXPECT_EQ(test::unreadable(answers.headline, {answers.missing, answers.certainty, answers.next}),
            "");
}

// Errors: 1.2 times the noise of synthetic records, about 1.2 times the measured value of others.
INSTANTIATE_TEST_SUITE_P(
    Of, ExampleCase,
    ::testing::Values(
        Example{"synthetic/bearing", "bearing", {"axial_load_strength"}, 6.4e-4},
        Example{"synthetic/masses", "mass_spring_damper", {"cubic_stiffness"}, 1.8e-3},
        Example{"synthetic/program", "program", {"saturation"}, 5e-3},
        Example{"synthetic/structure", "structure", {"coulomb_friction", "bouc_wen"}, 4.1e-3},
        Example{"mr_damper", "platen", {"current_dependent_friction"}, 0.13},
        Example{"actuator/linear.toml",
                "linear",
                {"actuator_delay", "actuator_bandwidth", "time_skew"},
                0.03},
        Example{"actuator/data.toml", "data", {"filter_lag"}, 0.046}));

// Of the largest value.
double largest_difference(const std::vector<double>& one, const std::vector<double>& other) {
  if (one.size() != other.size()) return 1;
  double most = 0, size = 1e-300;
  for (std::size_t i = 0; i < one.size(); ++i) {
    most = std::max(most, std::abs(one[i] - other[i]));
    size = std::max(size, std::abs(one[i]));
  }
  return most / size;
}

// The recordings are those that the script makes.
TEST(SyntheticExamples, AreReproduced) {
  const test::TemporaryFolder folder;
  const auto here = test::source_tree() / "examples/diagnosis/synthetic";

  const auto made = test::Running{{"/usr/bin/env", "python3", (here / "make.py").string(),
                                   folder.path().string()}}
                        .wait();

  ASSERT_EQ(made.exit_code, 0) << made.err;
  for (const char* system : {"bearing", "masses", "program", "structure"})
    for (const char* file : {"fit.csv", "held_out.csv"}) {
      const auto one = recording::Table::load(folder.path() / system / file).columns();
      const auto other = recording::Table::load(here / system / file).columns();
      ASSERT_EQ(one.size(), other.size());
      for (std::size_t i = 0; i < one.size(); ++i)
        // The files have seven digits; another mathematical library may round the last differently.
        EXPECT_LT(largest_difference(one[i].values, other[i].values), 2e-6)
            << system << "/" << file << ", " << one[i].name;
    }
}

}  // namespace
}  // namespace rths::diagnosis
