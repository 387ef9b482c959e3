// SPDX-License-Identifier: Apache-2.0
#include "diagnosis.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include <rths/command_line/write_file.hpp>
#include <rths/core/error.hpp>
#include <rths/core/installed_files.hpp>

namespace rths::bench {
namespace {

std::vector<std::string> command_of(const DiagnosisOptions& options, const std::string& results) {
  const auto script = shared_files() / "trial/bench.py";
  if (!std::filesystem::exists(script))
    throw Error{
        fmt::format("{} is missing, expected the scripts of the trial there", script.string())};
  std::vector<std::string> command{options.python, script.string(),
                                   "--rths",       (options.programs / "rths").string(),
                                   "--cases",      std::to_string(options.cases)};
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) command.insert(command.end(), {name, value});
  };
  for (const auto& family : options.families) add("--family", family);
  if (options.seed) add("--seed", std::to_string(*options.seed));
  add("--json", results);
  add("--out", options.out);
  add("--data", options.data);
  if (!options.peers) command.push_back("--no-peers");
  if (options.peer_cases) add("--peer-cases", std::to_string(*options.peer_cases));
  if (options.required) add("--require", fmt::format("{}", *options.required));
  return command;
}

}  // namespace

void become_trial(const DiagnosisOptions& options, const std::string& results) {
  app::check_result_file(results);
  if (options.python.empty())
    throw Error{"no Python with OpenSees and NumPy found, expected one by --python or ./lab"};
  std::vector<std::string> command = command_of(options, results);
  std::vector<char*> words;
  for (auto& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  execvp(words[0], words.data());
  throw Error{fmt::format("{}: {}", options.python, std::strerror(errno))};
}

}  // namespace rths::bench
