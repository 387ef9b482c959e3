// SPDX-License-Identifier: Apache-2.0
#include "composition_simulator.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "library.hpp"

namespace rths::diagnosis {
namespace {

// Copied at every step: that takes a fraction of the time of filling a struct with zeros.
constexpr sim::Quantities<double> kAllAtRest{};

double at(const VectorXd& signal, Index step) { return signal.size() > 0 ? signal[step] : 0; }

void load(const MotionDrive& drive, Index step, sim::Quantities<double>& q) {
  q.time = drive.start + static_cast<double>(step) * drive.model_step;
  for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
    q.displacement[axis] = at(drive.motion[axis], step);
    q.velocity[axis] = at(drive.rate[axis], step);
    q.acceleration[axis] = at(drive.second_rate[axis], step);
  }
  q.axial_load = at(drive.axial_load, step);
  q.temperature = at(drive.temperature, step);
  q.auxiliary = at(drive.auxiliary, step);
}

// Between two steps: the cubic through their displacements and velocities.
void load_between(const MotionDrive& drive, Index step, double share, sim::Quantities<double>& q) {
  load(drive, step, q);
  if (step == 0 || share >= 1) return;
  const double h = drive.model_step, s = share;
  q.time -= (1 - s) * h;
  for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
    if (drive.motion[axis].size() == 0) continue;
    const double from = drive.motion[axis][step - 1], to = drive.motion[axis][step];
    const double v0 = h * drive.rate[axis][step - 1], v1 = h * drive.rate[axis][step];
    const double rise = to - from;
    const double c2 = 3 * rise - 2 * v0 - v1, c3 = v0 + v1 - 2 * rise;
    q.displacement[axis] = from + s * (v0 + s * (c2 + s * c3));
    q.velocity[axis] = (v0 + s * (2 * c2 + s * 3 * c3)) / h;
    const double before = at(drive.second_rate[axis], step - 1);
    q.acceleration[axis] = before + s * (q.acceleration[axis] - before);
  }
}

// A specimen behind a spring is solved step by step, with its force of the step before.
bool is_mount(const ModelTerm& term) { return sim::has_trait(term.settings.kind, sim::kMount); }

bool is_vertical(const ModelTerm& term) {
  return sim::term_kind(term.settings.kind).stage == sim::Stage::Vertical;
}

bool is_after_specimen(const ModelTerm& term) {
  return sim::term_kind(term.settings.kind).stage > sim::Stage::Restoring;
}

}  // namespace

CompositionSimulator::CompositionSimulator(const Hypothesis& hypothesis, const MotionDrive& drive,
                                           Predicted predicted,
                                           const std::vector<std::size_t>& axes)
    : drive_{drive}, predicted_{predicted}, axes_{axes}, free_{hypothesis.free} {
  // A bearing's force costs far more time than the effect of the machine and the load cell on it.
  const bool splits = predicted == Predicted::Force &&
                      std::none_of(hypothesis.terms.begin(), hypothesis.terms.end(), is_vertical);
  std::array<std::vector<sim::TermSettings>, 2> terms;
  for (const auto& term : hypothesis.terms)
    terms[splits && is_after_specimen(term) ? 1 : 0].push_back(term.settings);
  for (const auto& term : terms[0])
    specimen_signature_ += fmt::format("{}/{}/{}/{} ", term.kind, term.name, term.axes,
                                       static_cast<int>(term.channel));
  constexpr int kSubstepsOfMounted = 2;
  if (std::any_of(hypothesis.terms.begin(), hypothesis.terms.end(), is_mount))
    substeps_ = kSubstepsOfMounted;
  compositions_[0] = sim::Composition{terms[0], drive.model_step / substeps_};
  compositions_[1] = sim::Composition{terms[1], drive.model_step};
  for (const auto& free : hypothesis.free) {
    const auto [meant, parameter] = meant_by(free.name, hypothesis.terms);
    indices_.emplace_back();
    for (const std::size_t i : meant) {
      const auto& term = hypothesis.terms[i];
      const std::size_t half = splits && is_after_specimen(term) ? 1 : 0;
      indices_.back().push_back(
          {half, compositions_[half].parameter_index(term.settings.name, parameter)});
    }
  }
}

void CompositionSimulator::run_first(const std::vector<double>& parameters, Axes& output) const {
  const Index steps = drive_.motion[axes_[0]].size();
  for (auto& axis : output) axis.resize(steps);
  std::vector<double> state(compositions_[0].states());
  for (Index step = 0; step < steps; ++step) {
    sim::Quantities<double> q;
    for (int substep = 1; substep <= substeps_; ++substep) {
      q = kAllAtRest;
      load_between(drive_, step, static_cast<double>(substep) / substeps_, q);
      if (predicted_ == Predicted::Displacement) {
        const Index before = std::max<Index>(0, step - 1);
        compositions_[0].set_specimen_force(
            state, {at(drive_.specimen_force[0], before), at(drive_.specimen_force[1], before)});
      }
      compositions_[0].advance(parameters, state, q);
    }
    const auto& result = predicted_ == Predicted::Force          ? q.force
                         : predicted_ == Predicted::Displacement ? q.displacement
                                                                 : q.acceleration;
    for (std::size_t axis = 0; axis < result.size(); ++axis) output[axis][step] = result[axis];
  }
}

std::shared_ptr<const CompositionSimulator::Specimen> CompositionSimulator::specimen(
    const std::vector<double>& parameters, const std::shared_ptr<const Specimen>& known) const {
  if (known && known->parameters == parameters) return known;
  Specimen found{parameters, {}};
  run_first(parameters, found.output);
  return std::make_shared<const Specimen>(std::move(found));
}

void CompositionSimulator::keep(const VectorXd& values) {
  kept_ = specimen(parameters_at(values)[0], kept_);
}

void CompositionSimulator::share(const Simulator& other) {
  const auto& alike = dynamic_cast<const CompositionSimulator&>(other);
  if (alike.specimen_signature_ == specimen_signature_) kept_ = alike.kept_;
}

void CompositionSimulator::run_second(const std::vector<double>& parameters, Axes& force) const {
  std::vector<double> state(compositions_[1].states());
  for (Index step = 0; step < force[0].size(); ++step) {
    sim::Quantities<double> q = kAllAtRest;
    load(drive_, step, q);
    q.force = {force[0][step], force[1][step]};
    compositions_[1].advance(parameters, state, q);
    for (std::size_t axis = 0; axis < force.size(); ++axis) force[axis][step] = q.force[axis];
  }
}

CompositionSimulator::Parameters CompositionSimulator::parameters_at(const VectorXd& values) const {
  Parameters parameters;
  for (std::size_t half = 0; half < 2; ++half)
    parameters[half].assign(compositions_[half].parameters().begin(),
                            compositions_[half].parameters().end());
  for (std::size_t i = 0; i < indices_.size(); ++i)
    for (const auto& [half, index] : indices_[i])
      parameters[half][index] = values[static_cast<Index>(i)];
  return parameters;
}

bool CompositionSimulator::predict(const Parameters& parameters, const Specimen& specimen,
                                   Eigen::Ref<MatrixXd> output) const {
  Axes all = specimen.output;
  if (!compositions_[1].terms().empty()) run_second(parameters[1], all);
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    if (!all[axes_[i]].allFinite()) return false;
    output.col(static_cast<Index>(i)) = all[axes_[i]];
  }
  return true;
}

// Differences take a fifth of the time of exact derivatives here: a step is mostly one rate
// equation. The effect of their error of 1e-4 on a fit is far below the noise.
bool CompositionSimulator::run(const VectorXd& values, const std::vector<Index>& wanted,
                               MatrixXd& prediction, std::vector<MatrixXd>& derivatives) const {
  derivatives.clear();
  const auto axes = static_cast<Index>(axes_.size());
  MatrixXd outputs(drive_.motion[axes_[0]].size(), axes * (1 + std::ssize(wanted)));
  const Parameters parameters = parameters_at(values);
  const auto there = specimen(parameters[0], kept_);
  if (!predict(parameters, *there, outputs.leftCols(axes))) return false;
  std::vector<double> steps;
  for (const Index i : wanted) {
    constexpr double kStep = 1e-4;  // of a parameter's scale
    const FreeParameter& free = free_[static_cast<std::size_t>(i)];
    VectorXd moved = values;
    steps.push_back((values[i] + kStep * free.scale > free.high ? -kStep : kStep) * free.scale);
    moved[i] += steps.back();
    const Parameters beside = parameters_at(moved);
    if (!predict(beside, *specimen(beside[0], there),
                 outputs.middleCols(axes * std::ssize(steps), axes)))
      return false;
  }
  const MatrixXd compared = drive_.compared_columns(outputs);
  prediction = compared.leftCols(axes);
  for (std::size_t i = 0; i < steps.size(); ++i)
    derivatives.push_back(
        (compared.middleCols(axes * (static_cast<Index>(i) + 1), axes) - prediction) / steps[i]);
  return true;
}

}  // namespace rths::diagnosis
