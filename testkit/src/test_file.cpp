// SPDX-License-Identifier: Apache-2.0
#include <rths/testkit/test_file.hpp>

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>

namespace rths::testkit {
namespace {

constexpr double kLongest = 86'400;  // [s]

double time_of(const Config& table, const std::string& key,
               std::optional<double> otherwise = std::nullopt) {
  return table.number_in(key, 0, kLongest, otherwise);
}

Program read_program(const Config& table, const std::filesystem::path& folder) {
  Program program;
  program.node = table.text("node", "");
  program.name = table.text("name", program.node);
  if (program.name.empty()) table.fail("node", "expected the key node or name");
  program.command = table.texts("command");
  if (program.command.empty()) table.fail("command", "expected a program and its arguments");
  if (program.command[0].find('/') != std::string::npos)
    program.command[0] = table.resolve(program.command[0]).string();
  program.folder = folder;
  program.ready_s = time_of(table, "ready_s", program.ready_s);
  table.reject_unknown_keys();
  return program;
}

// Empty if the value is no text.
std::optional<std::string> text_of(const Config& table, const std::string& key) {
  try {
    return table.text(key);
  } catch (const Error&) {
    return std::nullopt;
  }
}

Condition read_condition(const Config& table) {
  if (table.has("value")) {
    if (const auto name = text_of(table, "value")) return {*name};
    const double value = table.number("value");
    if (!table.has("tolerance")) return {value};
    return {value, table.number_in("tolerance", 0, std::numeric_limits<double>::max())};
  }
  if (table.has("above") && table.has("below")) {
    const double low = table.number("above"), high = table.number("below");
    return {[=](double value) { return value > low && value < high; },
            fmt::format("above {:g} and below {:g}", low, high)};
  }
  if (table.has("above")) return above(table.number("above"));
  if (table.has("below")) return below(table.number("below"));
  table.fail("value", "expected one of value, above, below");
}

Expectation read_expectation(const Config& table) {
  Expectation expectation;
  expectation.from = time_of(table, "from_s", 0.0);
  if (table.has("ends")) {
    expectation.program = table.text("ends");
    expectation.span = time_of(table, "within_s");
    table.reject_unknown_keys();
    return expectation;
  }
  expectation.signal = table.text("signal");
  expectation.condition = read_condition(table);
  expectation.is_never = table.has("never_within_s");
  expectation.span = time_of(table, expectation.is_never ? "never_within_s" : "within_s");
  table.reject_unknown_keys();
  return expectation;
}

Baseline read_baseline(const Config& table) {
  Baseline baseline;
  baseline.file = table.resolve(table.text("file"));
  const std::string patterns = table.text("signals", "");
  for (const auto pattern : cells_of(patterns, ','))
    if (!pattern.empty()) baseline.signals.emplace_back(pattern);
  constexpr double kLargest = std::numeric_limits<double>::max();
  baseline.absolute = table.number_in("abs", 0, kLargest, 0.0);
  baseline.relative = table.number_in("rel", 0, kLargest, 0.0);
  baseline.time = time_of(table, "time_s", 0.0);
  baseline.aligned = table.text("align", "");
  table.reject_unknown_keys();
  return baseline;
}

// Finds the program of a fault. It is linked if the fault changes its messages.
void find_program(const Config& table, PlannedFault& fault, std::vector<Program>& programs) {
  const auto found = std::find_if(programs.begin(), programs.end(), [&](const Program& program) {
    return program.node == fault.node;
  });
  if (found == programs.end())
    table.fail("node", fmt::format("node '{}' has no [[program]]", fault.node));
  fault.program = found->name;
  if (fault.kind != "kill" && fault.kind != "freeze") found->is_linked = true;
}

void read_programs(const Config& file, TestFile& test) {
  test.map = find_file(file, "map", "maps").string();
  const memmap::Map map = memmap::load_map(test.map);
  for (const auto& table : file.tables("program")) {
    test.programs.push_back(read_program(table, file.resolve(".")));
    const auto& node = test.programs.back().node;
    if (!node.empty()) static_cast<void>(table.placed("node", [&] { return map.node(node); }));
  }
  if (test.programs.empty()) file.fail("program", "has no [[program]], expected at least one");
  for (const auto& table : file.tables("fault")) {
    test.faults.push_back({recording::read_message_fault(table, map, {"kill", "freeze"}), ""});
    find_program(table, test.faults.back(), test.programs);
  }
}

void check_expectation(const Config& table, const Expectation& expectation, const TestFile& test) {
  const auto has_name = [&](const Program& program) { return program.name == expectation.program; };
  if (!expectation.program.empty() &&
      std::none_of(test.programs.begin(), test.programs.end(), has_name))
    table.fail("ends", fmt::format("there is no program '{}'", expectation.program));
}

}  // namespace

TestFile read_test(const Config& given) {
  const Config file = given.in_its_folder();
  TestFile test;
  if (file.integer("format") != 1)
    file.fail("format", fmt::format("format is {}, expected 1", file.integer("format")));
  test.name = file.text("name");
  test.deadline = time_of(file, "deadline_s", test.deadline);
  if (file.has("experiment")) {
    test.experiment = file.resolve(file.text("experiment"));
    test.clock = file.text("clock", "virtual");
    if (test.clock != "virtual" && test.clock != "wall")
      file.fail("clock", fmt::format("clock is '{}', expected virtual or wall", test.clock));
    test.changes = file.texts("set", {});
  } else {
    read_programs(file, test);
  }
  for (const auto& table : file.tables("expect")) {
    test.expectations.push_back(read_expectation(table));
    check_expectation(table, test.expectations.back(), test);
  }
  for (const auto& table : file.tables("baseline")) test.baselines.push_back(read_baseline(table));
  if (!test.baselines.empty() && test.experiment.empty())
    file.fail("baseline",
              "has [[baseline]] without an experiment, expected none: the writes of "
              "programs have no times of their own");
  if (test.expectations.empty() && test.baselines.empty())
    file.fail("expect", "has no [[expect]], expected at least one");
  static_cast<void>(file.text("folder", ""));
  file.reject_unknown_keys();
  return test;
}

}  // namespace rths::testkit
