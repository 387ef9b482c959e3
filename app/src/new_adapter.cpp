// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>

#include "commands.hpp"
#include "write_file.hpp"

namespace rths::app {
namespace {

using Words = std::vector<std::pair<std::string, std::string>>;

constexpr const char* kRecord = "petrolia_1992_riodell_freefield.csv";

void check_name(const std::string& name) {
  const bool is_identifier =
      !name.empty() && std::isdigit(static_cast<unsigned char>(name[0])) == 0 &&
      std::all_of(name.begin(), name.end(),
                  [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  if (!is_identifier)
    throw Error{fmt::format("the adapter's name is '{}', expected letters, digits and '_'", name)};
  if (std::filesystem::exists(name))
    throw Error{fmt::format("{}: exists, expected a new folder", name)};
}

Words words_of(const NewAdapterArguments& arguments) {
  const bool is_machine = arguments.role == "machine";
  const bool is_c = arguments.language == "c";
  return {{"@NAME@", arguments.name},
          {"@ROLE@", arguments.role},
          {"@LANGUAGE@", is_c ? "C" : "CXX"},
          {"@ENDING@", arguments.language},
          {"@NODE@", is_machine ? "srmd" : "xpc"},
          {"@OTHER@", is_machine ? "xpc" : "srmd"},
          {"@OTHER_ADAPTER@", is_machine
                                  ? "adapter = \"simulink_like\"\ndiagram = \"hybrid_controller\""
                                  : "adapter = \"srmd\""},
          {"@RECORD@", (shared_files() / "examples" / "records" / kRecord).string()}};
}

std::string filled_in(std::string text, const Words& words) {
  for (const auto& [from, to] : words)
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  return text;
}

}  // namespace

int new_adapter(const NewAdapterArguments& arguments) {
  check_name(arguments.name);
  const auto templates = shared_files() / "templates" / "adapter";
  const std::filesystem::path folder = arguments.name;
  const std::string source = arguments.role + "." + arguments.language;
  const Words words = words_of(arguments);
  std::filesystem::create_directory(folder);
  for (const auto& [from, to] : Words{{source, arguments.name + "." + arguments.language},
                                      {"CMakeLists.txt.in", "CMakeLists.txt"},
                                      {"experiment.toml.in", "experiment.toml"},
                                      {"README.md.in", "README.md"}})
    write_file(folder / to, filled_in(read_file(templates / from, kMostTextBytes), words));
  fmt::print("{}/: a {} in {}. README.md has the commands that build and test it\n", arguments.name,
             arguments.role, arguments.language == "c" ? "C" : "C++");
  return kOk;
}

}  // namespace rths::app
