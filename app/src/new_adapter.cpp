// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <rths/command_line/write_file.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct NewAdapterArguments {
  std::string name;              ///< of the adapter and its folder
  std::string language = "c";    ///< c, cpp or python
  std::string role = "machine";  ///< or controller
};

using Words = std::vector<std::pair<std::string, std::string>>;

void check_name(const std::string& name) {
  const bool is_identifier = !name.empty() && !is_digit(name[0]) &&
                             std::all_of(name.begin(), name.end(),
                                         [](char c) { return is_letter_or_digit(c) || c == '_'; });
  if (!is_identifier)
    throw Error{fmt::format("the adapter's name is '{}', expected letters, digits and '_'", name)};
  if (std::filesystem::exists(name))
    throw Error{fmt::format("{}: exists, expected a new folder", name)};
}

/// A language of the templates: ending of their files.
struct Language {
  const char *ending, *name, *cmake;
};
constexpr std::array kLanguages{Language{"c", "C", "C"}, Language{"cpp", "C++", "CXX"},
                                Language{"py", "Python", ""}};

const Language& language_of(const std::string& name) {
  if (name == "c") return kLanguages[0];
  return name == "cpp" ? kLanguages[1] : kLanguages[2];
}

// A test under the template's own machine needs a model of its specimen: a spring.
constexpr const char* kSpring =
    "# The specimen of this machine: a spring.\n[specimen.bouc_wen]\n"
    "characteristic_strength_N = 0\npost_yield_stiffness_N_per_m = 5e6\n"
    "[specimen.lead_heating]\nenabled = false\n\n";

Words words_of(const NewAdapterArguments& arguments, const Language& language) {
  const bool is_machine = arguments.role == "machine";
  const bool is_python = *language.cmake == '\0';
  const auto& name = arguments.name;
  const std::string library = is_python ? name + ".py" : "build/" + name + ".so";
  return {{"@COMMANDS@", is_python ? "    rths check " + library + "\n    rths run experiment.toml"
                                   : "    cmake -B build && cmake --build build\n"
                                     "    ctest --test-dir build\n    rths run experiment.toml"},
          {"@NAME@", name},
          {"@ROLE@", arguments.role},
          {"@LANGUAGE@", language.cmake},
          {"@LANGUAGE_NAME@", language.name},
          {"@ENDING@", language.ending},
          {"@LIBRARY@", library},
          {"@SPECIMEN@", is_machine ? kSpring : ""},
          {"@NODE@", is_machine ? "srmd" : "xpc"},
          {"@OTHER@", is_machine ? "xpc" : "srmd"},
          {"@OTHER_ADAPTER@", is_machine
                                  ? "adapter = \"simulink_like\"\ndiagram = \"hybrid_controller\""
                                  : "adapter = \"srmd\""}};
}

std::string filled_in(std::string text, const Words& words) {
  for (const auto& [from, to] : words)
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
      text.replace(at, from.size(), to);
  return text;
}

int new_adapter(const NewAdapterArguments& arguments) {
  check_name(arguments.name);
  const auto templates = shared_files() / "templates" / "adapter";
  const std::filesystem::path folder = arguments.name;
  const Language& language = language_of(arguments.language);
  const std::string ending = std::string{"."} + language.ending;
  Words files{{arguments.role + ending, arguments.name + ending},
              {"experiment.toml.in", "experiment.toml"},
              {"README.md.in", "README.md"}};
  if (*language.cmake != '\0') files.emplace_back("CMakeLists.txt.in", "CMakeLists.txt");
  const Words words = words_of(arguments, language);
  std::filesystem::create_directory(folder);
  for (const auto& [from, to] : files)
    write_file(folder / to, filled_in(read_file(templates / from, kMostTextBytes), words));
  fmt::print("{}/: a {} in {}. README.md has the commands that test it\n", arguments.name,
             arguments.role, language.name);
  return kOk;
}

}  // namespace

void add_new(CommandLine& line) {
  auto* make = line.app.add_subcommand("new", "Make a folder to begin with");
  make->require_subcommand(1);
  auto [adapter, a] =
      line.add_to(*make, "adapter", "A plugin that builds, with its tests", new_adapter);
  adapter->add_option("name", a.name, "Name of the adapter and its folder")->required();
  adapter->add_option("--language", a.language)
      ->check(CLI::IsMember({"c", "cpp", "python"}))
      ->capture_default_str();
  adapter->add_option("--role", a.role)
      ->check(CLI::IsMember({"machine", "controller"}))
      ->capture_default_str();
}

}  // namespace rths::app
