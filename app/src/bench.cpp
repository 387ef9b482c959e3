// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

[[noreturn]] void become(const std::filesystem::path& program, std::vector<std::string> words) {
  words.insert(words.begin(), program.string());
  std::vector<char*> arguments;
  for (auto& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execv(program.c_str(), arguments.data());
  const std::error_code reason{errno, std::generic_category()};
  throw Error{fmt::format(
      "{}: {}, expected the program of the benchmarks there; ./lab rths bench builds it, as does "
      "cmake with -DRTHS_BENCHMARKS=ON",
      program.string(), reason.message())};
}

}  // namespace

void become_bench(const std::vector<std::string>& words) {
  const bool completes = words.size() > 2 && words[0] == "complete" && words[1] == "bench";
  if (!completes && (words.empty() || words[0] != "bench")) return;
  std::vector<std::string> others{words.begin() + (completes ? 2 : 1), words.end()};
  if (completes) others.insert(others.begin(), words[0]);
  become(std::filesystem::read_symlink("/proc/self/exe").replace_filename("rths-bench"), others);
}

void add_bench(CommandLine& line) {
  line.app.add_subcommand("bench",
                          "Run a benchmark on this host, with rths-bench(1) where it is built");
}

}  // namespace rths::app
