// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include <rths/adapters/adapter_runner.hpp>
#include <rths/core/config.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/fmi/fmu_node.hpp>
#include <rths/memmap/map.hpp>

namespace rths::test {

/// The signals that the lag is bound to.
inline constexpr const char* kLagSignals = R"(
[signals]
u = "ref.u"
y = "fbk.y"
enabled = "ref.enabled"
count = "fbk.count"
)";
/// The further input of the lag of FMI 3, as a table of start values.
inline constexpr const char* kLagStart3 = "[start]\nlevel = 0\n";

inline std::string lag_table(int version) {
  return std::string{kLagSignals} + (version == 3 ? kLagStart3 : "");
}

/// A node "mac" whose adapter is an FMU, on a map with a few words.
class BenchNode {
 public:
  memmap::Map map = memmap::parse_map(R"(
ringmap = 1
[ring]
name = "bench"
version = 1
size_bytes = 4096
[nodes]
ctl = 1
mac = 2
[[partition]]
name = "ref"
node = "ctl"
offset = 0
longwords = 4
[[partition.signal]]
name = "u"
offset = 0
type = "f32"
unit = "mm"
[[partition.signal]]
name = "enabled"
offset = 1
type = "u32"
unit = "1"
[[partition.signal]]
name = "level"
offset = 2
type = "i32"
unit = "1"
[[partition.signal]]
name = "force"
offset = 3
type = "f32"
unit = "kN"
[[partition]]
name = "fbk"
node = "mac"
offset = 16
longwords = 4
[[partition.signal]]
name = "y"
offset = 16
type = "f32"
unit = "m"
[[partition.signal]]
name = "count"
offset = 17
type = "u32"
unit = "1"
[[partition.signal]]
name = "single"
offset = 18
type = "f32"
unit = "inch"
[[partition.signal]]
name = "level_back"
offset = 19
type = "u32"
unit = "1"
)",
                                      "bench");

  /// Reads the table of a node, as an experiment does, and makes its adapter.
  /// @param keys  before the tables of the table
  [[nodiscard]] std::unique_ptr<adapters::Adapter> make(const std::filesystem::path& file,
                                                        const std::string& tables,
                                                        const std::string& keys = "",
                                                        double period = 0.001) const {
    const Config table = Config::parse(
        "file = \"" + file.string() + "\"\nrole = \"machine\"\n" + keys + tables, "node.toml");
    const experiment::Experiment setup;
    const auto settings = fmi::read_fmu("mac", table, setup);
    table.reject_unknown_keys();
    auto adapter =
        settings.make(setup, {"mac", from_seconds(period), true, {}, map, {}, {}, {}, {}});
    adapters::check_ports(lab_ports(*adapter), map, "mac");
    return adapter;
  }

 private:
  // Monitors and parameters are not in the map.
  static std::vector<adapters::Port> lab_ports(const adapters::Adapter& adapter) {
    auto ports = adapter.ports();
    std::erase_if(ports, [](const auto& port) {
      return port.direction == adapters::Direction::Monitor ||
             port.direction == adapters::Direction::Parameter;
    });
    return ports;
  }
};

}  // namespace rths::test
