// SPDX-License-Identifier: Apache-2.0
#include <rths/command_line/program.hpp>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/message.hpp>
#include <rths/core/text.hpp>

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

/// Checks that the first words name commands, which CLI11 reports less clearly.
/// @throws Error naming the commands that exist
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

/// Candidates for the last of these words, which may be incomplete; for the shell.
/// @param words  without the program's name
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

/// The manual page of all commands, in the format of man(7). It is named as the program, with
/// hyphens.
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

/// Makes options with a number refuse nan. A range accepts it, because no comparison excludes it.
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

int failed(const std::string& name, const std::string& text, ExitCode code) {
  write_message(fmt::format("{}: {}\n", name, text));
  return code;
}

// A closed standard stream would get the number of the next file that is opened, which messages
// would then overwrite.
void open_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) < 0)  // NOLINT(cppcoreguidelines-pro-type-vararg)
      // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
      static_cast<void>(open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY));
}

// Why a command ended that could not write its results to standard output, or failed otherwise.
std::string reason_of(const std::exception& error) {
  const auto* system = dynamic_cast<const std::system_error*>(&error);
  if (system == nullptr || std::ferror(stdout) == 0) return error.what();
  return "standard output cannot be written: " + system->code().message();
}

// The exit code of a command whose standard output may be lost: a full disk.
int with_output(const std::string& name, int code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  const std::string reason = std::strerror(errno);
  failed(name, "standard output cannot be written: " + reason, kFailure);
  return code == kOk ? kFailure : code;
}

// For the shell's completion and for the installation; not in the help.
std::optional<int> run_hidden(const Program& program, const std::vector<std::string>& words) {
  if (words.empty() || (words[0] != "complete" && words[0] != "manual")) return std::nullopt;
  if (words[0] == "manual")
    fmt::print("{}", manual_page(program.commands, program.version));
  else
    fmt::print("{}\n", fmt::join(completions(program, {words.begin() + 1, words.end()}), "\n"));
  return kOk;
}

// The help of the innermost command that was given.
std::string usage_hint(const CLI::App& app) {
  std::string command = app.get_name();
  for (const auto* inner = &app; !inner->get_subcommands().empty();) {
    inner = inner->get_subcommands().front();
    command += " " + inner->get_name();
  }
  return fmt::format("; see {} --help", command);
}

}  // namespace

int run(const Program& program, int argc, char** argv) {
  CLI::App& app = program.commands;
  refuse_nan(app);
  const std::vector<std::string> words{argv + 1, argv + argc};
  if (const auto result = run_hidden(program, words)) return *result;
  try {
    check_command_names(app, words);
    app.parse(argc, argv);
  } catch (const Error& error) {
    return failed(app.get_name(), error.what(), kUsage);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // help or version
    return failed(app.get_name(), printable(error.what()) + usage_hint(app), kUsage);
  }
  return program.chosen();
}

int guarded(const std::string& name, const std::function<int()>& work) {
  try {
    open_standard_streams();
    return with_output(name, work());
  } catch (const Interrupted& interrupted) {
    return failed(name, interrupted.what(), kConditionNotMet);
  } catch (const Error& error) {
    return failed(name, error.what(), kFailure);
  } catch (const std::filesystem::filesystem_error& error) {
    return failed(name, printable(error.path1().string() + ": " + error.code().message()),
                  kFailure);
  } catch (const std::exception& error) {
    return failed(name, printable(reason_of(error)), kFailure);
  }
}

}  // namespace rths::app
