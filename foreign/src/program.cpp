// SPDX-License-Identifier: Apache-2.0
#include <rths/foreign/program.hpp>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <mutex>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/text.hpp>

#include "child.hpp"
#include "run_table.hpp"
#include "warm_python.hpp"

namespace rths::foreign {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInputs = "inputs.csv";
constexpr const char* kOutputs = "outputs.csv";
constexpr const char* kParameters = "parameters.toml";
constexpr const char* kMotion = "motion.txt";

std::string program_of(const std::string& name, const fs::path& folder) {
  if (name.find('/') == std::string::npos) {
    if (const auto file = found_in_path(name)) return fs::absolute(*file).string();
    throw Error{fmt::format("there is no program '{}' on PATH", name)};
  }
  const fs::path file = fs::absolute(folder / name).lexically_normal();
  std::error_code ignored;
  if (!fs::is_regular_file(file, ignored)) throw Error{file.string() + " is not a file"};
  if (access(file.c_str(), X_OK) != 0) throw Error{file.string() + " cannot be executed"};
  return file.string();
}

class ProgramSimulation final : public Simulation {
 public:
  explicit ProgramSimulation(ProgramSettings settings) : settings_{std::move(settings)} {
    auto& command = settings_.command;
    if (command.empty()) throw Error{"the command is empty, expected a program and arguments"};
    command[0] = program_of(command[0], settings_.folder);
    for (std::size_t i = 1; i < command.size(); ++i) {
      std::error_code ignored;
      const fs::path file = fs::absolute(settings_.folder / command[i]).lexically_normal();
      if (!command[i].empty() && fs::is_regular_file(file, ignored)) command[i] = file.string();
      check_placeholders(command[i]);
    }
    if (!settings_.python_script.empty())
      warm_ = std::make_unique<WarmPython>(command[0], settings_.python_script.string());
  }

  RunOutputs run(const RunInputs& inputs) const override {
    if (!warm_ || !trusts_warm_runs()) {
      RunOutputs results = run_by(&ProgramSimulation::start, inputs);
      remember(inputs, results);
      return results;
    }
    return run_by(&ProgramSimulation::start_warm, inputs);
  }

 private:
  using Start = ChildEnding (ProgramSimulation::*)(const std::vector<std::string>&,
                                                   const fs::path&) const;

  [[nodiscard]] ChildEnding start(const std::vector<std::string>& command,
                                  const fs::path& folder) const {
    return run_child(command, folder, settings_.deadline);
  }
  [[nodiscard]] ChildEnding start_warm(const std::vector<std::string>& command,
                                       const fs::path& folder) const {
    const std::vector<std::string> arguments{command.begin() + 1, command.end()};
    const auto ending = warm_->run(arguments, folder, settings_.deadline);
    return ending ? *ending : start(command, folder);
  }

  // Whether a run of a warm interpreter has returned the bytes of the first run that had outputs.
  // The two first ones start anew, so that a difference between them is seen.
  [[nodiscard]] bool trusts_warm_runs() const {
    const std::lock_guard lock{mutex_};
    if (cold_runs_ < 2 || !known_) return false;
    if (!is_warm_trusted_)
      is_warm_trusted_ =
          run_by(&ProgramSimulation::start_warm, known_->first).outputs == known_->second.outputs;
    return *is_warm_trusted_;
  }
  void remember(const RunInputs& inputs, const RunOutputs& results) const {
    const std::lock_guard lock{mutex_};
    ++cold_runs_;
    if (!known_ && results.trouble.empty()) known_.emplace(inputs, results);
  }

  [[nodiscard]] RunOutputs run_by(Start begin, const RunInputs& inputs) const {
    const TemporaryRun folder;
    folder.write(kInputs, table_of_inputs(inputs, settings_.inputs));
    std::string parameters;
    for (std::size_t i = 0; i < settings_.parameters.size(); ++i)
      parameters +=
          fmt::format("\"{}\" = {:.16e}\n", settings_.parameters[i], inputs.parameters[i]);
    folder.write(kParameters, parameters);
    if (settings_.has_motion) write_motion(inputs, folder);
    for (const auto& file : settings_.files)
      fs::copy(file, folder.path() / file.filename(), fs::copy_options::recursive);
    const ChildEnding ending = (this->*begin)(command_for(inputs, folder.path()), folder.path());
    if (!ending.trouble.empty()) return {{}, with_messages(ending.trouble, ending)};
    try {
      if (!settings_.recorded.empty())
        return {read_recorders(folder.path(), settings_.recorded, inputs), ""};
      return {read_outputs(folder.path() / kOutputs, settings_.outputs, inputs), ""};
    } catch (const Error& error) {
      std::error_code ignored;
      return {
          {},
          with_messages(!settings_.recorded.empty() || fs::exists(folder.path() / kOutputs, ignored)
                            ? error.what()
                            : std::string{"wrote no "} + kOutputs,
                        ending)};
    }
  }

  [[nodiscard]] std::string with_messages(const std::string& trouble,
                                          const ChildEnding& ending) const {
    return told(settings_.command[0], {trouble, ending.messages});
  }

  // The inputs as a script of OpenSees reads them: together, and each alone.
  void write_motion(const RunInputs& inputs, const TemporaryRun& folder) const {
    std::string rows;
    for (std::size_t row = 0; row < inputs.rows; ++row) {
      rows += fmt::format("{}", static_cast<double>(row) * inputs.time_step);
      for (const auto& input : inputs.inputs) rows += fmt::format(" {}", input[row]);
      rows += '\n';
    }
    folder.write(kMotion, rows);
    for (std::size_t i = 0; i < settings_.inputs.size(); ++i)
      folder.write(settings_.inputs[i], fmt::format("{}\n", fmt::join(inputs.inputs[i], "\n")));
  }

  // Braces around anything but letters, digits, '_', '.' and '-' are text, as in JSON.
  static std::vector<std::string> placeholders_in(const std::string& argument) {
    std::vector<std::string> found;
    for (std::size_t at = 0; (at = argument.find('{', at)) != std::string::npos; ++at) {
      const auto end = argument.find('}', at);
      if (end == std::string::npos) break;
      const std::string name = argument.substr(at + 1, end - at - 1);
      const bool is_name = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (std::isalnum(static_cast<unsigned char>(c)) != 0) || c == '_' || c == '.' ||
               c == '-';
      });
      if (is_name) found.push_back(name);
    }
    return found;
  }

  void check_placeholders(const std::string& argument) const {
    std::vector<std::string> known{"inputs", "outputs", "parameters"};
    known.insert(known.end(), settings_.parameters.begin(), settings_.parameters.end());
    if (settings_.has_motion) {
      known.insert(known.end(), {"motion", "step_s", "duration_s", "results"});
      known.insert(known.end(), settings_.inputs.begin(), settings_.inputs.end());
    }
    for (const auto& name : placeholders_in(argument))
      if (!contains(known, name))
        throw Error{fmt::format("unknown placeholder '{{{}}}', expected one of {}", name,
                                fmt::join(known, ", "))};
  }

  [[nodiscard]] std::string value_of(const std::string& name, const RunInputs& inputs,
                                     const fs::path& folder) const {
    if (name == "inputs") return (folder / kInputs).string();
    if (name == "outputs") return (folder / kOutputs).string();
    if (name == "parameters") return (folder / kParameters).string();
    if (settings_.has_motion) {
      if (name == "step_s") return fmt::format("{}", inputs.time_step);
      if (name == "duration_s")
        return fmt::format("{}", static_cast<double>(inputs.rows - 1) * inputs.time_step);
      if (name == "motion") return (folder / kMotion).string();
      if (name == "results" || contains(settings_.inputs, name)) return (folder / name).string();
    }
    const auto at = std::find(settings_.parameters.begin(), settings_.parameters.end(), name);
    return fmt::format(
        "{}", inputs.parameters[static_cast<std::size_t>(at - settings_.parameters.begin())]);
  }

  [[nodiscard]] std::vector<std::string> command_for(const RunInputs& inputs,
                                                     const fs::path& folder) const {
    auto command = settings_.command;
    for (auto argument = command.begin() + 1; argument != command.end(); ++argument)
      for (const auto& name : placeholders_in(*argument)) {
        const std::string placeholder = "{" + name + "}";
        argument->replace(argument->find(placeholder), placeholder.size(),
                          value_of(name, inputs, folder));
      }
    return command;
  }

  ProgramSettings settings_;
  std::unique_ptr<WarmPython> warm_;  // null: every run starts the program anew
  mutable std::mutex mutex_;          // of what follows
  mutable std::size_t cold_runs_ = 0;
  mutable std::optional<std::pair<RunInputs, RunOutputs>> known_;  // the first with outputs
  mutable std::optional<bool> is_warm_trusted_;
};

}  // namespace

std::unique_ptr<Simulation> make_program(ProgramSettings settings) {
  return std::make_unique<ProgramSimulation>(std::move(settings));
}

}  // namespace rths::foreign
