// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <rths/core/installed_files.hpp>
#include <rths/memmap/generate.hpp>

#include "commands.hpp"

namespace rths::app {

int map_list() {
  for (const auto& name : rths::built_in_names("maps")) {
    const auto file = rths::find_map(name);
    const auto map = memmap::load_map(file);
    fmt::print("{:<14} {:>2} nodes {:>4} signals  {}\n", name, map.description().nodes.size(),
               map.signals().size(), file.string());
  }
  return kOk;
}

int map_check(const std::string& file) {
  const auto map = memmap::load_map(rths::find_map(file));
  fmt::print("{}: map '{}', version {}, {} nodes, {} partitions, {} signals, hash {}\n", file,
             map.description().name, map.description().version, map.description().nodes.size(),
             map.partitions().size(), map.signals().size(), memmap::hash_text(map.hash()));
  return kOk;
}

int map_gen(const std::string& file, const std::string& language) {
  const auto map = memmap::load_map(rths::find_map(file));
  fmt::print("{}", language == "c" ? memmap::generate_c(map) : memmap::generate_cpp(map));
  return kOk;
}

}  // namespace rths::app
