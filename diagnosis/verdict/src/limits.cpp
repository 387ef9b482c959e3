// SPDX-License-Identifier: Apache-2.0
#include "limits.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/cases/rest.hpp>
#include <rths/identification/constants.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/models/relations.hpp>

#include "check_records.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kFurthest = 3;  // [m]: hardly any test machine moves further

std::string gaps_in(const Record& record) {
  std::size_t samples = 0;
  for (const auto& [last, next] : record.gaps) samples += next - last - 1;
  return fmt::format("{}: {} gaps of {:.2g} s in all are not compared.", record.name,
                     record.gaps.size(), static_cast<double>(samples) * record.time_step);
}

// A section at rest that is sampled faster than a record in motion; empty: there is none.
std::string faster_at_rest(const Case& c) {
  constexpr double kEqual = 1e-3;
  for (const auto& rest : c.records)
    for (const Record* moving : moving_records(c))
      if (rest.quiet && rest.time_step < (1 - kEqual) * moving->time_step)
        return fmt::format(
            "{} is at rest at {:.4g} Hz, and {} moves at {:.4g} Hz: the noise has one density per "
            "Hz, as behind one anti-aliasing filter.",
            rest.name, 1 / rest.time_step, moving->name, 1 / moving->time_step);
  return "";
}

MatrixXd centred(const MatrixXd& columns) { return columns.rowwise() - columns.colwise().mean(); }

bool has_family(const Record& record, const std::string& family) {
  return std::any_of(record.channels.begin(), record.channels.end(),
                     [&](const auto& channel) { return family_of(channel.role) == family; });
}

bool is_horizontal(const std::string& role) {
  return role.ends_with(".long") || role.ends_with(".lat");
}

// Whether a relation of compositions reads a channel, or is anchored to it.
bool is_used_by_compositions(const Channel& channel, const Record& record, bool reads_commands) {
  if (is_predicted(channel.role)) {
    const std::string output = channel.role.substr(kPredicted.size());
    return is_horizontal(output) && record.find(output) != nullptr &&
           (family_of(output) != "displacement" || reads_commands);
  }
  const std::string family = family_of(channel.role);
  if (family == "vertical_force" || family == "temperature") return true;
  if (family == "auxiliary") {
    const auto first = std::find_if(record.channels.begin(), record.channels.end(),
                                    [](const auto& c) { return family_of(c.role) == "auxiliary"; });
    return first->role == channel.role;
  }
  const bool is_read = (family == "command" && reads_commands) || family == "displacement" ||
                       family == "acceleration" || family == "force";
  return is_read && is_horizontal(channel.role);
}

// Whether a dynamic model names the channel, or reads it for its added terms.
bool is_used_by_model(const Channel& channel, const Record& record, const Model& model) {
  const bool is_of_simulation = is_predicted(channel.role);
  if (!is_prediction(model.kind)) {
    const std::string role =
        is_of_simulation ? channel.role.substr(kPredicted.size()) : channel.role;
    const std::string text = model.table.to_toml();
    return text.find('"' + role + '"') != std::string::npos ||
           text.find('\'' + role + '\'') != std::string::npos;
  }
  if (is_of_simulation) return true;
  if (record.find(prediction_of(channel.role)) != nullptr) return true;
  if (model.table.table_or_empty("outputs").has(channel.role)) return true;
  const std::string family = family_of(channel.role);
  return family == "input" || family == "command" || family == "displacement" ||
         family == "velocity" || family == "acceleration";
}

std::string unused_channels(const Case& c) {
  const bool is_composed = is_composition(c.model.kind);
  const bool reads_commands = is_composed && has_actuator(c);
  std::vector<std::string> unused;
  for (const Record* record : moving_records(c))
    for (const auto& channel : record->channels) {
      const bool is_used = is_composed ? is_used_by_compositions(channel, *record, reads_commands)
                                       : is_used_by_model(channel, *record, c.model);
      if (!is_used && std::find(unused.begin(), unused.end(), channel.role) == unused.end())
        unused.push_back(channel.role);
    }
  if (unused.empty()) return "";
  return fmt::format("Not used by a model of kind '{}': {}.", name_of(c.model.kind),
                     fmt::join(unused, ", "));
}

// Sections at rest that are too short for the noise; empty: none.
std::string short_rest(const Case& c) {
  std::size_t samples = 0;
  for (const auto& record : c.records)
    if (record.quiet) samples += record.quiet->second - record.quiet->first;
  if (samples == 0 || static_cast<double>(samples) >= kFewestAtRest) return "";
  return fmt::format("quiet_s has {} samples, expected at least {} in all: it is not used.",
                     samples, kFewestAtRest);
}

// Friction and strength follow the compression.
std::vector<std::string> loads_in_tension(const Case& c) {
  std::vector<std::string> loads;
  if (c.model.kind != ModelKind::Platen) return loads;
  for (const Record* record : moving_records(c))
    if (const std::string text = tension_in(*record); !text.empty())
      loads.push_back(fmt::format("{}: {}.", record->name, text));
  return loads;
}

// A displacement that hardly any machine reaches may be in another unit.
std::vector<std::string> doubtful_units(const Case& c) {
  std::vector<std::string> doubts;
  for (const Record* record : moving_records(c))
    for (const auto& channel : record->channels) {
      const std::string family = family_of(channel.role);
      if (channel.unit != "m" || (family != "displacement" && family != "command")) continue;
      const double most = maths::largest_magnitude(channel.values);
      if (most > kFurthest)
        doubts.push_back(fmt::format("{}: {} reaches {:.3g} m. Check its unit in [channels].",
                                     record->name, channel.role, most));
    }
  return doubts;
}

// The errors of a relation are errors of filtered signals.
std::string filter_of(const RelationFindings& found) {
  const Drive& drive = found.problem->drive(0);
  if (!drive.has_time)
    return fmt::format(
        "{}: rows without time are compared, so that no effect of rates was examined.",
        found.relation->name());
  const std::string rate = fmt::format("{:.4g} Hz", 1 / drive.time_step);
  return drive.cutoff > 0 ? fmt::format(
                                "{}: errors are those of signals below {:.3g} Hz, compared at {}; "
                                "measurement and prediction pass the same filter.",
                                found.relation->name(), drive.cutoff, rate)
                          : fmt::format("{}: signals are compared at {}, without a filter.",
                                        found.relation->name(), rate);
}

// Largest displacement and velocity, by name of the state.
using Largest = std::vector<std::pair<StateName, std::pair<double, double>>>;

void add_largest(const Drive& drive, Largest& largest) {
  if (drive.displacement.size() == 0) return;
  for (std::size_t i = 0; i < drive.state_names.size(); ++i) {
    const auto output = static_cast<Index>(i);
    const double u = drive.displacement.col(output).cwiseAbs().maxCoeff();
    const double v = drive.velocity.col(output).cwiseAbs().maxCoeff();
    const auto known = std::find_if(largest.begin(), largest.end(), [&](const auto& one) {
      return one.first.name == drive.state_names[i].name;
    });
    if (known == largest.end())
      largest.push_back({drive.state_names[i], {u, v}});
    else
      known->second = {std::max(known->second.first, u), std::max(known->second.second, v)};
  }
}

// The largest states of all records, once for each name.
std::vector<std::string> visited_in(const RelationFindings& found) {
  Largest largest;
  for (const Problem* problem : {found.problem.get(), found.held_out.get()})
    for (std::size_t i = 0; problem != nullptr && i < problem->records(); ++i)
      add_largest(problem->drive(i), largest);
  std::vector<std::string> limits;
  for (const auto& [state, most] : largest) {
    const std::string rate = found.problem->drive(0).has_time
                                 ? fmt::format(" and {:.3g} {}/s", most.second, state.unit)
                                 : "";
    limits.push_back(fmt::format("{}: states beyond {:.3g} {}{} of {} were never visited.",
                                 found.relation->name(), most.first, state.unit, rate, state.name));
  }
  return limits;
}

// The first section of a record, from its start or to its end, in which nothing that drives the
// test moves [s].
std::optional<std::pair<double, double>> apparent_rest(const Record& record,
                                                       const std::vector<Record>& records) {
  constexpr double kStill = 2e-3;       // of the range of a channel
  constexpr double kShortest = 0.5;     // [s]
  constexpr std::size_t kFewest = 100;  // samples
  const std::size_t n = record.samples();
  std::size_t head = n, tail = n;  // samples at rest
  bool is_driven = false;
  for (const auto& channel : record.channels) {
    const std::string family = family_of(channel.role);
    if (family != "displacement" && family != "command" && family != "input") continue;
    const auto& x = channel.values;
    const auto [least, most] = std::minmax_element(x.begin(), x.end());
    if (!(*most > *least)) continue;
    is_driven = true;
    const double still = kStill * (*most - *least);
    const auto samples_within = [&](const auto& from, const auto& to) {
      return static_cast<std::size_t>(
          std::find_if(from, to,
                       [&, first = *from](double v) { return std::abs(v - first) > still; }) -
          from);
    };
    head = std::min(head, samples_within(x.begin(), x.end()));
    tail = std::min(tail, samples_within(x.rbegin(), x.rend()));
  }
  const auto is_enough = [&](std::size_t samples) {
    return is_driven && samples >= kFewest &&
           static_cast<double>(samples) * record.time_step >= kShortest;
  };
  const auto at = [&](std::size_t sample) {
    return record.start + static_cast<double>(sample) * record.time_step;
  };
  // The motion begins slowly: the section ends where all of it is at rest.
  const auto is_at_rest = [&](std::size_t from, std::size_t to) {
    return motion_at_rest(record, {from, to}, records).empty();
  };
  for (; is_enough(head); head -= std::max<std::size_t>(1, head / 200))
    if (is_at_rest(0, head)) return std::pair{at(0), at(head - 1)};
  for (; is_enough(tail); tail -= std::max<std::size_t>(1, tail / 200))
    if (is_at_rest(n - tail, n)) return std::pair{at(n - tail), at(n - 1)};
  return std::nullopt;
}

// How to measure the noise, if no section at rest is known: with the first section of a record that
// seems to be at rest.
std::string remedy_for_noise(const Case& c) {
  constexpr double kPerSecond = 100;  // resolution of the proposal
  if (!moving_records(c)[0]->has_time)
    return "a record without motion (use = \"reference\") would measure the noise";
  for (const Record* record : moving_records(c))
    if (const auto rest = apparent_rest(*record, c.records))
      return fmt::format(
          "{0} seems to be at rest from {1:.13g} to {2:.13g} s: if it is, quiet_s = [{1:.13g}, "
          "{2:.13g}] in "
          "its "
          "[[record]] measures the noise",
          record->name, std::ceil(kPerSecond * rest->first) / kPerSecond,
          std::floor(kPerSecond * rest->second) / kPerSecond);
  return "a section without motion (quiet_s) or a record without motion (use = \"reference\") "
         "would measure the noise";
}

}  // namespace

std::vector<std::string> limits_of_channels(const Case& c) {
  std::vector<std::string> limits;
  const Record& record = *moving_records(c)[0];
  const auto lacks = [&](const char* family) { return !has_family(record, family); };
  if (is_composition(c.model.kind)) {
    if (lacks("acceleration"))
      limits.emplace_back(
          "No acceleration was recorded: estimates of inertia use displacement alone, and the "
          "accelerometer's faults are not checked.");
    if (lacks("vertical_force") && c.model.kind != ModelKind::ServoAxis)
      limits.emplace_back(
          "No vertical force was recorded: effects that depend on it cannot be distinguished from "
          "others.");
    if (lacks("temperature") && c.model.kind == ModelKind::Bearing)
      limits.emplace_back("No temperature was recorded.");
    if (lacks("command"))
      limits.emplace_back("No command was recorded: actuators were not checked.");
  }
  if (const std::string rest = short_rest(c); !rest.empty()) limits.push_back(rest);
  for (auto& load : loads_in_tension(c)) limits.push_back(std::move(load));
  if (const std::string unused = unused_channels(c); !unused.empty()) limits.push_back(unused);
  for (auto& doubt : doubtful_units(c)) limits.push_back(std::move(doubt));
  return limits;
}

std::vector<std::string> opposed_outputs(const Relation& relation,
                                         const std::vector<const Record*>& records) {
  constexpr double kOpposed = -0.5;  // correlation
  std::vector<std::string> opposed;
  for (const Record* record : records) {
    const auto drive = relation.prepare(*record);
    MatrixXd prediction;
    std::vector<MatrixXd> none;
    if (!relation.simulator(relation.base(), *drive)
             ->run(relation.base().values, {}, prediction, none))
      continue;
    const MatrixXd stated = centred(drive->compared_rows(prediction));
    const MatrixXd measured = centred(drive->compared_rows(drive->measured));
    for (Index i = 0; i < measured.cols(); ++i) {
      const double correlation = stated.col(i).normalized().dot(measured.col(i).normalized());
      if (correlation < kOpposed)
        opposed.push_back(fmt::format(
            "{}: {} opposes the prediction of the stated model (correlation {:.2f}): is its sign "
            "right? \"-column [unit]\" in [channels] reverses it.",
            record->name, relation.outputs()[static_cast<std::size_t>(i)].first, correlation));
    }
  }
  return opposed;
}

std::string pieces_for(const Split& split) {
  return fmt::format(
      "{} hardly varies in some of the records that would score each other, so that they determine "
      "no law of it: pieces of all these records score each other.",
      split.undetermined);
}

NoiseBasis noise_basis(const Case& c, const SensorNoise& noise) {
  return {noise.source(), noise.was_seen_at_rest() ? "" : remedy_for_noise(c),
          !noise.was_seen_at_rest() && !c.noise.empty()};
}

std::vector<std::string> limits_of(const Case& c, const SensorNoise& noise,
                                   const AllFindings& all) {
  const NoiseBasis basis = noise_basis(c, noise);
  std::vector<std::string> limits{"Source of the noise: " + basis.source + "."};
  const auto add = [&](std::vector<std::string> more) {
    std::move(more.begin(), more.end(), std::back_inserter(limits));
  };
  for (const auto& line : noise.lines())
    limits.push_back(line + ": it counts as an effect, not as noise.");
  if (const std::string faster = faster_at_rest(c); noise.was_seen_at_rest() && !faster.empty())
    limits.push_back(faster);
  if (!basis.remedy.empty())
    limits.push_back(
        "The noise was not measured at rest, so a small missing effect cannot "
        "be told from noise: " +
        basis.remedy + ".");
  add(limits_of_channels(c));
  for (const auto& one : c.records)
    if (!one.gaps.empty()) limits.push_back(gaps_in(one));
  if (!all.back()->split.undetermined.empty()) limits.push_back(pieces_for(all.back()->split));
  if (!all.back()->proof.is_held_out) limits.emplace_back("No record was held out for a proof.");
  for (const auto& found : all) {
    if (!found->selection.is_complete)
      limits.push_back(
          fmt::format("{}: the search ended after {:.0f} million simulated steps, before all terms "
                      "and forms were tried; shorter records, or fewer terms by --without, let it "
                      "end.",
                      found->relation->name(), 1e-6 * kMostSteps));
    add(found->relation->notes());
    limits.push_back(filter_of(*found));
    add(visited_in(*found));
    add(opposed_outputs(*found->relation, moving_records(c)));
  }
  return limits;
}

}  // namespace rths::diagnosis
