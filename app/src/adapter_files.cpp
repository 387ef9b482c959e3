// SPDX-License-Identifier: Apache-2.0
#include <rths/app/adapter_files.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/adapters/safe_machine.hpp>
#include <rths/adapters/server_check.hpp>
#include <rths/adapters/simulink_like.hpp>
#include <rths/app/builtin_adapters.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/fmi/fmu_check.hpp>
#include <rths/plugin/conformance.hpp>
#include <rths/plugin/library.hpp>
#include <rths/plugin/plugin_adapter.hpp>
#include <rths/recording/roles.hpp>

namespace rths::app {
namespace {

// The built-in diagram with the most blocks of which the file has a table; empty if none has one.
std::filesystem::path diagram_with(const Config& constants) {
  std::filesystem::path found;
  std::ptrdiff_t most = 0;
  for (const auto& name : built_in_names("diagrams")) {
    const auto file = shared_files() / "diagrams" / (name + ".toml");
    const auto blocks = Config::load(file).tables("block");
    const auto shared = std::count_if(blocks.begin(), blocks.end(), [&](const auto& block) {
      return constants.is_table(block.text("name", ""));
    });
    if (shared <= most) continue;
    most = shared;
    found = file;
  }
  return found;
}

// The table of a node in the recorded experiment; empty if the node had another kind of adapter.
Config recorded_table(const recording::Reader& run, const std::string& node,
                      const std::string& kind) {
  const auto experiment = recording::experiment_in(run);
  if (!experiment) return {};
  const Config table = experiment->table_or_empty("node").table_or_empty(node);
  return table.text("adapter", "") == kind ? table : Config{};
}

LoadedAdapter load_plugin(const Substitute& substitute, const recording::Reader& run) {
  const Config config =
      substitute.config.empty()
          ? recorded_table(run, substitute.node, "plugin").table_or_empty("config")
          : Config::load(substitute.config);
  const auto loaded =
      plugin::plugin_file(std::filesystem::absolute(substitute.file), config.to_toml());
  plugin::PluginSettings settings;
  settings.library = loaded.library;
  settings.config = loaded.config;
  settings.title = loaded.title;
  settings.may_allocate = loaded.is_python;
  return {plugin::make_plugin(settings), 1};
}

// The steps of an FMU have one length, so it steps once per period.
LoadedAdapter load_fmu(const Substitute& substitute, const recording::Reader& run) {
  Config table = substitute.config.empty() ? recorded_table(run, substitute.node, "fmu")
                                           : Config::load(substitute.config);
  if (table.keys().empty())
    throw Error{
        fmt::format("node '{}' of the recording is not an FMU, expected --node of another "
                    "node, or --config with the table of a node",
                    substitute.node)};
  table.put("file", std::filesystem::absolute(substitute.file).string());
  if (!table.has("role")) table.put("role", std::string{"machine"});
  const experiment::Experiment setup;
  const auto kinds = builtin_adapters();
  const auto fmu = std::find_if(kinds.begin(), kinds.end(), [](const auto& kind) {
    return std::string_view{kind.name} == "fmu";
  });
  const auto settings = fmu->read(substitute.node, table, setup);
  const double period = table.number("period_s", to_seconds(settings.schedule.period));
  const auto& time = run.time();
  const double row = time.size() > 1 ? time[1] - time[0] : period;
  const double rows = std::round(period / row);
  constexpr double kSmallest = 1e-6;  // of a row
  if (rows < 1 || std::abs(period / row - rows) > kSmallest)
    throw Error{
        fmt::format("the FMU has steps of {:g} s, expected a multiple of the recording's "
                    "rows, {:g} s",
                    period, row)};
  const experiment::NodeContext context{
      substitute.node, from_seconds(period), true, {}, run.map(), {}, {}, {}, {}};
  return {settings.make(setup, context), static_cast<std::size_t>(rows)};
}

}  // namespace

bool is_adapter(const std::filesystem::path& path) {
  std::error_code problem;
  return fmi::is_fmu(path) || (std::filesystem::is_regular_file(path, problem) &&
                               (plugin::is_library(path) || path.extension() == ".py"));
}

Conformance check_adapter(const std::string& file, const std::string& config) {
  const Config table = config.empty() ? Config{} : Config::load(config);
  if (fmi::is_fmu(file)) return {"FMU", fmi::check_fmu(file, table)};
  plugin::ConformanceSettings settings;
  const auto loaded = plugin::plugin_file(file, config.empty() ? "" : table.to_toml());
  settings.config = loaded.config;
  settings.may_allocate = loaded.is_python;
  return {"plugin", plugin::check_plugin(loaded.library, settings)};
}

Conformance check_server(const std::string& word, const ServerArguments& arguments) {
  const auto& address = arguments.address;
  const auto colon = address.rfind(':');
  adapters::ServerCheck check;
  const char* end = address.data() + address.size();
  const auto [stop, error] = std::from_chars(address.data() + (colon + 1), end, check.port);
  if (word != "server" || colon == std::string::npos || error != std::errc{} || stop != end)
    throw Error{fmt::format("found {} {}, expected FILE or server HOST:PORT", word, address)};
  check.address = address.substr(0, colon);
  check.is_udp = arguments.udp;
  check.dofs = arguments.dofs;
  check.amplitude = arguments.amplitude;
  return {"server", adapters::check_server(check)};
}

std::string describe_diagram(const std::string& file) {
  const auto diagram = adapters::make_simulink_like(file, {});
  return fmt::format("{}: block diagram, {} ports, {:g} Hz", file, diagram->ports().size(),
                     1 / adapters::diagram_period(file));
}

std::string describe_limits(const std::string& file) {
  Config table;
  table.put("file", std::filesystem::absolute(file).string());
  experiment::Experiment setup;
  setup.axes = names_of(kHorizontal);
  static_cast<void>(adapters::with_safety({}, table, setup));
  return file + ": limits of a safety layer; [node.srmd.safety] file = names it";
}

// The table of each block replaces values of a diagram's block.
std::string describe_constants(const std::string& file, const Config& constants) {
  const auto diagram = diagram_with(constants);
  if (diagram.empty()) return "";
  adapters::DiagramContext context;
  context.constants = std::filesystem::absolute(file);
  static_cast<void>(adapters::make_simulink_like(diagram, context));
  return fmt::format("{}: constants of {} for the diagram '{}'", file,
                     fmt::join(constants.keys(), ", "), diagram.stem().string());
}

LoadedAdapter load_adapter(const Substitute& substitute, const recording::Reader& run) {
  return fmi::is_fmu(substitute.file) ? load_fmu(substitute, run) : load_plugin(substitute, run);
}

}  // namespace rths::app
