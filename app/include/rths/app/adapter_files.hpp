// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/finding.hpp>
#include <rths/core/config.hpp>
#include <rths/recording/recording.hpp>

namespace rths::app {

/// The rules of a kind of adapter, as one keeps or breaks them.
struct Conformance {
  std::string kind;  ///< "plugin", "FMU", "server"
  std::vector<adapters::Finding> findings;
};

/// Whether a path is a plugin, in a library or in Python, or an FMU.
[[nodiscard]] bool is_adapter(const std::filesystem::path& path);
/// Checks an adapter against the rules of its kind.
/// @param config  file with the `config` of a plugin, or of an FMU; empty: none
/// @throws Error if the adapter or the file cannot be read   @setup
[[nodiscard]] Conformance check_adapter(const std::string& file, const std::string& config);

/// A server for OpenSees' genericClient.
struct ServerArguments {
  std::string address;  ///< HOST:PORT
  bool udp = false;
  int dofs = 1;
  double amplitude = 0;  ///< of trials, in the server's units
};
/// Tries a server.
/// @param word  before the address   @throws Error if word or address is invalid   @setup
[[nodiscard]] Conformance check_server(const std::string& word, const ServerArguments& arguments);

/// Each checks a file that an adapter reads, and describes it in a line.
/// @throws Error with the place of the first wrong value   @setup
[[nodiscard]] std::string describe_diagram(const std::string& file);
[[nodiscard]] std::string describe_limits(const std::string& file);
/// Constants of the built-in diagram with the most blocks of which they have a table; empty if none
/// has one.
[[nodiscard]] std::string describe_constants(const std::string& file, const Config& constants);

/// A plugin or an FMU in the place of a recorded node.
struct Substitute {
  std::string file;
  std::string config;        ///< file with the `config` of a plugin, or the table of an FMU's node;
                             ///< empty: those of the recorded node
  std::string node = "xpc";  ///< whose monitors and parameters it has
};
/// An adapter, and the rows of the recording from one of its steps to the next.
struct LoadedAdapter {
  std::unique_ptr<adapters::Adapter> adapter;
  std::size_t rows_per_step = 1;
};
/// @throws Error if it cannot be loaded, or its steps are no multiple of the rows   @setup
[[nodiscard]] LoadedAdapter load_adapter(const Substitute& substitute,
                                         const recording::Reader& run);

}  // namespace rths::app
