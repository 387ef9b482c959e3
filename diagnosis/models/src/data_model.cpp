// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "dynamic_reading.hpp"
#include "foreign_reading.hpp"

namespace rths::diagnosis {
namespace {

std::string member_of(const std::string& role) {
  const auto dot = role.find('.');
  return dot == std::string::npos ? "" : role.substr(dot);
}

// Signals that may drive a term missing in the prediction of this output. These are the
// displacement along it if it was measured, otherwise all inputs, otherwise the prediction itself.
std::vector<std::string> drivers_of(const std::string& output, const Record& record) {
  const std::string along = "displacement" + member_of(output);
  if (output != along && record.find(along) != nullptr) return {along};
  std::vector<std::string> drivers;
  for (const auto& channel : record.channels)
    for (const std::string_view family : {"input.", "command.", "displacement."})
      if (channel.role.starts_with(family) && channel.role != output)
        drivers.push_back(channel.role);
  if (drivers.empty()) drivers.push_back(prediction_of(output));
  return drivers;
}

// A term added to a prediction, or at a port of the simulation, which is added to none.
struct AddedToOutput {
  std::optional<Index> output;
  Index displacement, velocity, acceleration;  // indices of the linear system's inputs
};

class DataReader {
 public:
  explicit DataReader(const Record& record) : record_{record} {
    for (const auto& channel : record.channels)
      if (is_predicted(channel.role)) add(channel.role.substr(kPredicted.size()));
  }

  DynamicModel model;
  std::vector<AddedToOutput> added;

 private:
  void add(const std::string& output) {
    if (record_.find(output) == nullptr)
      throw Error{fmt::format("{}: {} is predicted but was not recorded", record_.name, output)};
    model.outputs.push_back(output);
    const std::size_t index = model.outputs.size() - 1;
    // The prediction is the input with the output's index.
    model.inputs.insert(model.inputs.begin() + static_cast<std::ptrdiff_t>(index),
                        prediction_of(output));
  }

  Index plant_input(const std::string& role, int order) {
    auto found = std::find(model.inputs.begin(), model.inputs.end(), role);
    if (found == model.inputs.end()) found = model.inputs.insert(model.inputs.end(), role);
    model.plant_inputs.push_back({static_cast<std::size_t>(found - model.inputs.begin()), order});
    return static_cast<Index>(model.plant_inputs.size()) - 1;
  }

  // The measured rate; if there is none, the rate of the displacement.
  Index rate(const std::string& driver, const char* family, int order) {
    const std::string measured = family + member_of(driver);
    const bool is_there = driver.starts_with("displacement.") && record_.find(measured) != nullptr;
    return is_there ? plant_input(measured, 0) : plant_input(driver, order);
  }

 public:
  void add_drivers() {
    for (std::size_t i = 0; i < model.outputs.size(); ++i) model.plant_inputs.push_back({i, 0});
    for (std::size_t i = 0; i < model.outputs.size(); ++i) {
      const auto drivers = drivers_of(model.outputs[i], record_);
      for (const auto& driver : drivers) {
        added.push_back({static_cast<Index>(i), plant_input(driver, 0), rate(driver, "velocity", 1),
                         rate(driver, "acceleration", 2)});
        const std::string component = fmt::format("added.{}", added.size());
        model.connections.push_back({component,
                                     fmt::format("in {}, driven by {}", model.outputs[i], driver),
                                     drivers.size() == 1 ? model.outputs[i] : component,
                                     {},
                                     i});
      }
    }
  }

  void add_port(const ForeignPort& port) {
    const Index displacement = plant_input(port.displacement, 0);
    const Index velocity =
        port.velocity.empty() ? plant_input(port.displacement, 1) : plant_input(port.velocity, 0);
    added.push_back({std::nullopt, displacement, velocity, velocity});
    Connection connection{port.component, "at " + port.component, port.component, {}, {}};
    const auto like = std::find(model.inputs.begin(), model.inputs.end(), port.like.value_or(""));
    if (like != model.inputs.end())
      connection.like_input = static_cast<std::size_t>(like - model.inputs.begin());
    else
      connection.is_of_unit_mass = true;
    connection.is_port = true;
    model.connections.push_back(std::move(connection));
  }

 private:
  const Record& record_;
};

}  // namespace

DynamicModel read_data(const Config& table, const Record& record) {
  return read_predicted(table, record, {});
}

DynamicModel read_predicted(const Config& table, const Record& record, PredictedFrom from) {
  DataReader reader{record};
  if (reader.model.outputs.empty())
    throw Error{
        fmt::format("{}: a model of kind 'data' needs its prediction as a channel, as in "
                    "predicted.force.long",
                    record.name)};
  reader.add_drivers();
  for (const auto& role : from.inputs)
    if (!contains(reader.model.inputs, role)) reader.model.inputs.push_back(role);
  for (const auto& port : from.ports) reader.add_port(port);
  DynamicModel model = std::move(reader.model);
  model.name = "prediction to measurement";
  model.inputs_with_terms = std::move(from.inputs);
  model.parameters = std::move(from.parameters);
  const auto outputs = static_cast<Index>(model.outputs.size());
  const auto driving = static_cast<Index>(model.plant_inputs.size());
  model.linear = [added = reader.added, outputs, driving](const VectorXd&) {
    LinearSystem system =
        LinearSystem::zeros(0, driving, outputs, static_cast<Index>(added.size()));
    system.d.leftCols(outputs).setIdentity();
    for (Index i = 0; i < static_cast<Index>(added.size()); ++i) {
      const AddedToOutput& term = added[static_cast<std::size_t>(i)];
      system.q(i, term.displacement) = 1;
      system.s(i, term.velocity) = 1;
      if (!term.output) continue;  // no terms with a mass at a port
      system.t(i, term.acceleration) = 1;
      system.h(*term.output, i) = 1;
    }
    return system;
  };
  read_common(table, model);
  return model;
}

}  // namespace rths::diagnosis
