// SPDX-License-Identifier: Apache-2.0
#include "command_line.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <rths/core/ascii.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>

namespace rths::app {
namespace {

using Words = std::vector<std::string>;

// Commands and options without a group are hidden.
std::vector<const CLI::App*> commands_of(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App* command) { return !command->get_group().empty(); });
}

std::vector<const CLI::Option*> options_of(const CLI::App& app) {
  return app.get_options([](const CLI::Option* option) { return !option->get_group().empty(); });
}

Words names_of(const std::vector<const CLI::App*>& commands) {
  Words names;
  for (const auto* command : commands) names.push_back(command->get_name());
  return names;
}

const CLI::App* command_named(const CLI::App& app, const std::string& name) {
  const auto all = app.get_subcommands([](const CLI::App*) { return true; });
  const auto found = std::find_if(
      all.begin(), all.end(), [&](const CLI::App* command) { return command->get_name() == name; });
  return found == all.end() ? nullptr : *found;
}

// "wall", "virtual" of "TEXT:{wall,virtual}".
Words choices_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{');
  const auto close = type.find('}', open);
  if (close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

// @param source  first positional word; empty: none yet
Words candidates_for(const Program& program, const CLI::Option& option, const std::string& source) {
  Words candidates = choices_of(option);
  if (!candidates.empty() || !program.candidates) return candidates;
  return program.candidates(option.get_name(), source);
}

// The option whose value follows `word`.
const CLI::Option* option_with_value(const CLI::App& app, const std::string& word) {
  for (const auto* option : options_of(app))
    if (word.size() > 1 && word[0] == '-' && option->check_name(word) &&
        option->get_expected_min() > 0 && option->get_type_size() > 0)
      return option;
  return nullptr;
}

const CLI::Option* positional(const CLI::App& app, std::size_t index) {
  std::size_t found = 0;
  const CLI::Option* last = nullptr;
  for (const auto* option : options_of(app)) {
    if (!option->get_positional()) continue;
    if (found++ == index) return option;
    last = option;
  }
  return last != nullptr && last->get_expected_max() > 1 ? last : nullptr;
}

Words option_names(const CLI::App& app) {
  Words names;
  for (const auto* option : options_of(app)) {
    for (const auto& name : option->get_lnames()) names.push_back("--" + name);
    for (const auto& name : option->get_snames()) names.push_back("-" + name);
  }
  return names;
}

// The backslash and a leading dot or quote have a meaning in man(7).
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '\\' || c == '-') result += '\\';
    result += c;
  }
  return !result.empty() && (result[0] == '.' || result[0] == '\'') ? "\\&" + result : result;
}

std::string manual_of_option(const CLI::Option& option) {
  std::string title = option.get_positional() ? option.get_name() : option.get_name(false, true);
  const Words choices = choices_of(option);
  title = title.substr(0, title.find('{'));  // of a flag: "--no-diagnosis{false}"
  constexpr std::size_t kMostChoices = 6;    // on one line
  if (!choices.empty() && choices.size() <= kMostChoices)
    title += fmt::format(" {}", fmt::join(choices, "|"));
  return fmt::format(
      ".TP\n.B {}\n{}\n", escaped(title),
      option.get_description().empty() ? "Value." : escaped(option.get_description()));
}

std::string manual_of_command(const CLI::App& command, const std::string& path) {
  std::string usage, options;
  for (const auto* option : options_of(command)) {
    if (option->get_name() == "--help" || option->get_name(false, true) == "-h,--help") continue;
    if (option->get_positional())
      usage += option->get_required() ? " " + option->get_name() : " [" + option->get_name() + "]";
    options += manual_of_option(*option);
  }
  std::string text = fmt::format(".SS {}\n{}.\n{}", escaped(path + usage),
                                 escaped(command.get_description()), options);
  for (const auto* inner : commands_of(command))
    text += manual_of_command(*inner, path + " " + inner->get_name());
  return text;
}

}  // namespace

void check_command_names(const CLI::App& app, const Words& words) {
  const CLI::App* command = &app;
  for (const auto& word : words) {
    const auto inner = commands_of(*command);
    if (inner.empty() || word.empty() || word[0] == '-') return;
    command = command_named(*command, word);
    if (command == nullptr)
      throw Error{fmt::format("there is no command '{}'{}, expected one of: {}", word,
                              did_you_mean(word, names_of(inner)),
                              fmt::join(names_of(inner), ", "))};
  }
}

Words completions(const Program& program, const Words& words) {
  if (words.empty()) return {};
  const CLI::App* command = &program.commands;
  std::size_t positionals = 0;
  std::string source;
  const CLI::Option* value_of = nullptr;
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const bool is_value = value_of != nullptr;
    value_of = is_value ? nullptr : option_with_value(*command, words[i]);
    if (is_value || words[i].rfind('-', 0) == 0) continue;
    if (const auto* inner = command_named(*command, words[i])) {
      command = inner;
    } else {
      if (positionals++ == 0) source = words[i];
    }
  }
  Words candidates;
  if (value_of != nullptr) {
    candidates = candidates_for(program, *value_of, source);
  } else if (words.back().rfind('-', 0) == 0) {
    candidates = option_names(*command);
  } else if (!commands_of(*command).empty()) {
    candidates = names_of(commands_of(*command));
  } else if (const auto* option = positional(*command, positionals)) {
    candidates = candidates_for(program, *option, source);
  }
  candidates.erase(std::remove_if(candidates.begin(), candidates.end(),
                                  [&](const std::string& candidate) {
                                    return candidate.rfind(words.back(), 0) != 0;
                                  }),
                   candidates.end());
  return candidates;
}

std::string manual_page(const CLI::App& app, const std::string& version) {
  const std::string command_line = app.get_name();
  std::string commands, title, page = command_line;
  for (const auto* command : commands_of(app))
    commands += manual_of_command(*command, command_line + " " + command->get_name());
  std::replace(page.begin(), page.end(), ' ', '-');
  for (const char c : page) title += upper(c);
  return fmt::format(
      ".TH {0} 1 \"\" \"rths {1}\" \"User Commands\"\n.SH NAME\n{2} \\- {3}\n.SH SYNOPSIS\n.B "
      "{4}\n"
      ".I command\n[options]\n.SH COMMANDS\n{5}"
      ".SH EXIT STATUS\n0: success. 1: condition not met. 2: failure. 3: wrong usage.\n",
      title, version, escaped(page), escaped(app.get_description()), command_line, commands);
}

void refuse_nan(CLI::App& app) {
  const CLI::Validator number{[](std::string& text) {
                                double value = 0;
                                return CLI::detail::lexical_cast(text, value) && std::isnan(value)
                                           ? "Value " + text + " is not a number"
                                           : std::string{};
                              },
                              ""};
  for (auto* option : app.get_options())
    if (option->get_type_name().starts_with("FLOAT")) option->check(number);
  for (auto* command : app.get_subcommands([](const CLI::App*) { return true; }))
    refuse_nan(*command);
}

}  // namespace rths::app
