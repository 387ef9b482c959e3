// SPDX-License-Identifier: Apache-2.0
#include <rths/session/why.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/app/builtin_adapters.hpp>
#include <rths/cases/case.hpp>
#include <rths/commissioning/delay_report.hpp>
#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/text.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>
#include <rths/report/report.hpp>
#include <rths/verdict/diagnose.hpp>

#include "mismatch.hpp"

namespace rths::session {
namespace {

using report::ComparedSignal;
using report::Resemblance;

// Of runs that differ in the seed of the sensors' noise alone, less than a tenth of these.
constexpr double kLeastDelay = 0.5e-3;   // [s]
constexpr double kLeastGain = 0.01;      // [-]
constexpr std::size_t kMostSignals = 3;  // of a case without a model
constexpr double kSmall = 1e-3;  // difference over the signal, far below any sensor's noise [-]

bool is_named(const ComparedSignal& signal) {
  return signal.resemblance != Resemblance::None && signal.resemblance != Resemblance::Other;
}

// The mistakes of signals, if they leave no signal that differs.
std::vector<std::string> mistakes_of(const report::ComparedRuns& comparison) {
  std::vector<std::string> mistakes;
  for (const auto& signal : comparison.signals) {
    if (signal.is_equal || (signal.unmatched == 0 && signal.relative_rms <= kSmall)) continue;
    if (!is_named(signal)) return {};
    mistakes.push_back(fmt::format("{} {}", signal.name, signal.explanation));
  }
  return mistakes;
}

/// The simulation of a run, and whose it is.
struct KnownModel {
  Config table;
  std::string name;
};

// The terms of a simulated laboratory, without what its own simulation omits.
KnownModel model_of(const std::filesystem::path& file) {
  const recording::Reader run{file};
  if (const std::string path = recording::experiment_path(run);
      report::is_of_models(run).value_or(false) && !path.empty() &&
      change_since(run, path).empty()) {
    auto changes = recording::overrides_of(run);
    changes.emplace_back("model", "{fitted = []}");
    const auto experiment = app::load_experiment(path, changes);
    return {Config::parse(experiment.model.text, recording::kModelText),
            "the laboratory of " + file.string()};
  }
  return {Config::parse(run.config(recording::kModelText), recording::kModelText),
          "the simulation of " + file.string()};
}

diagnosis::Verdict diagnosed(const std::filesystem::path& recorded, const KnownModel& simulation,
                             std::uint64_t seed, const Progress& progress) {
  diagnosis::Case c = diagnosis::load_case(recorded);
  c.model.table = simulation.table.without("fitted");
  c.model.fitted.clear();
  // The experiment of the recording is not that of the model.
  c.source.experiment = Config{};
  return diagnosis::diagnose(c, {{}, seed, progress.fits});
}

// A change of the path from the reference to the measured motion, which the force does not show.
std::vector<std::string> changes_of_motion(const std::filesystem::path& baseline,
                                           const std::filesystem::path& other) {
  const commissioning::DelayQuestion question{"reference", "machine_displacement"};
  std::vector<std::string> changes;
  try {
    const auto before = commissioning::track(recording::Reader{baseline}, question),
               after = commissioning::track(recording::Reader{other}, question);
    for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i) {
      const auto &a = before[i].whole.fit, &b = after[i].whole.fit;
      if (std::abs(b.delay - a.delay) > kLeastDelay)
        changes.push_back(fmt::format("the machine follows its reference {:.1f} ms {} ({})",
                                      1e3 * std::abs(b.delay - a.delay),
                                      b.delay > a.delay ? "later" : "earlier", before[i].axis));
      if (std::abs(b.gain / a.gain - 1) > kLeastGain)
        changes.push_back(fmt::format(
            "the motion of the machine over its reference is {:.3f} times as large ({})",
            b.gain / a.gain, before[i].axis));
    }
  } catch (const Error&) {
    return {};  // without the signals of a machine, or without motion
  }
  return changes;
}

// Roles have no dots and blanks.
std::string role_of(const char* family, const std::string& signal) {
  std::string role = signal;
  for (char& c : role)
    if (!is_letter_or_digit(c)) c = '_';
  return fmt::format("{}.{}", family, role);
}

// The signals of the other, with those of the baseline as their simulation: those that differ most,
// and as inputs some that are equal and move.
diagnosis::Case case_of_signals(const report::ComparedRuns& comparison) {
  std::vector<const ComparedSignal*> chosen;
  std::vector<std::string> names;
  std::size_t outputs = 0, inputs = 0;
  for (const auto& signal : comparison.signals) {
    const bool moves = signal.samples > 0 && signal.peak > 0;
    if (!moves || signal.unmatched > 0) continue;
    std::size_t& count = signal.is_equal ? inputs : outputs;
    if (count == kMostSignals || (signal.is_equal && signal.name.starts_with("monitor."))) continue;
    ++count;
    chosen.push_back(&signal);
    names.push_back(signal.name);
  }
  const auto values = report::values_of(comparison, names);
  diagnosis::Case c;
  c.name = comparison.other.filename().string();
  c.folder = ".";
  c.model.table = Config::parse("kind = \"data\"", "comparison");
  diagnosis::Record record;
  record.name = c.name;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto& [time, baseline, other] = values[i];
    record.start = time.front();
    record.time_step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
    const auto& [name, unit] = std::pair{chosen[i]->name, chosen[i]->unit};
    if (chosen[i]->is_equal) {
      record.channels.push_back({role_of("input", name), unit, baseline});
      continue;
    }
    record.channels.push_back({role_of("output", name), unit, other});
    record.channels.push_back({role_of("predicted.output", name), unit, baseline});
  }
  c.records.push_back(std::move(record));
  return c;
}

bool has_model(const std::filesystem::path& file) {
  return recording::is_hdf5(file) && !recording::Reader{file}.config(recording::kModelText).empty();
}

}  // namespace

Difference why(const report::ComparedRuns& comparison, std::uint64_t seed,
               const Progress& progress) {
  const Interruptible interruptible;
  Difference difference;
  if (comparison.equal() == comparison.signals.size()) {
    difference.sentence = "Nothing differs.";
    return difference;
  }
  difference.mistakes = mistakes_of(comparison);
  if (!difference.mistakes.empty()) {
    difference.sentence = difference.mistakes.front() + ".";
    return difference;
  }
  if (!has_model(comparison.baseline) || !has_model(comparison.other)) {
    difference.verdict =
        diagnosis::diagnose(case_of_signals(comparison), {{}, seed, progress.fits});
    difference.model = "the baseline as the simulation of the other";
    difference.sentence = diagnosis::answers_of(*difference.verdict).headline;
    return difference;
  }
  const KnownModel baseline = model_of(comparison.baseline);
  difference.model = baseline.name;
  difference.verdict = diagnosed(comparison.other, baseline, seed, progress);
  if (difference.verdict->conclusion.outcome == diagnosis::Outcome::Unknown) {
    // A diagnosis adds terms; one that the other lacks is one that the baseline has in addition.
    const KnownModel other = model_of(comparison.other);
    auto reversed = diagnosed(comparison.baseline, other, seed, progress);
    if (reversed.conclusion.outcome == diagnosis::Outcome::Missing) {
      difference.is_reversed = true;
      difference.model = other.name;
      difference.verdict = std::move(reversed);
    }
  }
  difference.sentence = diagnosis::answers_of(*difference.verdict).headline;
  if (difference.verdict->conclusion.outcome != diagnosis::Outcome::None) return difference;
  difference.mistakes = changes_of_motion(comparison.baseline, comparison.other);
  if (!difference.mistakes.empty())
    difference.sentence =
        fmt::format("The force is as expected, but {}.", difference.mistakes.front());
  return difference;
}

std::string text_of(const Difference& difference) {
  std::string text = fmt::format("why: {}\n", difference.sentence);
  if (difference.is_reversed) text += "  The baseline has this; the other lacks it.\n";
  if (!difference.model.empty()) text += fmt::format("  beside {}\n", difference.model);
  for (std::size_t i = 1; i < difference.mistakes.size(); ++i)
    text += fmt::format("  {}\n", difference.mistakes[i]);
  return text;
}

std::string json_of(const Difference& difference) {
  nlohmann::ordered_json json = {{"sentence", difference.sentence},
                                 {"mistakes", difference.mistakes},
                                 {"model", difference.model},
                                 {"reversed", difference.is_reversed},
                                 {"causes", nlohmann::ordered_json::array()}};
  if (difference.verdict)
    for (const auto& cause : difference.verdict->conclusion.causes)
      if (!is_guess(cause)) json["causes"].push_back(cause.name);
  return json.dump();
}

}  // namespace rths::session
