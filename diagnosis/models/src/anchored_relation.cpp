// SPDX-License-Identifier: Apache-2.0
#include "anchored_relation.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::diagnosis {
namespace {

// Adds the anchor of a drive. Derivatives stay.
class AnchoredSimulator final : public Simulator {
 public:
  AnchoredSimulator(std::unique_ptr<Simulator> simulator, const MatrixXd& anchor)
      : simulator_{std::move(simulator)}, anchor_{anchor} {}

  bool run(const VectorXd& values, const std::vector<Index>& wanted, MatrixXd& prediction,
           std::vector<MatrixXd>& derivatives) const override {
    if (!simulator_->run(values, wanted, prediction, derivatives)) return false;
    prediction += anchor_;
    return true;
  }
  void keep(const VectorXd& values) override { simulator_->keep(values); }
  void share(const Simulator& other) override {
    simulator_->share(*dynamic_cast<const AnchoredSimulator&>(other).simulator_);
  }
  [[nodiscard]] int work_per_row() const override { return simulator_->work_per_row(); }

 private:
  std::unique_ptr<Simulator> simulator_;
  const MatrixXd& anchor_;  // rows × outputs
};

class AnchoredRelation final : public Relation {
 public:
  AnchoredRelation(std::unique_ptr<Relation> relation, std::vector<Index> outputs)
      : relation_{std::move(relation)}, anchored_{std::move(outputs)} {}

  const std::string& name() const override { return relation_->name(); }
  Part part() const override { return relation_->part(); }
  const std::vector<std::pair<std::string, std::string>>& outputs() const override {
    return relation_->outputs();
  }
  bool has_free_offsets() const override { return relation_->has_free_offsets(); }
  const Hypothesis& base() const override { return relation_->base(); }
  std::vector<Candidate> candidates(const Hypothesis& model) const override {
    return relation_->candidates(model);
  }
  std::vector<FreeForm> forms(const Hypothesis& model) const override {
    return relation_->forms(model);
  }
  bool runs_freely() const override { return relation_->runs_freely(); }
  std::vector<std::string> drivers() const override { return relation_->drivers(); }
  std::vector<std::string> notes() const override { return relation_->notes(); }

  std::unique_ptr<Drive> prepare(const Record& record) const override {
    auto drive = relation_->prepare(record);
    // The user's output is filtered and thinned as the measurement is.
    const auto of_user = relation_->prepare(with_outputs_of_user(record));
    MatrixXd stated;
    std::vector<MatrixXd> none;
    if (!relation_->simulator(base(), *drive)->run(base().values, {}, stated, none))
      throw Error{fmt::format("{}: the model as stated diverges", record.name)};
    drive->anchor = MatrixXd::Zero(stated.rows(), stated.cols());
    for (const Index i : anchored_) drive->anchor.col(i) = of_user->measured.col(i) - stated.col(i);
    return drive;
  }
  std::vector<std::unique_ptr<Drive>> disturbed(const Drive& drive,
                                                const Record& noise) const override {
    return relation_->disturbed(drive, noise);
  }
  std::unique_ptr<Simulator> simulator(const Hypothesis& hypothesis,
                                       const Drive& drive) const override {
    return std::make_unique<AnchoredSimulator>(relation_->simulator(hypothesis, drive),
                                               drive.anchor);
  }

 private:
  // The record with the user's outputs in place of the measured ones.
  Record with_outputs_of_user(const Record& record) const {
    Record result = record;
    for (const Index i : anchored_) {
      const std::string& role = outputs()[static_cast<std::size_t>(i)].first;
      const Channel* of_user = record.find(prediction_of(role));
      if (of_user == nullptr)
        throw Error{fmt::format("{}: has no channel {}, which anchors the model", record.name,
                                prediction_of(role))};
      for (auto& channel : result.channels)
        if (channel.role == role) channel.values = of_user->values;
    }
    return result;
  }

  std::unique_ptr<Relation> relation_;
  std::vector<Index> anchored_;  // outputs that the user's simulation predicts
};

std::vector<Index> anchored_outputs(const Relation& relation, const Case& c) {
  std::vector<Index> outputs;
  const auto records = moving_records(c);
  for (std::size_t i = 0; i < relation.outputs().size(); ++i) {
    const std::string role = prediction_of(relation.outputs()[i].first);
    if (std::any_of(records.begin(), records.end(),
                    [&](const Record* record) { return record->find(role) != nullptr; }))
      outputs.push_back(static_cast<Index>(i));
  }
  return outputs;
}

}  // namespace

std::unique_ptr<Relation> anchored(std::unique_ptr<Relation> relation, const Case& c) {
  if (!relation || is_prediction(c.model.kind)) return relation;
  auto outputs = anchored_outputs(*relation, c);
  if (outputs.empty()) return relation;
  return std::make_unique<AnchoredRelation>(std::move(relation), std::move(outputs));
}

}  // namespace rths::diagnosis
