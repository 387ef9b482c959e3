// SPDX-License-Identifier: Apache-2.0
#include "compared_file.hpp"

#include <cmath>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/memmap/units.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>
#include <rths/recording/table.hpp>

namespace rths::report {
namespace {

namespace fs = std::filesystem;
using recording::Reader;
using recording::Table;

bool is_recording(const fs::path& file) {
  std::ifstream stream{file, std::ios::binary};
  std::string begin(4, '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin == "\x89HDF" && !Table::is_format_of(file);
}

// One line for each value of a TOML text: dotted key and value.
std::map<std::string, std::string> flat(const std::string& toml) {
  std::map<std::string, std::string> values;
  std::map<std::string, int> numbers;  // of the tables of an array
  std::istringstream lines{toml};
  std::string line, table;
  while (std::getline(lines, line)) {
    if (line.starts_with("[[")) {
      const std::string name = line.substr(2, line.find("]]") - 2);
      table = fmt::format("{}[{}].", name, ++numbers[name]);
    } else if (line.starts_with("[")) {
      table = line.substr(1, line.find(']') - 1) + ".";
    } else if (const auto equals = line.find(" = "); equals != std::string::npos) {
      values[table + line.substr(0, equals)] = line.substr(equals + 3);
    }
  }
  return values;
}

void add_roles(const Reader& run, ComparedFile& file) {
  const recording::Roles roles = recording::roles_of(run);
  const auto add = [&](const std::string& role, const std::string& name) {
    if (run.has(name)) file.roles[role] = name;
  };
  for (const auto& axis : roles.axes)
    for (const auto& [role, name] :
         {std::pair{"target", axis.target}, std::pair{"command", axis.command},
          std::pair{"displacement", axis.displacement}, std::pair{"force", axis.force},
          std::pair{"reference", axis.reference},
          std::pair{"machine displacement", axis.machine_displacement},
          std::pair{"machine acceleration", axis.machine_acceleration},
          std::pair{"machine force", axis.machine_force}})
      add(axis.axis + " " + role, name);
  add("time of the target", roles.time);
  add("load", roles.load);
}

ComparedFile read_recording(const fs::path& path) {
  const Reader run{path};
  ComparedFile file;
  file.time = run.time();
  for (const auto& name : run.names()) {
    FileSignal signal{run.unit(name), run.signal(name)};
    if (signal.values.size() == file.time.size()) file.signals[name] = std::move(signal);
  }
  if (const auto experiment = recording::recorded_experiment(run)) {
    file.settings = flat(experiment->to_toml());
    file.has_experiment = true;
    add_roles(run, file);
  }
  for (const char* text : {recording::kModelText, recording::kSpecimenText})
    for (auto& [key, value] : flat(run.config(text)))
      file.settings[fmt::format("{}: {}", text, key)] = std::move(value);
  file.settings["map"] = run.map().description().name;
  return file;
}

/// Name and unit of a heading, such as "force [kN]", "force (kN)" or "force_kN".
std::pair<std::string, std::string> split_heading(const std::string& heading) {
  const auto is_unit = [](const std::string& text) {
    try {
      static_cast<void>(memmap::parse_unit(text));
      return true;
    } catch (const Error&) {
      return false;
    }
  };
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const auto begin = heading.find(open), end = heading.rfind(close);
    if (begin == std::string::npos || end == std::string::npos || end < begin) continue;
    const std::string unit = heading.substr(begin + 1, end - begin - 1);
    if (!is_unit(unit)) continue;
    const auto last = heading.find_last_not_of(" \t_", begin == 0 ? 0 : begin - 1);
    return {heading.substr(0, last + 1), unit};
  }
  if (const auto bar = heading.rfind('_'); bar != std::string::npos && bar > 0)
    if (const std::string unit = heading.substr(bar + 1); is_unit(unit) && unit != "1")
      return {heading.substr(0, bar), unit};
  return {heading, ""};
}

bool is_time(const std::string& heading) {
  const std::string name = in_small_letters(heading);
  return name == "time" || name == "t" || name == "zeit" || name == "temps";
}

ComparedFile read_table(const fs::path& path) {
  ComparedFile file;
  const Table table = Table::load(path);
  for (const auto& column : table.columns()) {
    auto [name, unit] = split_heading(column.name);
    if (unit.empty()) unit = column.unit;
    const memmap::Unit si = unit.empty() ? memmap::Unit{} : memmap::parse_unit(unit);
    std::vector<double> values = column.values;
    for (double& value : values) value = si.scale * value + si.offset;
    if (is_time(name) && file.time.empty())
      file.time = std::move(values);
    else
      file.signals[name] = {si.si, std::move(values)};
  }
  if (file.time.empty())
    throw Error{"found no column of time, expected one that is named time or t"};
  return file;
}

}  // namespace

ComparedFile read_compared(const fs::path& path) {
  return recording::of_file(path, [&] {
    ComparedFile file = is_recording(path) ? read_recording(path) : read_table(path);
    for (std::size_t i = 1; i < file.time.size(); ++i)
      if (!(file.time[i] > file.time[i - 1]))
        throw Error{fmt::format("time row {} is {:g} s after {:g} s, expected rising times", i + 1,
                                file.time[i], file.time[i - 1])};
    if (file.time.size() < 2)
      throw Error{fmt::format("found {} rows, expected at least two", file.time.size())};
    return file;
  });
}

}  // namespace rths::report
