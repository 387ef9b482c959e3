// SPDX-License-Identifier: Apache-2.0
#include "relations_of_case.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/models/barred.hpp>
#include <rths/models/dynamic_relation.hpp>
#include <rths/models/relations.hpp>
#include <rths/sim/composition.hpp>

#include "check_records.hpp"
#include "report.hpp"

namespace rths::diagnosis {

void check_case(const Case& c, const std::vector<std::string>& without) {
  reject_unknown_terms(without, c);
  if (is_composition(c.model.kind)) check_composed_model(c);
  check_records(c);
  const auto is_prediction = [](const Channel& channel) { return is_predicted(channel.role); };
  if (c.model.table.has("anchor") &&
      std::none_of(c.records.begin(), c.records.end(), [&](const Record& record) {
        return std::any_of(record.channels.begin(), record.channels.end(), is_prediction);
      }))
    c.model.table.fail(
        "anchor", "no record has a predicted channel, expected one as in predicted.force.long");
}

std::vector<RelationOf> relations_of_kind(ModelKind kind) {
  if (is_composition(kind)) return {accelerometer_relation, actuator_relation, force_relation};
  return {dynamic_relation};
}

void throw_without_relation(const Case& c) {
  throw Error{fmt::format("{}: a model of kind '{}' relates no two of the channels", c.name,
                          name_of(c.model.kind))};
}

std::string specimen_of(const Case& given) {
  const bool is_run = given.source.file.has("run") || !given.source.experiment.keys().empty();
  if (is_run || given.model.kind == ModelKind::ServoAxis) return "";
  if (given.model.kind == ModelKind::Bearing) return "specimen";
  if (given.model.kind == ModelKind::Structure) return kStructure;
  if (given.model.kind != ModelKind::Platen) return kSystem;
  // A platen with nothing but springs on it is the tested device itself.
  const auto terms = sim::read_terms(given.model.table.without("bounds"));
  const bool has_bearing = std::any_of(terms.begin(), terms.end(), [](const auto& term) {
    const auto stage = sim::term_kind(term.kind).stage;
    return (stage == sim::Stage::Restoring || stage == sim::Stage::Modifier) &&
           !term.kind.ends_with("_stiffness");
  });
  return has_bearing ? "" : "device";
}

}  // namespace rths::diagnosis
