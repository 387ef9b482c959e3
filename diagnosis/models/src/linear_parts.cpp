// SPDX-License-Identifier: Apache-2.0
#include "linear_parts.hpp"

#include <fmt/format.h>

#include <rths/maths/decompositions.hpp>

namespace rths::diagnosis {
namespace {

// A connection for terms from an output to an input, as a spring connects a mass to the ground. The
// terms act on the output and its rate; their force is subtracted from the input. An output with
// direct feedthrough has no such connection.
struct SpringFeedback {
  Index output, input;
};

// The spring that a constant output needs: 1/G(0), which is aₙ/bₘ of a transfer function. 0 of a
// system that does not rest at a constant input.
double static_stiffness(const SpringFeedback& feedback, bool is_sampled,
                        const LinearSystem& system) {
  const Index n = system.a.rows();
  const MatrixXd rate = is_sampled ? MatrixXd{system.a - MatrixXd::Identity(n, n)} : system.a;
  const maths::MinimumNormSolver factors{rate};
  if (factors.rank() < n) return 0;
  const double gain =
      -system.c.row(feedback.output).dot(factors.solve(system.b.col(feedback.input)));
  return gain != 0 ? 1 / gain : 0;
}

void connect(const std::vector<SpringFeedback>& feedbacks, double sampled_every,
             LinearSystem& system) {
  for (Index i = 0; i < static_cast<Index>(feedbacks.size()); ++i) {
    const auto& [output, input] = feedbacks[static_cast<std::size_t>(i)];
    const RowVectorXd c = system.c.row(output);
    system.p.row(i) = c;
    system.r.row(i) = c * system.a;
    system.s.row(i) = c * system.b;
    if (sampled_every > 0) {
      system.r.row(i) = (system.r.row(i) - c) / sampled_every;
      system.s.row(i) /= sampled_every;
    }
    system.e.col(i) = -system.b.col(input);
    system.stiffness[i] =
        static_stiffness(feedbacks[static_cast<std::size_t>(i)], sampled_every > 0, system);
  }
}

std::vector<SpringFeedback> feedbacks_of(DynamicModel& model, const LinearSystem& system) {
  constexpr std::size_t kMost = 4;
  std::vector<SpringFeedback> feedbacks;
  for (Index output = 0; output < system.c.rows(); ++output)
    for (Index input = 0; input < system.b.cols(); ++input) {
      const auto from = static_cast<std::size_t>(output), to = static_cast<std::size_t>(input);
      if ((system.d.row(output).array() != 0).any() || system.a.rows() == 0 ||
          feedbacks.size() == kMost)
        continue;
      feedbacks.push_back({output, input});
      const std::string component = fmt::format("feedback.{}", feedbacks.size());
      model.connections.push_back(
          {component,
           fmt::format("from {} back to {}", model.outputs[from], model.inputs[to]),
           system.b.cols() == 1 ? model.outputs[from] : component,
           to,
           {}});
    }
  return feedbacks;
}

}  // namespace

void finish_linear(const Config& table, const BareSystem& bare, DynamicModel& model) {
  for (std::size_t i = 0; i < model.inputs.size(); ++i) model.plant_inputs.push_back({i, 0});
  model.name = "input to output";
  model.sampled_every = table.number_in("time_step_s", 0, 1e9, 0.0);
  const auto feedbacks = feedbacks_of(model, bare(model.values(), 0));
  model.linear = [bare, feedbacks, every = model.sampled_every](const VectorXd& values) {
    LinearSystem system = bare(values, static_cast<Index>(feedbacks.size()));
    connect(feedbacks, every, system);
    return system;
  };
  read_common(table, model);
}

}  // namespace rths::diagnosis
