// SPDX-License-Identifier: Apache-2.0
#include <rths/fmi/fmu_node.hpp>

#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/plugin/plugin_node.hpp>

#include <rths/fmi/fmu_files.hpp>
#include "bindings.hpp"
#include "fmu_config.hpp"

namespace rths::fmi {
namespace {

using adapters::Adapter;
using adapters::Port;
using adapters::StepData;
using namespace experiment;

constexpr double kShortestPeriod = 1e-5, kLongestPeriod = 1;  // of a node [s]

/// An adapter, and the files that its FMU needs while it lives.
class FmuAdapter final : public Adapter {
 public:
  FmuAdapter(std::unique_ptr<FmuFiles> files, std::unique_ptr<Adapter> adapter)
      : files_{std::move(files)}, adapter_{std::move(adapter)} {}

  [[nodiscard]] std::vector<Port> ports() const override { return adapter_->ports(); }
  void activate() override { adapter_->activate(); }
  [[nodiscard]] Status step(StepData& step) noexcept override { return adapter_->step(step); }
  void deactivate() override { adapter_->deactivate(); }

 private:
  std::unique_ptr<FmuFiles> files_;
  std::unique_ptr<Adapter> adapter_;  ///< last, because it uses the files
};

std::unique_ptr<Adapter> make(const std::filesystem::path& file, const Config& table,
                              const plugin::Hosting& hosting, const Experiment& setup,
                              const NodeContext& context) {
  try {
    const ModelDescription description = read_description(file);
    auto files = std::make_unique<FmuFiles>(file);
    const auto is_signal = [&](const std::string& name) {
      return context.map.find_signal(name).has_value();
    };
    const Config complete = with_names(description, table, is_signal);
    static_cast<void>(read_bindings(description, complete, true));
    plugin::PluginSettings settings;
    settings.library = file;
    settings.built_in = &fmu_adapter();
    settings.config = config_of(description, complete,
                                {files->folder(), context.node, to_seconds(context.period)});
    return std::make_unique<FmuAdapter>(std::move(files),
                                        make_hosted(settings, hosting, setup, context));
  } catch (const Error& error) {
    throw Error{fmt::format("node '{}': {}", context.node, error.what())};
  }
}

// Of an unpacked FMU, the file is its library.
Config identity(const std::filesystem::path& file, const ModelDescription& description) {
  Config identity = plugin::identity_of(
      std::filesystem::is_directory(file) ? library_in(file, description) : file);
  identity.put("model", description.name);
  identity.put("fmi", description.version_text);
  identity.put(description.version == 2 ? "guid" : "instantiation_token", description.token);
  return identity;
}

}  // namespace

std::string config_of(const ModelDescription& description, Config table, const InstancePlan& plan) {
  constexpr double kSmallest = 1e-9;  // of what an experiment states [s]
  if (const auto fixed = description.fixed_step) {
    const double count = std::round(plan.period / *fixed);
    if (count < 1 || std::abs(count * *fixed - plan.period) > kSmallest)
      throw Error{
          fmt::format("period_s is {:g}, expected a multiple of the FMU's fixed step, "
                      "{:g} s (fixedInternalStepSize)",
                      plan.period, *fixed)};
  }
  table.put("folder", plan.folder.string());
  table.put("instance", plan.instance);
  table.put("step_s", plan.period);
  return table.to_toml();
}

NodeSettings read_fmu(const std::string& node, const Config& table, const Experiment& /*setup*/) {
  const std::filesystem::path file = table.resolve(table.text("file"));
  if (!std::filesystem::exists(file))
    table.fail("file", fmt::format("file is '{}', expected an FMU", file.string()));
  NodeSettings settings = plugin::read_role(table);
  const plugin::Hosting hosting = plugin::read_hosting(table);
  static_cast<void>(table.flag("log", false));
  const auto description = read_description(file);
  static_cast<void>(read_bindings(description, table, false));
  settings.texts = [=] {
    return std::vector{std::pair{node + ".fmu", identity(file, description).to_toml()}};
  };
  const auto step =
      description.preferred_step ? description.preferred_step : description.fixed_step;
  if (step && *step >= kShortestPeriod && *step <= kLongestPeriod)
    settings.schedule.period = from_seconds(*step);
  settings.make = [=](const Experiment& test, const NodeContext& context) {
    return make(file, table, hosting, test, context);
  };
  return settings;
}

}  // namespace rths::fmi
