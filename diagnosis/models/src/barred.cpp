// SPDX-License-Identifier: Apache-2.0
#include <rths/models/barred.hpp>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/models/dynamic_relation.hpp>
#include <rths/sim/term.hpp>

#include "candidate_terms.hpp"

namespace rths::diagnosis {
namespace {

std::vector<std::string> names_of_library() {
  std::vector<std::string> names;
  for (const auto& kind : sim::catalogue()) {
    names.emplace_back(kind.name);
    if ((kind.traits & sim::kPerChannel) == 0) continue;
    for (const char* channel : {"force", "displacement", "acceleration"})
      names.push_back(fmt::format("{}_{}", channel, kind.name));
  }
  for (const auto& entry : candidate_terms())
    if (!entry.name.empty()) names.emplace_back(entry.name);
  return names;
}

// Adds the errors that parameters of a user's own model may have.
void add_names_of_model(const Case& c, std::vector<std::string>& names) {
  if (is_composition(c.model.kind)) return;
  const auto relation = dynamic_relation(c);
  for (const auto& candidate : relation->candidates(relation->base()))
    names.push_back(candidate.name);
}

}  // namespace

void reject_unknown_terms(const std::vector<std::string>& without, const Case& c) {
  if (without.empty()) return;
  std::vector<std::string> known = names_of_library();
  add_names_of_model(c, known);
  for (const auto& name : without) {
    if (contains(known, name)) continue;
    throw Error{fmt::format("without: there is no term '{}'{}", name, did_you_mean(name, known))};
  }
}

bool is_barred(const std::vector<std::string>& without, const std::string& name,
               const std::string& kind) {
  return contains(without, name) || contains(without, kind);
}

}  // namespace rths::diagnosis
