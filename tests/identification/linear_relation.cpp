// SPDX-License-Identifier: Apache-2.0
#include "identification/linear_relation.hpp"

#include <cmath>
#include <numbers>

namespace rths::diagnosis {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

class LinearDrive : public Drive {
 public:
  Inputs inputs;
};

class LinearSimulator : public Simulator {
 public:
  LinearSimulator(const LinearRelation& relation, const Hypothesis& hypothesis,
                  const LinearDrive& drive)
      : relation_{relation} {
    for (const auto& free : hypothesis.free) {
      const auto found = drive.inputs.find(free.name);
      signals_.push_back(found != drive.inputs.end()
                             ? found->second
                             : MatrixXd(MatrixXd::Zero(drive.rows(), drive.measured.cols())));
    }
    rest_ = MatrixXd::Zero(drive.rows(), drive.measured.cols());
  }
  bool run(const VectorXd& values, const std::vector<Index>& wanted, MatrixXd& prediction,
           std::vector<MatrixXd>& derivatives) const override {
    if (relation_.fail) relation_.fail();
    prediction = rest_;
    for (std::size_t i = 0; i < signals_.size(); ++i)
      prediction += values[static_cast<Index>(i)] * signals_[i];
    derivatives.clear();
    for (const Index i : wanted) derivatives.push_back(signals_[static_cast<std::size_t>(i)]);
    return relation_.has_prediction;
  }

 private:
  const LinearRelation& relation_;
  std::vector<MatrixXd> signals_;
  MatrixXd rest_;
};

}  // namespace

LinearRelation::LinearRelation(std::vector<std::string> units) : deviation(units.size(), 1.0) {
  for (std::size_t i = 0; i < units.size(); ++i)
    outputs_.emplace_back("output." + std::to_string(i), units[i]);
}

std::unique_ptr<Drive> LinearRelation::prepare(const Record& record) const {
  auto drive = std::make_unique<LinearDrive>();
  const auto rows = static_cast<Index>(record.samples()),
             outputs = static_cast<Index>(outputs_.size());
  drive->time_step = record.time_step;
  drive->measured = MatrixXd::Zero(rows, outputs);
  drive->first_row = static_cast<Index>(std::lround(record.settle / record.time_step));
  for (const auto& channel : record.channels) {
    const auto last = channel.role.rfind('.');
    const std::string family = channel.role.substr(0, channel.role.find('.'));
    if (channel.role == "auxiliary.displacement")
      drive->displacement = values_of(channel).replicate(1, outputs);
    if (channel.role == "auxiliary.velocity")
      drive->velocity = values_of(channel).replicate(1, outputs);
    if (family != "output" && family != "input") continue;
    const Index output = std::stol(channel.role.substr(last + 1));
    if (family == "output") {
      drive->measured.col(output) = values_of(channel);
      continue;
    }
    MatrixXd& input = drive->inputs[channel.role.substr(6, last - 6)];
    if (input.size() == 0) input = MatrixXd::Zero(rows, outputs);
    input.col(output) = values_of(channel);
  }
  if (!record.gaps.empty()) drive->present = Eigen::ArrayXd::Ones(rows);
  for (const auto& [from, to] : record.gaps)
    drive->present.segment(static_cast<Index>(from), static_cast<Index>(to - from)).setZero();
  return drive;
}

std::vector<std::unique_ptr<Drive>> LinearRelation::disturbed(const Drive& drive,
                                                              const Record& /*noise*/) const {
  std::vector<std::unique_ptr<Drive>> all;
  for (const double sign : {1.0, -1.0}) {
    auto one = std::make_unique<LinearDrive>(dynamic_cast<const LinearDrive&>(drive));
    for (Index row = 0; row < one->rows(); ++row)
      for (Index output = 0; output < one->measured.cols(); ++output)
        one->measured(row, output) +=
            sign *
            ((row % 2 == 0 ? 1 : -1) * deviation[static_cast<std::size_t>(output)] + offset_noise);
    for (auto& [parameter, signal] : one->inputs)
      for (Index row = 0; row < one->rows(); ++row)
        signal.row(row).array() += sign * (row % 4 < 2 ? 1 : -1) * motion_noise;
    all.push_back(std::move(one));
  }
  return all;
}

std::unique_ptr<Simulator> LinearRelation::simulator(const Hypothesis& hypothesis,
                                                     const Drive& drive) const {
  return std::make_unique<LinearSimulator>(*this, hypothesis,
                                           dynamic_cast<const LinearDrive&>(drive));
}

Record linear_record(const std::string& name, Use use, double time_step, const MatrixXd& measured,
                     const Inputs& inputs) {
  Record record;
  record.name = name;
  record.use = use;
  record.time_step = time_step;
  for (Index output = 0; output < measured.cols(); ++output) {
    const std::string number = std::to_string(output);
    const auto add = [&](const std::string& role, const VectorXd& values) {
      record.channels.push_back({role, "N", {values.begin(), values.end()}});
    };
    add("output." + number, measured.col(output));
    for (const auto& [parameter, signal] : inputs)
      add("input." + parameter + "." + number, signal.col(output));
  }
  return record;
}

Problem linear_problem(const LinearRelation& relation, const std::vector<Record>& records) {
  std::vector<const Record*> all;
  for (const auto& record : records) all.push_back(&record);
  return {relation, all, SensorNoise{all, {{"output.0", 1}}}, 1};
}

VectorXd sine_of(int cycles, Index rows) {
  VectorXd x(rows);
  for (Index i = 0; i < rows; ++i)
    x[i] = std::numbers::sqrt2 * std::sin(2 * std::numbers::pi * cycles * static_cast<double>(i) /
                                          static_cast<double>(rows));
  return x;
}

MatrixXd gauss(Index rows, Index outputs, unsigned seed) {
  std::mt19937 random{seed};
  std::normal_distribution<double> normal;
  return MatrixXd::NullaryExpr(rows, outputs, [&] { return normal(random); });
}

FreeParameter size_parameter(const std::string& name, double low, double high) {
  return {name, "N", low, high, 1, false, 0};
}

Candidate friction(const std::string& term, double low) {
  Candidate candidate;
  candidate.name = term;
  candidate.adds = {{{"viscous_friction", term, {}}, ""}};
  candidate.frees = {size_parameter(term + ".coefficient", low)};
  candidate.starts = {VectorXd::Zero(1)};
  candidate.price = 1;
  return candidate;
}

Hypothesis linear_model(const std::vector<std::string>& parameters,
                        const std::vector<double>& values) {
  Hypothesis model;
  for (const auto& parameter : parameters) model.free.push_back(size_parameter(parameter));
  model.values = VectorXd::Map(values.data(), static_cast<Index>(values.size()));
  return model;
}

Fold whole(const std::vector<std::size_t>& records) {
  Fold fold;
  for (const std::size_t record : records) fold.shares.push_back({record, {}});
  return fold;
}

Folds two_records() { return {whole({0}), whole({1}), whole({0, 1})}; }

}  // namespace rths::diagnosis
