// SPDX-License-Identifier: Apache-2.0
//
// Conformance of a plugin, of an FMU and of a server for OpenSees.
#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include <rths/adapters/server_check.hpp>
#include <rths/command_line/program.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/fmi/fmu_check.hpp>
#include <rths/plugin/conformance.hpp>
#include <rths/plugin/python_file.hpp>

#include "checks.hpp"

namespace rths::app {
namespace {

using adapters::Finding;

// One line per rule. Exit code 1 if a rule is broken.
int print_findings(const std::string& title, const std::vector<Finding>& findings) {
  using Outcome = Finding::Outcome;
  const auto count = [&](Outcome outcome) {
    return std::count_if(findings.begin(), findings.end(),
                         [&](const auto& finding) { return finding.outcome == outcome; });
  };
  for (const auto& [rule, outcome, text] : findings) {
    const char* word = outcome == Outcome::Pass ? "PASS" : "FAIL";
    if (outcome == Outcome::NotTried) word = "----";
    fmt::print("{}  {:<12} {}\n", word, rule, outcome == Outcome::NotTried ? "not tried" : text);
  }
  fmt::print("{}, {} of {} rules passed, {} failed, {} not tried\n", title, count(Outcome::Pass),
             findings.size(), count(Outcome::Fail), count(Outcome::NotTried));
  return count(Outcome::Fail) == 0 ? kOk : kConditionNotMet;
}

bool read_port(const char* begin, const char* end, std::uint16_t& port) {
  const auto [stop, error] = std::from_chars(begin, end, port);
  return error == std::errc{} && stop == end;
}

}  // namespace

int check_plugin(const std::string& file, const std::string& config) {
  const Interruptible interruptible;
  plugin::ConformanceSettings settings;
  const auto loaded =
      plugin::plugin_file(file, config.empty() ? "" : Config::load(config).to_toml());
  settings.config = loaded.config;
  settings.may_allocate = loaded.is_python;
  return print_findings(file + ": plugin", plugin::check_plugin(loaded.library, settings));
}

int check_fmu(const std::string& file, const std::string& config) {
  const Interruptible interruptible;
  const Config table = config.empty() ? Config{} : Config::load(config);
  return print_findings(file + ": FMU", fmi::check_fmu(file, table));
}

int check_server(const std::string& word, const ServerArguments& arguments) {
  const auto& address = arguments.address;
  const auto colon = address.rfind(':');
  adapters::ServerCheck check;
  const char* end = address.data() + address.size();
  if (word != "server" || colon == std::string::npos ||
      !read_port(address.data() + colon + 1, end, check.port))
    throw Error{fmt::format("found {} {}, expected FILE or server HOST:PORT", word, address)};
  check.address = address.substr(0, colon);
  check.is_udp = arguments.udp;
  check.dofs = arguments.dofs;
  check.amplitude = arguments.amplitude;
  return print_findings(address + ": server", adapters::check_server(check));
}

}  // namespace rths::app
