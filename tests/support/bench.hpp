// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>

namespace rths::test {

/// Runs an adapter without a ring; inputs and outputs are accessed by name.
class Bench {
 public:
  explicit Bench(adapters::Adapter& adapter) : adapter_{adapter} {
    for (const auto& port : adapter.ports()) {
      const bool is_input = port.direction == adapters::Direction::Input ||
                            port.direction == adapters::Direction::Parameter;
      auto& values = is_input ? inputs_ : outputs_;
      (is_input ? input_at_ : output_at_)[port.name] = values.size();
      values.push_back(port.initial);
    }
    step_.inputs = inputs_;
    step_.outputs = outputs_;
  }

  /// Input or parameter of this name.
  double& in(const std::string& name) { return inputs_.at(input_at_.at(name)); }
  /// Output or monitor of this name.
  [[nodiscard]] double out(const std::string& name) const {
    return outputs_.at(output_at_.at(name));
  }
  [[nodiscard]] const std::vector<double>& outputs() const { return outputs_; }
  void fill_inputs(double value) { inputs_.assign(inputs_.size(), value); }

  /// Age of the inputs in all further steps [s].
  void set_age(double age) { step_.age = age; }
  Status step(double time, bool stopping = false) {
    step_.time = time;
    step_.stopping = stopping;
    return adapter_.step(step_);
  }
  [[nodiscard]] const char* message() const { return step_.message; }

 private:
  adapters::Adapter& adapter_;
  std::map<std::string, std::size_t> input_at_, output_at_;
  std::vector<double> inputs_, outputs_;
  adapters::StepData step_;
};

}  // namespace rths::test
