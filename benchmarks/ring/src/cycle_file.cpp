// SPDX-License-Identifier: Apache-2.0
#include "cycle_file.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

using nlohmann::json;

json to_json(const Times& times) { return {times.p50, times.p99}; }

Times times_from(const json& pair) { return {pair.at(0), pair.at(1)}; }

json to_json(const Outcome& outcome) {
  if (!outcome.pairing) return {{"missing", outcome.missing}};
  return {{"measured", to_json(outcome.pairing->measured)},
          {"reference", to_json(outcome.pairing->reference)},
          {"raw", outcome.pairing->raw}};
}

Outcome outcome_from(const json& kept) {
  if (kept.contains("missing")) return {std::nullopt, kept["missing"]};
  return {Pairing{times_from(kept.at("measured")), times_from(kept.at("reference")),
                  kept.at("raw").get<double>()},
          ""};
}

Cycle cycle_from(const json& kept) {
  Cycle cycle;
  cycle.load = {kept.at("load").at("other"), kept.at("load").at("steal")};
  for (const auto& [name, outcome] : kept.at("rows").items())
    cycle.outcomes[name] = outcome_from(outcome);
  return cycle;
}

}  // namespace

CycleFile::CycleFile(const std::filesystem::path& folder, int number, std::uint32_t round_trips)
    : path_{folder.empty() ? folder : folder / fmt::format("cycle-{:02}.json", number)},
      round_trips_{round_trips} {}

// An unreadable file counts as missing: the cycle is measured again and the file replaced.
std::optional<Cycle> CycleFile::read(const std::vector<Row>& rows) const {
  std::ifstream file{path_};
  if (path_.empty() || !file) return std::nullopt;
  try {
    const json kept = json::parse(file);
    if (kept.at("round_trips") != round_trips_) return std::nullopt;
    Cycle cycle = cycle_from(kept);
    // A row that was missing is measured again: its package may be installed now.
    const bool whole = std::all_of(rows.begin(), rows.end(), [&](const Row& row) {
      const auto outcome = cycle.outcomes.find(row.name);
      return outcome != cycle.outcomes.end() && outcome->second.pairing;
    });
    return whole ? std::optional{std::move(cycle)} : std::nullopt;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

void CycleFile::write(const Cycle& cycle) const {
  if (path_.empty()) return;
  json kept = {{"round_trips", round_trips_},
               {"load", {{"other", cycle.load.other}, {"steal", cycle.load.steal}}}};
  for (const auto& [name, outcome] : cycle.outcomes) kept["rows"][name] = to_json(outcome);
  std::filesystem::create_directories(path_.parent_path());
  // Renames a finished file, so that an interruption leaves no incomplete one.
  const auto unfinished = std::filesystem::path{path_} += ".tmp";
  std::ofstream{unfinished} << kept.dump(2) << '\n';
  std::error_code problem;
  std::filesystem::rename(unfinished, path_, problem);
  if (problem) throw Error{fmt::format("{}: {}", path_.string(), problem.message())};
}

}  // namespace rths::bench
