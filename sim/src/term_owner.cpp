// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/composition.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

constexpr std::string_view kStages[] = {"actuator",  "motion",  "vertical", "modifier",
                                        "restoring", "machine", "sensor"};

bool is_of_a_specimen(Stage stage) {
  return stage == Stage::Vertical || stage == Stage::Modifier || stage == Stage::Restoring;
}

}  // namespace

std::string_view stage_name(Stage stage) { return kStages[static_cast<std::size_t>(stage)]; }

void check_owner(const TermSettings& term, TermOwner owner) {
  const TermKind& kind = term_kind(term.kind);
  const std::string& name = name_of(term);
  if (owner != TermOwner::Any && (kind.traits & kControlled) != 0)
    throw Error{
        fmt::format("term '{}' needs a control current, an input that neither specimens nor "
                    "machines have",
                    name)};
  if (owner == TermOwner::Machine && is_of_a_specimen(kind.stage))
    throw Error{
        fmt::format("term '{}' belongs to the specimen (stage {}), expected one of the stages "
                    "actuator, motion, machine or sensor",
                    name, stage_name(kind.stage))};
  if (owner != TermOwner::Specimen) return;
  if (kind.stage == Stage::Actuator || kind.stage == Stage::Sensor)
    throw Error{fmt::format("term '{}' belongs to the machine (stage {}), not to a specimen", name,
                            stage_name(kind.stage))};
  // A specimen's acceleration is unknown until its force has been computed.
  if ((kind.traits & kInertial) != 0)
    throw Error{
        fmt::format("term '{}' needs the acceleration, an input that a specimen does not have; it "
                    "belongs to the machine",
                    name)};
}

}  // namespace rths::sim
