// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "commands.hpp"
#include "opensees_python.hpp"
#include "write_file.hpp"

namespace rths::app {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> command_of(const DiagnosisBenchArguments& arguments,
                                    const std::string& python, const fs::path& programs) {
  const fs::path script = programs / "../share/rths/trial/bench.py";
  if (!fs::exists(script))
    throw Error{fmt::format("{} is missing, expected the scripts of the trial there",
                            script.lexically_normal().string())};
  std::vector<std::string> command{python,    script.lexically_normal().string(),
                                   "--rths",  (programs / "rths").string(),
                                   "--cases", std::to_string(arguments.cases)};
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) command.insert(command.end(), {name, value});
  };
  for (const auto& family : arguments.families) add("--family", family);
  if (arguments.seed) add("--seed", std::to_string(*arguments.seed));
  add("--json", arguments.json);
  add("--out", arguments.out);
  add("--data", arguments.data);
  if (!arguments.peers) command.push_back("--no-peers");
  if (arguments.peer_cases) add("--peer-cases", std::to_string(*arguments.peer_cases));
  if (arguments.required) add("--require", fmt::format("{}", *arguments.required));
  return command;
}

}  // namespace

int bench_diagnosis(const DiagnosisBenchArguments& arguments) {
  check_result_file(arguments.json);
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  const std::string python = opensees_python(arguments.python, programs);
  if (python.empty())
    throw Error{"no Python with OpenSees and NumPy found, expected one by --python or ./lab"};
  std::vector<std::string> command = command_of(arguments, python, programs);
  std::vector<char*> words;
  for (auto& word : command) words.push_back(word.data());
  words.push_back(nullptr);
  execvp(words[0], words.data());
  throw Error{fmt::format("{}: {}", python, std::strerror(errno))};
}

}  // namespace rths::app
