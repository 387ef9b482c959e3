// SPDX-License-Identifier: Apache-2.0
//
// A fit may fail because a model has no prediction. Any other exception is a bug of the program.
#include <stdexcept>

#include <gtest/gtest.h>

#include <rths/core/error.hpp>

#include "diagnosis/src/scores.hpp"

namespace rths::diagnosis {
namespace {

constexpr Eigen::Index kRows = 40;

/// Predicts a line of one slope, until it is told to fail.
class Line : public Simulator {
 public:
  explicit Line(const std::function<void()>& fail) : fail_{fail} {}
  bool run(const Eigen::VectorXd& values, const std::vector<Eigen::Index>& wanted,
           Eigen::MatrixXd& prediction, std::vector<Eigen::MatrixXd>& derivatives) const override {
    if (fail_) fail_();
    const Eigen::MatrixXd line = Eigen::VectorXd::LinSpaced(kRows, 0, 1);
    prediction = values[0] * line;
    derivatives.assign(wanted.size(), line);
    return true;
  }

 private:
  const std::function<void()>& fail_;
};

class LineRelation : public Relation {
 public:
  std::function<void()> fail;

  [[nodiscard]] const std::string& name() const override { return name_; }
  [[nodiscard]] Part part() const override { return Part::Structure; }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& outputs() const override {
    return outputs_;
  }
  [[nodiscard]] bool has_free_offsets() const override { return false; }
  [[nodiscard]] const Hypothesis& base() const override { return base_; }
  [[nodiscard]] std::vector<Candidate> candidates() const override { return {}; }
  [[nodiscard]] std::vector<std::string> drivers() const override { return {}; }
  [[nodiscard]] std::unique_ptr<Drive> prepare(const Record& record) const override {
    auto drive = std::make_unique<Drive>();
    drive->time_step = record.time_step;
    drive->measured = Eigen::Map<const Eigen::VectorXd>(record.channels[0].values.data(), kRows);
    return drive;
  }
  [[nodiscard]] std::vector<std::unique_ptr<Drive>> disturbed(const Drive& drive,
                                                              const Record&) const override {
    std::vector<std::unique_ptr<Drive>> one;
    one.push_back(std::make_unique<Drive>(drive));
    one[0]->measured.array() += 0.01;
    return one;
  }
  [[nodiscard]] std::unique_ptr<Simulator> simulator(const Hypothesis&,
                                                     const Drive&) const override {
    return std::make_unique<Line>(fail);
  }

 private:
  std::string name_ = "line";
  std::vector<std::pair<std::string, std::string>> outputs_{{"output.y", "m"}};
  Hypothesis base_{{}, {{"slope", "m", -10, 10, 1}}, Eigen::VectorXd::Ones(1)};
};

/// A line of slope 2, and the simulation's of slope 1.
class FailedFit : public ::testing::Test {
 protected:
  [[nodiscard]] static Record line() {
    Record record{"line", Use::Fit, 0, 0.1, 0, {{"output.y", "m", {}}}, std::nullopt};
    for (Eigen::Index i = 0; i < kRows; ++i)
      record.channels[0].values.push_back(2 * static_cast<double>(i) / (kRows - 1));
    return record;
  }
  [[nodiscard]] std::optional<Fit> fit() const {
    return fit_if_possible(problem, relation.base(), whole({0}), kShortFit);
  }

  const Record record = line();
  LineRelation relation;
  const SensorNoise noise{{&record}, {{"output.y", 0.01}}, {}};
  Problem problem{relation, {&record}, noise, 1};
};

TEST_F(FailedFit, IsAFitIfThereIsAPrediction) {
  const auto fitted = fit();

  ASSERT_TRUE(fitted);
  EXPECT_NEAR(fitted->parameters[0], 2, 1e-6);
}

TEST_F(FailedFit, IsNoneIfTheModelHasNoPrediction) {
  relation.fail = [] { throw Error{"it diverges"}; };

  EXPECT_FALSE(fit());
}

TEST_F(FailedFit, DoesNotHideABug) {
  relation.fail = [] { throw std::out_of_range{"an index"}; };

  EXPECT_THROW(static_cast<void>(fit()), std::out_of_range);
}

}  // namespace
}  // namespace rths::diagnosis
