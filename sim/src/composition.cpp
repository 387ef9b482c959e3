// SPDX-License-Identifier: Apache-2.0
#include <rths/sim/composition.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>

namespace rths::sim {
namespace {

// The first states of a composition hold the hysteretic force and the specimen's force of the
// previous step.
constexpr std::size_t kSharedStates = std::size_t{2} * kHorizontalAxes;

std::size_t index_of_parameter(const TermKind& kind, const std::string& name) {
  return static_cast<std::size_t>(&parameter_of(kind, name) - kind.parameters.data());
}

std::vector<double> parameters_of(const TermKind& kind, const TermSettings& settings) {
  std::vector<double> values;
  for (const auto& parameter : kind.parameters) values.push_back(parameter.absent);
  for (const auto& [name, value] : settings.parameters) {
    const std::size_t i = index_of_parameter(kind, name);
    const Parameter& parameter = kind.parameters[i];
    if (!(value >= parameter.low && value <= parameter.high))
      throw Error{fmt::format("term '{}': {} is {}, expected {} to {}", name_of(settings),
                              parameter_key(parameter, settings.channel), value, parameter.low,
                              parameter.high)};
    values[i] = value;
  }
  return values;
}

void check(const TermKind& kind, const TermSettings& settings) {
  if (settings.axes == 0 || settings.axes > kBothAxes)
    throw Error{
        fmt::format("term '{}' acts on no axis, expected long, lat or both", name_of(settings))};
  if (settings.axes != kBothAxes && !may_act_on_one_axis(kind))
    throw Error{
        fmt::format("term '{}' couples both axes; it cannot be limited to one", name_of(settings))};
  if (settings.channel != SensorChannel::Force && (kind.traits & kPerChannel) == 0)
    throw Error{
        fmt::format("term '{}' is not a sensor term; it has no channel", name_of(settings))};
  if (settings.channel == SensorChannel::AxialLoad &&
      (settings.axes != kBothAxes || (kind.traits & kPerAxis) == 0))
    throw Error{fmt::format("term '{}' acts on single axes, but the axial load has none",
                            name_of(settings))};
}

template <class Real>
struct HorizontalMotion {
  Horizontal<Real> displacement, velocity, acceleration;
};

// A law of both axes that acts on one of them sees no motion of the other.
template <class Real>
class OtherAxisAtRest {
 public:
  OtherAxisAtRest(const Composition::Term& term, Quantities<Real>& q) noexcept : q_{q} {
    if (term.axes == kBothAxes || (term.kind->traits & kPerAxis) != 0) return;
    whole_.emplace(HorizontalMotion<Real>{q.displacement, q.velocity, q.acceleration});
    for (std::size_t axis = 0; axis < kHorizontalAxes; ++axis)
      if ((term.axes >> axis & 1U) == 0)
        q.displacement[axis] = q.velocity[axis] = q.acceleration[axis] = Real{};
  }
  ~OtherAxisAtRest() {
    if (!whole_) return;
    q_.displacement = whole_->displacement;
    q_.velocity = whole_->velocity;
    q_.acceleration = whole_->acceleration;
  }
  OtherAxisAtRest(const OtherAxisAtRest&) = delete;
  OtherAxisAtRest& operator=(const OtherAxisAtRest&) = delete;

 private:
  Quantities<Real>& q_;
  std::optional<HorizontalMotion<Real>> whole_;
};

template <class Real>
void run(const Composition& composition, std::span<const double> constants, const Real* parameters,
         std::span<Real> state, Quantities<Real>& q) noexcept {
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    q.last_hysteretic_force[i] = state[i];
    q.last_specimen_force[i] = state[kHorizontalAxes + i];
  }
  const auto terms = composition.terms();
  auto term = terms.begin();
  const auto advance_through = [&](Stage last) {
    for (; term != terms.end() && term->kind->stage <= last; ++term) {
      const TermView<Real> view{parameters + term->first_parameter,
                                constants.data() + term->first_constant,
                                state.data() + term->first_state,
                                composition.time_step(),
                                term->axes,
                                term->channel};
      const OtherAxisAtRest<Real> hidden{*term, q};
      if constexpr (std::is_same_v<Real, double>)
        term->kind->step(view, q);
      else
        term->kind->step_dual(view, q);
    }
  };
  advance_through(Stage::Actuator);
  // Only a mount moves the specimen otherwise than the platen; a copy would cost as much as a term.
  std::optional<HorizontalMotion<Real>> platen;
  if (term != terms.end() && term->kind->stage == Stage::Motion)
    platen.emplace(HorizontalMotion<Real>{q.displacement, q.velocity, q.acceleration});
  advance_through(Stage::Restoring);
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) {
    state[i] = q.hysteretic_force[i];
    state[kHorizontalAxes + i] = q.force[i];
  }
  if (platen) {
    q.displacement = platen->displacement;
    q.velocity = platen->velocity;
    q.acceleration = platen->acceleration;
  }
  advance_through(Stage::Sensor);
}

constexpr std::string_view kStages[] = {"actuator",  "motion",  "vertical", "modifier",
                                        "restoring", "machine", "sensor"};

bool is_of_a_specimen(Stage stage) {
  return stage == Stage::Vertical || stage == Stage::Modifier || stage == Stage::Restoring;
}

// In the order of SensorChannel.
constexpr ChannelName kChannels[] = {
    {"force", "N"}, {"displacement", "m"}, {"acceleration", "m/s2"}, {"axial_load", "N"}};

unsigned read_axes(const Config& table, const TermKind& kind) {
  if (!table.has("axes")) return kBothAxes;
  if (!may_act_on_one_axis(kind))
    table.fail("axes",
               fmt::format("'{}' couples both axes; it cannot be limited to one", kind.name));
  unsigned axes = 0;
  for (const auto& axis : table.texts("axes")) {
    const auto found = horizontal_axis_named(axis);
    if (!found)
      table.fail("axes", fmt::format("axis '{}' is not known, expected long or lat", axis));
    axes |= 1U << index_of(*found);
  }
  if (axes == 0) table.fail("axes", "axes is empty, expected long, lat or both");
  return axes;
}

SensorChannel read_channel(const Config& table, const TermKind& kind) {
  if (!table.has("channel")) return SensorChannel::Force;
  if ((kind.traits & kPerChannel) == 0)
    table.fail("channel", fmt::format("'{}' has no selectable channel", kind.name));
  const std::string name = table.text("channel");
  for (std::size_t i = 0; i < std::size(kChannels); ++i) {
    if (kChannels[i].channel != name) continue;
    const auto channel = static_cast<SensorChannel>(i);
    if (channel == SensorChannel::AxialLoad && (kind.traits & kPerAxis) == 0)
      table.fail("channel", fmt::format("'{}' acts between the horizontal axes; the axial load has "
                                        "no axes",
                                        kind.name));
    if (channel == SensorChannel::AxialLoad && table.has("axes"))
      table.fail("axes", "axes is set, but the axial load has no axes");
    return channel;
  }
  table.fail("channel", fmt::format("channel is '{}', expected force, displacement, acceleration "
                                    "or axial_load",
                                    name));
}

// The values of a key: none, one for both axes, or one per axis.
std::vector<double> read_values(const Config& table, const std::string& key, const TermKind& kind,
                                SensorChannel channel) {
  if (!table.has(key)) return {};
  if (!table.is_array(key)) return {table.number(key)};
  auto values = table.numbers(key);
  if (channel == SensorChannel::AxialLoad)
    table.fail(key, fmt::format("{} is an array, but the axial load has no axes", key));
  if (table.has("axes"))
    table.fail(key,
               fmt::format("{} is an array [long, lat] and axes is set: expected only one of the "
                           "two",
                           key));
  if ((kind.traits & kPerAxis) == 0)
    table.fail(key, fmt::format("{} is an array, but '{}' couples both axes", key, kind.name));
  if (values.size() != kHorizontalAxes)
    table.fail(key, fmt::format("{} has {} numbers, expected [long, lat]", key, values.size()));
  return values;
}

void check_bounds(const Config& table, const std::string& key, const Parameter& parameter,
                  double value) {
  if (!(value >= parameter.low && value <= parameter.high))
    table.fail(
        key, fmt::format("{} is {}, expected {} to {}", key, value, parameter.low, parameter.high));
}

// The same term once for each axis.
std::vector<TermSettings> by_axis(const TermSettings& settings) {
  std::vector<TermSettings> axes(kHorizontalAxes, settings);
  for (std::size_t i = 0; i < axes.size(); ++i) {
    axes[i].name += fmt::format(".{}", name_of(kHorizontal[i]));
    axes[i].axes = 1U << i;
  }
  return axes;
}

// One term, or one per axis if a parameter is an array.
std::vector<TermSettings> read_term(const std::string& name, const Config& table,
                                    ParameterBounds bounds) {
  TermSettings settings;
  settings.kind = table.text("kind", name);
  settings.name = name;
  const TermKind& kind =
      table.placed("kind", [&]() -> const TermKind& { return term_kind(settings.kind); });
  const bool enabled = table.flag("enabled", true);
  settings.axes = read_axes(table, kind);
  settings.channel = read_channel(table, kind);
  std::vector<TermSettings> axes;
  for (const auto& parameter : kind.parameters) {
    const std::string key = parameter_key(parameter, settings.channel);
    const auto values = read_values(table, key, kind, settings.channel);
    for (const double value : values)
      if (bounds == ParameterBounds::Catalogue) check_bounds(table, key, parameter, value);
    if (values.size() == kHorizontalAxes && axes.empty()) axes = by_axis(settings);
    if (values.empty()) continue;
    settings.parameters.emplace_back(parameter.name, values[0]);
    for (std::size_t i = 0; i < axes.size(); ++i)
      axes[i].parameters.emplace_back(parameter.name, values[std::min(i, values.size() - 1)]);
  }
  table.reject_unknown_keys();
  if (!enabled) return {};
  return axes.empty() ? std::vector{settings} : axes;
}

}  // namespace

const std::string& name_of(const TermSettings& settings) {
  return settings.name.empty() ? settings.kind : settings.name;
}

Composition::Composition(const std::vector<TermSettings>& settings, double time_step)
    : time_step_{time_step}, states_{kSharedStates} {
  if (!(time_step > 0) || !std::isfinite(time_step))
    throw Error{
        fmt::format("time step of a composition is {}, expected a positive number", time_step)};
  struct Wanted {
    const TermKind* kind;
    const TermSettings* settings;
  };
  std::vector<Wanted> wanted;
  std::set<std::string> names;
  for (const auto& term : settings) {
    wanted.push_back({&term_kind(term.kind), &term});
    check(*wanted.back().kind, term);
    if (!names.insert(name_of(term)).second)
      throw Error{fmt::format("two terms have the name '{}'", name_of(term))};
  }
  std::ranges::stable_sort(wanted, [](const auto& a, const auto& b) { return a.kind < b.kind; });
  for (const auto& [kind, term] : wanted) {
    const auto values = parameters_of(*kind, *term);
    const TermSetup setup{values, kind->parameters, time_step};
    const TermSize size = kind->size(setup);
    terms_.push_back({kind, name_of(*term), term->axes, term->channel, parameters_.size(), states_,
                      constants_.size()});
    parameters_.insert(parameters_.end(), values.begin(), values.end());
    constants_.resize(constants_.size() + size.constants);
    states_ += size.states;
    kind->prepare(setup, std::span{constants_}.last(size.constants));
  }
}

std::size_t Composition::parameter_index(const std::string& term,
                                         const std::string& parameter) const {
  for (const auto& candidate : terms_)
    if (candidate.name == term)
      return candidate.first_parameter + index_of_parameter(*candidate.kind, parameter);
  throw Error{fmt::format("there is no term '{}' in this composition", term)};
}

void Composition::set_specimen_force(std::span<double> state,
                                     const Horizontal<double>& force) const noexcept {
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) state[kHorizontalAxes + i] = force[i];
}

void Composition::set_specimen_force(std::span<Dual> state,
                                     const Horizontal<double>& force) const noexcept {
  for (std::size_t i = 0; i < kHorizontalAxes; ++i) state[kHorizontalAxes + i] = force[i];
}

void Composition::advance(std::span<const double> parameters, std::span<double> state,
                          Quantities<double>& q) const noexcept {
  run(*this, constants_, parameters.data(), state, q);
}

void Composition::advance(std::span<const Dual> parameters, std::span<Dual> state,
                          Quantities<Dual>& q) const noexcept {
  run(*this, constants_, parameters.data(), state, q);
}

const ChannelName& name_of(SensorChannel channel) {
  return kChannels[static_cast<std::size_t>(channel)];
}

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

std::string parameter_key(const Parameter& parameter, SensorChannel channel) {
  std::string unit{parameter.unit};
  if (unit.starts_with(kChannelUnit)) unit.replace(0, kChannelUnit.size(), name_of(channel).unit);
  if (unit == "-") return std::string{parameter.name};
  std::string key = fmt::format("{}_", parameter.name);
  for (const char c : unit) {
    if (c == '/')
      key += "_per_";
    else
      key += c == '*' ? '_' : c;
  }
  return key;
}

std::vector<TermSettings> read_terms(const Config& table, TermOwner owner, ParameterBounds bounds) {
  std::vector<TermSettings> terms;
  for (const auto& key : table.keys()) {
    if (!table.is_table(key)) continue;
    const auto read = read_term(key, table.table(key), bounds);
    for (const auto& term : read) table.placed(key, [&] { check_owner(term, owner); });
    terms.insert(terms.end(), read.begin(), read.end());
  }
  return terms;
}

}  // namespace rths::sim
