// SPDX-License-Identifier: Apache-2.0
#include "library.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/models/barred.hpp>

#include "motion_drive.hpp"
#include "unit_scales.hpp"

namespace rths::diagnosis {
namespace {

using sim::TermKind;

constexpr std::string_view kHysteretic[] = {
    "bouc_wen", "bouc_wen_nagarajaiah", "bouc_wen_slip",   "bilinear",
    "iwan",     "flat_slider",          "single_pendulum", "triple_pendulum"};
constexpr std::string_view kSliders[] = {"flat_slider", "single_pendulum"};
constexpr std::string_view kBuckling[] = {"buckling_load_variation"};
constexpr std::string_view kServoLoops[] = {"actuator_bandwidth"};
constexpr std::string_view kRuled = "bouc_wen";
constexpr int kPriceOfRule = 4;
// Of a slider under its mean load. The recording shows the product of the area and the pressure at
// which friction changes, not the two.
constexpr double kContactPressure = 50e6;
// A branch may relax within a record of any length, whatever the rate of its rows.
constexpr double kUsualDuration = 40;  // [s]

template <class Names>
bool holds(const Hypothesis& base, const Names& kinds) {
  return std::any_of(base.terms.begin(), base.terms.end(), [&](const ModelTerm& term) {
    return std::find(std::begin(kinds), std::end(kinds), term.settings.kind) != std::end(kinds);
  });
}

sim::SensorChannel channel_at(Place place) {
  if (place == kOnActuator) return sim::SensorChannel::Displacement;
  return place == kOnAccelerometer ? sim::SensorChannel::Acceleration : sim::SensorChannel::Force;
}

const sim::ChannelName& channel_name(Place place) { return sim::name_of(channel_at(place)); }

bool is_on_channel(const TermKind& kind) { return (kind.traits & sim::kPerChannel) != 0; }

// Whether a kind's name needs the channel to be clear.
bool needs_channel_in_name(std::string_view kind) {
  return !kind.starts_with("absolute") && !kind.starts_with("crosstalk") &&
         !kind.starts_with("accelerometer");
}

Part part_of(const TermKind& kind) {
  switch (kind.stage) {
    case sim::Stage::Actuator:
      return Part::Actuator;
    case sim::Stage::Motion:
    case sim::Stage::Machine:
      return Part::Machine;
    case sim::Stage::Sensor:
      return Part::Sensor;
    default:
      return Part::Bearing;
  }
}

// Makes the candidate of an entry.
class Builder {
 public:
  Builder(const CandidateTerm& entry, Place place, const Hypothesis& base,
          const NaturalScale& scale, std::vector<std::size_t> axes)
      : entry_{entry},
        place_{place},
        kind_{sim::term_kind(entry.kind)},
        base_{base},
        scale_{scale},
        axes_{std::move(axes)} {}

  [[nodiscard]] std::vector<Candidate> build() {
    if (!fits_case()) return {};
    candidate_.kind = kind_.name;
    candidate_.name = entry_.name.empty() ? kind_.name : entry_.name;
    if (is_on_channel(kind_) && needs_channel_in_name(kind_.name))
      candidate_.name = fmt::format("{}_{}", channel_name(place_).channel, kind_.name);
    candidate_.title = entry_.title.empty() ? kind_.title : entry_.title;
    if (is_on_channel(kind_))
      candidate_.title = fmt::format("{} ({})", kind_.title, channel_name(place_).channel);
    // Titles of controlled devices speak of a current.
    constexpr std::string_view kControl = "current";
    if (const auto at = candidate_.title.find(kControl);
        (kind_.traits & sim::kControlled) != 0 && at != std::string::npos)
      candidate_.title.replace(at, kControl.size(), scale_.auxiliary_name);
    candidate_.equation = kind_.equation;
    candidate_.part = part_of(kind_);
    candidate_.channel = channel_name(place_).channel;
    const auto there = in_model();
    const bool must_be_there = (entry_.needs & CandidateTerm::kKindInModel) != 0;
    if ((entry_.needs & CandidateTerm::kInstead) != 0)
      replace_kind();
    else if (!there.empty() && (entry_.needs & CandidateTerm::kBeside) == 0)
      free_existing(there);
    else if (!must_be_there || !there.empty())
      add();
    if (candidate_.frees.empty()) return {};
    candidate_.price = static_cast<int>(candidate_.frees.size());
    candidate_.is_rule = (entry_.needs & CandidateTerm::kRule) != 0;
    // The rule is blamed only if nothing else explains as much.
    if (candidate_.is_rule) candidate_.price += kPriceOfRule;
    candidate_.is_hidden = (entry_.needs & CandidateTerm::kHidden) != 0;
    candidate_.corrects_form = (entry_.needs & CandidateTerm::kCorrectsForm) != 0;
    candidate_.contains.assign(entry_.contains.begin(), entry_.contains.end());
    if (entry_.waits) candidate_.after = candidate_.contains;
    return {candidate_};
  }

 private:
  [[nodiscard]] std::vector<const sim::TermSettings*> in_model() const {
    std::vector<const sim::TermSettings*> found;
    for (const auto& term : base_.terms)
      if (term.settings.kind == kind_.name &&
          (!is_on_channel(kind_) || term.settings.channel == channel_at(place_)))
        found.push_back(&term.settings);
    return found;
  }
  [[nodiscard]] bool is_free(const std::string& name) const {
    return std::any_of(base_.free.begin(), base_.free.end(), [&](const FreeParameter& free) {
      return !free.is_tolerance && (name == free.name || free.name == without_axis(name));
    });
  }
  // "friction.force" refers to "friction.long.force" too.
  static std::string without_axis(const std::string& name) {
    std::string plain = name;
    for (std::size_t axis = 0; axis < sim::kHorizontalAxes; ++axis) {
      const std::string middle = "." + axis_name(axis) + ".";
      if (const auto at = plain.find(middle); at != std::string::npos)
        plain.replace(at, middle.size(), ".");
    }
    return plain;
  }
  [[nodiscard]] double unit(const sim::Parameter& parameter) const {
    if (parameter.name == "reference_load") return scale_.axial_load;
    if (parameter.unit == "Pa") return kContactPressure;
    if (parameter.name == "relaxation_time") return scale_.duration / kUsualDuration;
    if (parameter.name == "contact_area" && (entry_.needs & CandidateTerm::kAxialLoad) != 0)
      return scale_.axial_load / kContactPressure;
    return natural_unit(parameter.unit, scale_);
  }

  [[nodiscard]] FreeParameter free(const std::string& name,
                                   const CandidateParameter& specification) const {
    const sim::Parameter& parameter = parameter_of(kind_, specification.name);
    const double natural = unit(parameter);
    const UnitSymbols symbols{"m", "N", scale_.auxiliary_unit};
    FreeParameter result{name, symbols.of(parameter.unit), parameter.low, parameter.high, 1};
    if (result.unit.starts_with(sim::kChannelUnit))
      result.unit.replace(0, sim::kChannelUnit.size(), channel_name(place_).unit);
    if (specification.low < specification.high) {
      result.low = std::max(result.low, specification.low * natural);
      result.high = std::min(result.high, specification.high * natural);
    }
    const double start = specification.starts[0] * natural;
    // A limit is absent at a value far beyond all others, which is no measure of a change.
    const double away = std::min(std::abs(start - parameter.absent), std::abs(start));
    if (specification.role == CandidateParameter::Role::Size) result.absent = parameter.absent;
    result.scale =
        specification.role == CandidateParameter::Role::Shape ? std::abs(start) / 2 : away;
    if (!(result.scale > 0)) result.scale = 0.1 * natural;
    return result;
  }

  [[nodiscard]] bool is_fitted(const CandidateParameter& specification) const {
    if (!scale_.has_time && specification.name == kCreepVelocity) return false;
    return specification.role == CandidateParameter::Role::Size ||
           specification.role == CandidateParameter::Role::Shape;
  }
  // Of a parameter that is not fitted.
  [[nodiscard]] double stated(const CandidateParameter& specification) const {
    const sim::Parameter& parameter = parameter_of(kind_, specification.name);
    if (specification.name == kCreepVelocity) return parameter.low;
    return specification.role == CandidateParameter::Role::Typical
               ? parameter.typical
               : specification.starts[0] * unit(parameter);
  }

  // Whether the values that are not fitted lie within the bounds of the catalogue. A case of very
  // small forces or motions has no use for the others.
  [[nodiscard]] bool fits_case() const {
    return std::all_of(entry_.parameters.begin(), entry_.parameters.end(), [&](const auto& one) {
      if (is_fitted(one)) return true;
      const sim::Parameter& parameter = parameter_of(kind_, one.name);
      const double value = stated(one);
      return value >= parameter.low && value <= parameter.high;
    });
  }

  // Frees parameters of terms that the model has.
  void free_existing(const std::vector<const sim::TermSettings*>& there) {
    std::vector<double> values;
    // Parameters at which the term lacks an effect.
    std::vector<const CandidateParameter*> absent;
    for (const auto* term : there)
      for (const auto& specification : entry_.parameters) {
        if (!is_fitted(specification)) continue;
        const std::string name = fmt::format("{}.{}", term->name, specification.name);
        if (is_free(name)) continue;
        FreeParameter parameter = free(name, specification);
        const double value = value_in(*term, specification);
        if (!entry_.name.empty() && value == parameter_of(kind_, specification.name).absent) {
          candidate_.frees.push_back(parameter);
          absent.push_back(&specification);
          continue;
        }
        center_on(value, specification, parameter);
        parameter.absent = value;
        candidate_.frees.push_back(parameter);
        values.push_back(value);
      }
    if (!absent.empty()) return choose_starts(absent);
    candidate_.starts = {
        Eigen::Map<const VectorXd>(values.data(), static_cast<Index>(values.size()))};
  }
  [[nodiscard]] double value_in(const sim::TermSettings& term,
                                const CandidateParameter& specification) const {
    double value = parameter_of(kind_, specification.name).absent;
    for (const auto& [key, number] : term.parameters)
      if (key == specification.name) value = number;
    return value;
  }
  // Widens the bounds so that they include the value in the model, and scales the parameter by it.
  void center_on(double value, const CandidateParameter& specification,
                 FreeParameter& parameter) const {
    const double outside = 1.5;
    parameter.low = std::min(parameter.low, value / outside);
    parameter.high = std::max(parameter.high, value * outside);
    const auto& limits = parameter_of(kind_, specification.name);
    parameter.low = std::max(parameter.low, limits.low);
    parameter.high = std::min(parameter.high, limits.high);
    if (value != 0) parameter.scale = 0.05 * std::abs(value);
  }

  // Replaces the kind of the first term whose parameters the new kind has too.
  void replace_kind() {
    for (const auto& term : base_.terms) {
      if (term.settings.kind != kRuled || !keeps_parameters(term.settings)) continue;
      candidate_.becomes.emplace_back(term.settings.name, kind_.name);
      std::vector<const CandidateParameter*> specifications;
      for (const auto& specification : entry_.parameters)
        specify(term.settings.name, specification, specifications);
      return choose_starts(specifications);
    }
  }
  [[nodiscard]] bool keeps_parameters(const sim::TermSettings& settings) const {
    return std::all_of(
        settings.parameters.begin(), settings.parameters.end(), [&](const auto& given) {
          return std::any_of(kind_.parameters.begin(), kind_.parameters.end(),
                             [&](const auto& own) { return own.name == given.first; });
        });
  }
  // Frees a parameter of a term.
  void specify(const std::string& term, const CandidateParameter& specification,
               std::vector<const CandidateParameter*>& specifications) {
    candidate_.frees.push_back(free(fmt::format("{}.{}", term, specification.name), specification));
    specifications.push_back(&specification);
  }

  // Adds a term, or one for each axis if a parameter differs between them.
  void add() {
    const bool splits =
        axes_.size() > 1 && (kind_.traits & sim::kPerAxis) != 0 &&
        std::any_of(entry_.parameters.begin(), entry_.parameters.end(),
                    [](const auto& specification) { return specification.each_axis; });
    add_terms(splits);
    std::vector<const CandidateParameter*> specifications;
    for (const auto& specification : entry_.parameters) {
      if (!is_fitted(specification)) continue;
      if (splits && specification.each_axis)
        for (const auto& term : candidate_.adds)
          specify(term.settings.name, specification, specifications);
      else
        specify(candidate_.name, specification, specifications);
    }
    choose_starts(specifications);
  }
  void add_terms(bool splits) {
    sim::TermSettings settings;
    settings.kind = kind_.name;
    settings.name = candidate_.name;
    if (is_on_channel(kind_)) settings.channel = channel_at(place_);
    if (axes_.size() == 1 && (kind_.traits & sim::kPerAxis) != 0) settings.axes = 1U << axes_[0];
    for (const auto& specification : entry_.parameters)
      if (!is_fitted(specification))
        settings.parameters.emplace_back(specification.name, stated(specification));
    if (!splits) {
      candidate_.adds.push_back({settings, ""});
      return;
    }
    for (const std::size_t axis : axes_) {
      sim::TermSettings one = settings;
      one.name += "." + axis_name(axis);
      one.axes = 1U << axis;
      candidate_.adds.push_back({one, ""});
    }
  }

  // Every combination of the parameters' starts.
  void choose_starts(const std::vector<const CandidateParameter*>& specifications) {
    std::vector<VectorXd> starts{VectorXd::Zero(static_cast<Index>(specifications.size()))};
    for (std::size_t i = 0; i < specifications.size(); ++i) {
      std::vector<VectorXd> longer;
      // A parameter of both axes has the same start on both.
      const bool is_twin = i > 0 && specifications[i] == specifications[i - 1];
      const std::size_t count = is_twin ? 1 : specifications[i]->starts.size();
      for (const auto& start : starts)
        for (std::size_t k = 0; k < count; ++k) {
          VectorXd next = start;
          const auto j = static_cast<Index>(i);
          const double natural = unit(parameter_of(kind_, specifications[i]->name));
          next[j] = is_twin ? start[j - 1]
                            : std::clamp(specifications[i]->starts[k] * natural,
                                         candidate_.frees[i].low, candidate_.frees[i].high);
          longer.push_back(next);
        }
      starts = std::move(longer);
    }
    candidate_.starts = std::move(starts);
  }

  const CandidateTerm& entry_;
  Place place_;
  const TermKind& kind_;
  const Hypothesis& base_;
  const NaturalScale& scale_;
  std::vector<std::size_t> axes_;
  Candidate candidate_;
};

bool has_controlled(const Hypothesis& base) {
  return std::any_of(base.terms.begin(), base.terms.end(), [](const ModelTerm& term) {
    const TermKind& kind = sim::term_kind(term.settings.kind);
    return (kind.traits & sim::kControlled) != 0 && kind.stage == sim::Stage::Restoring;
  });
}

bool are_met(const CandidateTerm& entry, const Hypothesis& base, const NaturalScale& scale,
             const std::vector<std::size_t>& axes) {
  const unsigned needs = entry.needs;
  const bool hysteretic = holds(base, kHysteretic);
  return !((needs & CandidateTerm::kAxialLoad) != 0 && scale.axial_load == 0) &&
         !((needs & CandidateTerm::kTwoAxes) != 0 && axes.size() < 2) &&
         !((needs & CandidateTerm::kTemperature) != 0 && !scale.has_temperature) &&
         !((needs & CandidateTerm::kAuxiliary) != 0 && scale.auxiliary == 0) &&
         !((needs & CandidateTerm::kHysteresis) != 0 && !hysteretic) &&
         !((needs & CandidateTerm::kNoHysteresis) != 0 && hysteretic) &&
         !((needs & CandidateTerm::kSlider) != 0 && !holds(base, kSliders)) &&
         !((needs & CandidateTerm::kRule) != 0 && !holds(base, std::array{kRuled})) &&
         !((needs & CandidateTerm::kLoadCell) != 0 && scale.force == 0) &&
         !((needs & CandidateTerm::kControlledTerm) != 0 && !has_controlled(base)) &&
         !((needs & CandidateTerm::kBucklingLoad) != 0 && !holds(base, kBuckling)) &&
         !((needs & CandidateTerm::kNoServoLoop) != 0 && holds(base, kServoLoops));
}

void append_allowed(std::vector<Candidate> candidates, const std::vector<std::string>& without,
                    std::vector<Candidate>& all) {
  for (auto& candidate : candidates)
    if (!is_barred(without, candidate.name, candidate.kind)) all.push_back(std::move(candidate));
}

// The same effect in the place of the model's own special cases of it, which it would compensate.
void add_replacing(const CandidateTerm& entry, const Hypothesis& base,
                   std::vector<Candidate>& candidates) {
  auto replaced = replaced_by(entry, base);
  if (replaced.empty()) return;
  Candidate whole = candidates[0];
  whole.price -= static_cast<int>(replaced.size());
  whole.replaces = std::move(replaced);
  candidates.push_back(std::move(whole));
}

// The same effect on one of several axes. One parameter on both axes is simpler than one on one.
void add_axes(const CandidateTerm& entry, Place place, const Hypothesis& base,
              const std::vector<std::size_t>& axes, const std::vector<NaturalScale>& scales,
              std::vector<Candidate>& candidates) {
  const Candidate all = candidates[0];
  if (axes.size() < 2 || all.adds.empty() ||
      (sim::term_kind(entry.kind).traits & sim::kPerAxis) == 0)
    return;
  for (std::size_t i = 0; i < axes.size(); ++i)
    for (auto& one : Builder{entry, place, base, scales[i], {axes[i]}}.build()) {
      one.axis = axis_name(axes[i]);
      one.title += fmt::format(", {} axis", one.axis);
      if (one.frees.size() == all.frees.size()) ++one.price;
      candidates.push_back(std::move(one));
    }
}

}  // namespace

bool is_hysteretic(std::string_view kind) {
  return std::find(std::begin(kHysteretic), std::end(kHysteretic), kind) != std::end(kHysteretic);
}

std::vector<Candidate> candidates_of(Place place, const Hypothesis& base, const NaturalScale& scale,
                                     const std::vector<std::size_t>& axes,
                                     const std::vector<NaturalScale>& axis_scales,
                                     const std::vector<std::string>& without) {
  std::vector<Candidate> result;
  for (const auto& entry : candidate_terms()) {
    if ((entry.places & place) == 0 || !are_met(entry, base, scale, axes)) continue;
    if (!scale.has_time && needs_time(entry)) continue;
    auto candidates = Builder{entry, place, base, scale, axes}.build();
    if (!candidates.empty()) {
      add_axes(entry, place, base, axes, axis_scales, candidates);
      add_replacing(entry, base, candidates);
    }
    append_allowed(std::move(candidates), without, result);
  }
  return result;
}

}  // namespace rths::diagnosis
