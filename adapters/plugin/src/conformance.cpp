// SPDX-License-Identifier: Apache-2.0
//
// Three trials: the plugin is loaded and described; it runs, restarts and stops; two of it run in
// turns. The second trial is repeated in another process, whose outputs must be the same.
#include <rths/plugin/conformance.hpp>

#include <elf.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/memmap/units.hpp>
#include <rths/plugin/plugin_adapter.hpp>

#include "candidate.hpp"

namespace rths::plugin {
namespace {

/// The bytes of a file. Reads beyond its end are Errors.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : name_{file.string()} {
    std::ifstream stream{file, std::ios::binary};
    bytes_.assign(std::istreambuf_iterator<char>{stream}, {});
  }
  template <class Value>
  [[nodiscard]] Value at(std::size_t offset) const {
    if (offset > bytes_.size() || bytes_.size() - offset < sizeof(Value))
      throw Error{name_ + ": is not a complete shared library"};
    Value value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }
  [[nodiscard]] std::string text_at(std::size_t offset) const {
    std::string text;
    for (char c = at<char>(offset); c != '\0'; c = at<char>(++offset)) text += c;
    return text;
  }

 private:
  std::string name_;
  std::string bytes_;
};

bool is_export(const Elf64_Sym& symbol) {
  const auto binding = ELF64_ST_BIND(symbol.st_info);
  const auto type = ELF64_ST_TYPE(symbol.st_info);
  const auto visibility = ELF64_ST_VISIBILITY(symbol.st_other);
  return symbol.st_shndx != SHN_UNDEF && symbol.st_shndx < SHN_LORESERVE && binding != STB_LOCAL &&
         visibility == STV_DEFAULT &&
         (type == STT_FUNC || type == STT_OBJECT || type == STT_GNU_IFUNC || type == STT_TLS);
}

/// Functions and objects that a shared library exports, sorted.
/// @throws Error if it is not an ELF library of 64 bits   @setup
std::vector<std::string> exported_symbols(const std::filesystem::path& library) {
  const Bytes bytes{library};
  const auto header = bytes.at<Elf64_Ehdr>(0);
  if (header.e_ident[EI_CLASS] != ELFCLASS64)
    throw Error{library.string() + ": is not a library of 64 bits"};
  const auto section = [&](std::size_t index) {
    return bytes.at<Elf64_Shdr>(header.e_shoff + index * sizeof(Elf64_Shdr));
  };
  std::vector<std::string> names;
  for (std::size_t i = 0; i < header.e_shnum; ++i) {
    const auto table = section(i);
    if (table.sh_type != SHT_DYNSYM) continue;
    const auto strings = section(table.sh_link);
    for (std::size_t at = 0; at < table.sh_size; at += sizeof(Elf64_Sym)) {
      const auto symbol = bytes.at<Elf64_Sym>(table.sh_offset + at);
      if (is_export(symbol)) names.push_back(bytes.text_at(strings.sh_offset + symbol.st_name));
    }
  }
  std::erase_if(names, [](const auto& name) { return name == "_init" || name == "_fini"; });
  std::sort(names.begin(), names.end());
  return names;
}

constexpr double kRestDeadline = 2;                       // after the stop [s]
constexpr std::size_t kSeveral = 2;                       // long steps of a run
constexpr double kManyOfSteps = 0.05;                     // of a run
constexpr std::uint64_t kNoOutputs = 0xcbf29ce484222325;  // the fingerprint's start
constexpr const char* kRuleNames[kRules] = {
    "exports",  "abi",        "lifecycle", "signals", "units",     "range",       "nan",  "bounds",
    "deadline", "allocation", "stop",      "restart", "instances", "determinism", "crash"};

// FNV-1a.
std::uint64_t extended(std::uint64_t fingerprint, const double* values, std::size_t count) {
  constexpr std::uint64_t kPrime = 0x100000001b3;
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &values[i], sizeof bits);
    fingerprint = (fingerprint ^ bits) * kPrime;
  }
  return fingerprint;
}

std::uint64_t run(PluginUnderTest& candidate) {
  std::uint64_t fingerprint = kNoOutputs;
  candidate.activate();
  for (int i = 0; i < kTrialSteps; ++i) {
    const rths_status status = candidate.step();
    fingerprint = extended(fingerprint, candidate.out(), candidate.outputs());
    if (status == RTHS_DONE) break;
  }
  return fingerprint;
}

std::string fault_of_signal(const rths_signal& signal, std::set<std::string>& names) {
  if (signal.name == nullptr || *signal.name == '\0') return "a signal has no name";
  if (signal.unit == nullptr) return fmt::format("'{}' has no unit", signal.name);
  if (signal.direction > RTHS_PARAMETER)
    return fmt::format("'{}' has direction {}, expected 0 to {}", signal.name, signal.direction,
                       static_cast<int>(RTHS_PARAMETER));
  if (!names.insert(fmt::format("{} {}", signal.direction, signal.name)).second)
    return fmt::format("'{}' is listed twice", signal.name);
  return "";
}

std::string fault_of_unit(const rths_signal& signal) {
  try {
    const auto unit = memmap::parse_unit(signal.unit);
    if (unit.si == signal.unit) return "";
    return fmt::format("'{}' is in [{}], expected [{}]: convert in the plugin", signal.name,
                       signal.unit, unit.si);
  } catch (const Error& error) {
    return fmt::format("'{}': {}", signal.name, error.what());
  }
}

std::string fault_of_range(const rths_signal& signal) {
  if (!has_range(signal)) return "";
  if (!(signal.lowest < signal.highest))
    return fmt::format("'{}' has a range from {:g} to {:g}, expected lowest < highest", signal.name,
                       signal.lowest, signal.highest);
  const bool is_inside = signal.initial >= signal.lowest && signal.initial <= signal.highest;
  if (signal.direction != RTHS_PARAMETER || is_inside) return "";
  return fmt::format("'{}' begins with {:g}, outside its range {:g} to {:g}", signal.name,
                     signal.initial, signal.lowest, signal.highest);
}

void describe(PluginUnderTest& candidate, TrialReport& report) {
  std::set<std::string> names;
  for (const auto& signal : candidate.signals())
    if (const auto fault = fault_of_signal(signal, names); !fault.empty()) {
      report.fail(kSignals, fault);
      throw Ended{};
    }
  report.pass(kSignals, fmt::format("{} signals", candidate.signals().size()));
  report.pass(kUnits);
  report.pass(kRange);
  for (const auto& signal : candidate.signals()) {
    if (const auto fault = fault_of_unit(signal); !fault.empty()) report.fail(kUnits, fault);
    if (const auto fault = fault_of_range(signal); !fault.empty()) report.fail(kRange, fault);
  }
}

bool is_same(const rths_signal& a, const rths_signal& b) {
  return std::strcmp(a.name, b.name) == 0 && std::strcmp(a.unit, b.unit) == 0 &&
         a.direction == b.direction;
}

void check_median(const StepDurations& times, double period, TrialReport& report) {
  const double middle = maths::median(times.wall);
  if (middle <= period)
    return report.pass(kDeadline, fmt::format("median step {:.2f} us", 1e6 * middle));
  report.fail(kDeadline, fmt::format("half of the steps took more than {:.1f} ms, the period is "
                                     "{:.1f} ms: do not wait in a step",
                                     1e3 * middle, 1e3 * period));
  throw Ended{};
}

// Indices of the steps that used the processor for longer than the period. The first step may read
// pages of the library.
std::vector<std::size_t> long_steps(const StepDurations& times, double period) {
  std::vector<std::size_t> found;
  for (std::size_t i = 1; i < times.processor.size(); ++i)
    if (times.processor[i] > period) found.push_back(i);
  return found;
}

// A busy host can stretch a step. So a long step counts if it is long in both runs; if each run has
// several; or if one run has many.
void check_longest(const StepDurations& first, const StepDurations& second, double period,
                   TrialReport& report) {
  const auto one = long_steps(first, period), other = long_steps(second, period);
  for (const std::size_t i : one)
    if (std::binary_search(other.begin(), other.end(), i))
      report.fail(kDeadline, fmt::format("step {} took {:.1f} ms, the period is {:.1f} ms", i,
                                         1e3 * std::min(first.processor[i], second.processor[i]),
                                         1e3 * period));
  const std::size_t fewer = std::min(one.size(), other.size());
  const std::size_t more = std::max(one.size(), other.size());
  if (fewer >= kSeveral || static_cast<double>(more) > kManyOfSteps * kTrialSteps)
    report.fail(kDeadline, fmt::format("{} and {} steps of two runs took more than the period of "
                                       "{:.1f} ms",
                                       one.size(), other.size(), 1e3 * period));
}

void check_rest(const Library& library, PluginUnderTest& candidate, double period,
                TrialReport& report) {
  if (library.stop() == nullptr) return report.pass(kStop, "the host ramps outputs to rest");
  candidate.stop();
  const int longest = static_cast<int>(kRestDeadline / period);
  for (int i = 0; i < longest; ++i)
    if (candidate.step() == RTHS_DONE) return report.pass(kStop, fmt::format("{} steps", i + 1));
  report.fail(kStop,
              fmt::format("did not return RTHS_DONE within {:g} s after stop", kRestDeadline));
}

// Loads, describes, runs, restarts, stops.
void first_trial(const std::filesystem::path& file, const ConformanceSettings& settings,
                 TrialReport& report) {
  const std::string loading = "loading";
  std::copy(loading.begin(), loading.end(), report.call.begin());
  std::optional<Library> library;
  try {
    library.emplace(std::filesystem::absolute(file), settings.built_in);
  } catch (const Error& error) {
    return report.fail(kAbi, error.what());
  }
  const auto& adapter = library->adapter();
  report.pass(kAbi, fmt::format("'{}' {}, adapter ABI {}.{}", adapter.name, adapter.version,
                                adapter.abi >> 16, adapter.abi & 0xFFFF));
  try {
    PluginUnderTest candidate{*library, settings, report};
    candidate.create();
    candidate.read_signals();
    describe(candidate, report);
    const auto before = candidate.signals();
    report.fingerprint = run(candidate);
    candidate.read_signals();
    const auto& after = candidate.signals();
    if (!std::equal(before.begin(), before.end(), after.begin(), after.end(), is_same)) {
      report.fail(kSignals, "other signals after activate than before: list them in create");
      throw Ended{};
    }
    candidate.deactivate();
    const StepDurations times = candidate.times();
    check_median(times, settings.period, report);
    if (run(candidate) != report.fingerprint)
      report.fail(kRestart,
                  "other outputs after deactivate and activate: take the initial state "
                  "in activate");
    check_longest(times, candidate.times(), settings.period, report);
    check_rest(*library, candidate, settings.period, report);
    candidate.deactivate();
    candidate.destroy();
    for (const Rule rule : {kLifecycle, kNan, kBounds, kRestart, kCrash}) report.pass(rule);
    if (rths_heap_calls != nullptr && !settings.may_allocate) report.pass(kAllocation);
  } catch (const Ended&) {
    return;  // the report says why
  }
}

// Two instances in turns, as two nodes of one process.
void trial_of_instances(const std::filesystem::path& file, const ConformanceSettings& settings,
                        std::uint64_t alone, TrialReport& report) {
  const Library library{std::filesystem::absolute(file), settings.built_in};
  std::array<PluginUnderTest, 2> pair{PluginUnderTest{library, settings, report},
                                      PluginUnderTest{library, settings, report}};
  for (auto& candidate : pair) {
    candidate.create();
    candidate.read_signals();
    candidate.activate();
  }
  std::array fingerprints{kNoOutputs, kNoOutputs};
  bool done = false;
  for (int i = 0; i < kTrialSteps && !done; ++i)
    for (std::size_t k = 0; k < pair.size(); ++k) {
      done = pair[k].step() == RTHS_DONE;
      fingerprints[k] = extended(fingerprints[k], pair[k].out(), pair[k].outputs());
    }
  for (auto& candidate : pair) {
    candidate.deactivate();
    candidate.destroy();
  }
  if (fingerprints[0] == alone && fingerprints[1] == alone) return report.pass(kInstances);
  report.fail(kInstances,
              "two adapters of this library influence each other: keep all state in "
              "`self`, none in static variables");
}

void add_exports(const std::filesystem::path& file, TrialReport& report) {
  auto names = exported_symbols(file);
  std::erase(names, "rths_adapter_entry");
  if (names.empty()) return report.pass(kExports);
  const std::size_t count = names.size();
  names.resize(std::min<std::size_t>(count, 3));
  report.fail(kExports, fmt::format("{} symbols besides rths_adapter_entry, such as {}: link with "
                                    "rths_add_adapter, or with a version script",
                                    count, fmt::join(names, ", ")));
}

std::vector<Finding> findings_of(const TrialReport& report) {
  std::vector<Finding> findings;
  for (std::size_t i = 0; i < kRules; ++i) {
    const auto& rule = report.rules[i];
    using Outcome = Finding::Outcome;
    findings.push_back(
        {kRuleNames[i],
         !rule.tried ? Outcome::NotTried : (rule.failed ? Outcome::Fail : Outcome::Pass),
         rule.text.data()});
  }
  return findings;
}

}  // namespace

std::vector<Finding> check_plugin(const std::filesystem::path& library,
                                  const ConformanceSettings& settings) {
  const auto trial = [&](TrialReport& report) { first_trial(library, settings, report); };
  TrialReport report = run_trial(trial, settings.step_deadline);
  if (settings.built_in == nullptr) add_exports(library, report);
  if (!report.completed || !report.rules[kCrash].tried) return findings_of(report);
  const auto again = run_trial(trial, settings.step_deadline);
  if (again.fingerprint == report.fingerprint)
    report.pass(kDeterminism);
  else
    report.fail(kDeterminism,
                "the same inputs gave other outputs in another process: use no "
                "clock, address or unseeded random number");
  const auto both = run_trial(
      [&](TrialReport& other) {
        try {
          trial_of_instances(library, settings, report.fingerprint, other);
        } catch (const Ended&) {
          return;  // the report says why
        }
      },
      settings.step_deadline);
  // The rules of single instances are judged above.
  if (again.fingerprint == report.fingerprint)
    for (const Rule rule : {kInstances, kCrash})
      if (both.rules[rule].failed) report.fail(rule, both.rules[rule].text.data());
  if (both.rules[kInstances].tried) report.pass(kInstances);
  return findings_of(report);
}

bool is_library(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary};
  char magic[SELFMAG]{};
  return stream.read(magic, SELFMAG) && std::memcmp(magic, ELFMAG, SELFMAG) == 0;
}

}  // namespace rths::plugin
