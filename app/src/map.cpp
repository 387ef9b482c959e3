// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/core/installed_files.hpp>
#include <rths/memmap/generate.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct MapArguments {
  std::string file, language = "cpp";
};

int map_list() {
  for (const auto& name : rths::built_in_names("maps")) {
    const auto file = rths::find_map(name);
    const auto map = memmap::load_map(file);
    fmt::print("{:<14} {:>2} nodes {:>4} signals  {}\n", name, map.description().nodes.size(),
               map.signals().size(), file.string());
  }
  return kOk;
}

int map_gen(const MapArguments& arguments) {
  const auto map = memmap::load_map(rths::find_map(arguments.file));
  fmt::print("{}", arguments.language == "c" ? memmap::generate_c(map) : memmap::generate_cpp(map));
  return kOk;
}

}  // namespace

int map_check(const std::string& file) {
  const auto map = memmap::load_map(rths::find_map(file));
  fmt::print("{}: map '{}', version {}, {} nodes, {} partitions, {} signals, hash {}\n", file,
             map.description().name, map.description().version, map.description().nodes.size(),
             map.partitions().size(), map.signals().size(), memmap::hash_text(map.hash()));
  return kOk;
}

void add_map(CommandLine& line) {
  auto* command = line.app.add_subcommand("map", "Memory maps");
  command->require_subcommand(1);
  command->add_subcommand("list", "List the built-in maps")->callback([&] {
    line.chosen = [] { return map_list(); };
  });
  auto [check, file] = line.add_to(*command, "check", "Check a map", map_check);
  check->add_option("map", file, "File, or name of a built-in map")->required();
  auto [gen, a] =
      line.add_to(*command, "gen", "Print a header for programs that use the map", map_gen);
  gen->add_option("map", a.file, "File, or name of a built-in map")->required();
  gen->add_option("--lang", a.language)->check(CLI::IsMember({"c", "cpp"}));
}

}  // namespace rths::app
