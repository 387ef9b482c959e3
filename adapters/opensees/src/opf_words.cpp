// SPDX-License-Identifier: Apache-2.0
#include "opf_words.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

using Eigen::Index;

std::string named(const OpenSeesElement& element) {
  return fmt::format("element '{}'", element.name);
}

// The machine's axes that move an element's specimen.
std::vector<MovedAxis> axes_of(const OpenSeesElement& element) {
  if (element.actuators.empty()) return element.axes;
  std::vector<MovedAxis> axes;
  for (const auto& actuator : element.actuators) axes.push_back({actuator.axis});
  return axes;
}

}  // namespace

OpfWords::OpfWords(const ControlPoints& points, const std::vector<OpenSeesElement>& elements) {
  for (const auto& signal : points.trial) commands_.push_back({signal});
  for (const auto& signal : points.output) feedbacks_.push_back({signal});
  for (std::size_t i = 0; i < elements.size(); ++i) bind(elements[i], i);
  if (points.is_declared) return;
  const auto is_idle = [](const Word& word) { return word.element == kNone; };
  std::erase_if(commands_, [&](const Word& word) {
    return is_idle(word) && word.signal.word.quantity != OpfQuantity::Time;
  });
  std::erase_if(feedbacks_, is_idle);
}

OpfWords::Word& OpfWords::word(std::vector<Word>& words, const OpenSeesElement& element,
                               const std::string& axis, OpfQuantity quantity) {
  std::set<std::string> axes;
  for (auto& candidate : words) {
    if (candidate.signal.word.quantity != quantity) continue;
    axes.insert(candidate.signal.word.axis);
    if (candidate.signal.word.axis != axis) continue;
    if (candidate.element != kNone)
      throw Error{fmt::format("{}: '{}' is already used by another axis or element", named(element),
                              candidate.signal.word.name)};
    return candidate;
  }
  throw Error{fmt::format("{}: the map has no word for '{} {}', expected an axis of {}",
                          named(element), axis, to_text(quantity),
                          axes.empty() ? "none" : fmt::format("{}", fmt::join(axes, ", ")))};
}

void OpfWords::Word::claim(std::size_t by_element, std::size_t by_axis, double with_sign) {
  element = by_element;
  axis = by_axis;
  sign = with_sign;
}

void OpfWords::bind(const OpenSeesElement& element, std::size_t number) {
  const auto axes = axes_of(element);
  axes_.push_back({std::ssize(axes), false});
  for (std::size_t k = 0; k < axes.size(); ++k) {
    bind_axis(element, number, axes[k], k);
    bind_optional(number, axes[k].axis, k);
  }
  if (element.needs_identification() && !axes_.back().has_displacement)
    throw Error{
        fmt::format("{}: it cannot be identified: the map has no words for the measured "
                    "displacement of its axes",
                    named(element))};
  if (!element.bearing || !element.bearing->axial_load) return;
  const MovedAxis& load = *element.bearing->axial_load;
  Word& force = word(commands_, element, load.axis, OpfQuantity::Force);
  force.claim(number, 0, load.direction);
  force.is_load = true;
}

void OpfWords::bind_axis(const OpenSeesElement& element, std::size_t number, const MovedAxis& axis,
                         std::size_t k) {
  Word& displacement = word(commands_, element, axis.axis, OpfQuantity::Displacement);
  const bool turns = element.actuators.empty() && element.turns(axis.index);
  if ((displacement.signal.word.unit == "rad") != turns)
    throw Error{fmt::format("{}: '{}' is in {}, but its component is a {}", named(element),
                            displacement.signal.word.name, displacement.signal.word.unit,
                            turns ? "rotation" : "translation")};
  displacement.claim(number, k, 1);
  displacement.signal.is_relative_to_first |= element.is_relative;
  word(feedbacks_, element, axis.axis, OpfQuantity::Force).claim(number, k, 1);
}

void OpfWords::bind_optional(std::size_t number, const std::string& axis, std::size_t k) {
  for (auto& other : commands_)
    if (other.signal.word.axis == axis && (other.signal.word.quantity == OpfQuantity::Velocity ||
                                           other.signal.word.quantity == OpfQuantity::Acceleration))
      other.claim(number, k, 1);
  for (auto& other : feedbacks_)
    if (other.signal.word.axis == axis && other.signal.word.quantity == OpfQuantity::Displacement) {
      other.claim(number, k, 1);
      axes_.back().has_displacement = true;
    }
}

std::vector<Port> OpfWords::feedbacks() const {
  std::vector<Port> ports;
  for (const auto& word : feedbacks_)
    ports.push_back({word.signal.word.name, Direction::Input, word.signal.word.unit, 0, false});
  return ports;
}

std::vector<Port> OpfWords::commands() const {
  std::vector<Port> ports;
  for (const auto& word : commands_)
    ports.push_back({word.signal.word.name, Direction::Output, word.signal.word.unit, 0, false});
  return ports;
}

void OpfWords::set_start(std::span<const double> feedbacks) {
  for (std::size_t i = 0; i < feedbacks_.size(); ++i) {
    Word& feedback = feedbacks_[i];
    for (auto& command : commands_) {
      if (command.signal.word.axis != feedback.signal.word.axis ||
          command.signal.word.quantity != feedback.signal.word.quantity)
        continue;
      command.start = feedbacks[i];
      if (command.signal.is_relative_to_measured) command.offset = feedbacks[i];
    }
    if (feedback.signal.is_relative_to_measured) feedback.offset = -feedbacks[i];
  }
}

bool OpfWords::is_relative_to_measured() const {
  const auto is_relative = [](const Word& word) { return word.signal.is_relative_to_measured; };
  return std::any_of(commands_.begin(), commands_.end(), is_relative) ||
         std::any_of(feedbacks_.begin(), feedbacks_.end(), is_relative);
}

void OpfWords::write_unused(std::span<double> commands) const {
  for (std::size_t i = 0; i < commands_.size(); ++i)
    if (commands_[i].element == kNone) commands[i] = commands_[i].offset;
}

void OpfWords::set_first_trial(std::size_t element, const Specimen::Command& first) {
  for (auto& word : commands_)
    if (word.element == element && word.signal.is_relative_to_first)
      word.offset -= value_of(word, first);
}

Measurement OpfWords::measured(std::size_t element, std::span<const double> feedbacks) const {
  const auto [count, has_displacement] = axes_[element];
  Measurement measured{Eigen::VectorXd::Zero(has_displacement ? count : 0),
                       Eigen::VectorXd::Zero(count)};
  for (std::size_t i = 0; i < feedbacks_.size(); ++i) {
    const Word& word = feedbacks_[i];
    if (word.element != element) continue;
    const double value = feedbacks[i] + word.offset;
    auto& values =
        word.signal.word.quantity == OpfQuantity::Force ? measured.force : measured.displacement;
    values[static_cast<Index>(word.axis)] = value;
  }
  return measured;
}

double OpfWords::value_of(const Word& word, const Specimen::Command& command) {
  const auto axis = static_cast<Index>(word.axis);
  if (word.is_load) return word.sign * command.load;
  const OpfQuantity quantity = word.signal.word.quantity;
  if (quantity == OpfQuantity::Displacement) return command.displacement[axis];
  if (quantity == OpfQuantity::Velocity) return command.velocity[axis];
  return quantity == OpfQuantity::Acceleration ? command.acceleration[axis] : 0;
}

double OpfWords::moved_from_start(const Word& word, const Specimen::Command& command) {
  if (word.is_load || word.signal.word.quantity != OpfQuantity::Displacement) return 0;
  return std::abs(value_of(word, command) + word.offset - word.start);
}

bool OpfWords::is_away(std::size_t element, const Specimen::Command& command,
                       double distance) const {
  return std::any_of(commands_.begin(), commands_.end(), [&](const Word& word) {
    return word.element == element && moved_from_start(word, command) > distance;
  });
}

void OpfWords::require_near_start(std::size_t element, const Specimen::Command& command,
                                  double largest) const {
  for (const auto& word : commands_)
    if (word.element == element && !(moved_from_start(word, command) <= largest))
      throw Error{fmt::format(
          "the first trial moves '{}' by {:.6g} {} from rest, expected at most {:g} "
          "(first_trial_m)",
          word.signal.word.name, moved_from_start(word, command), word.signal.word.unit, largest)};
}

void OpfWords::write(std::size_t element, const Specimen::Command& command, double time,
                     std::span<double> commands) {
  for (std::size_t i = 0; i < commands_.size(); ++i) {
    Word& word = commands_[i];
    if (word.signal.word.quantity == OpfQuantity::Time) commands[i] = time;
    if (word.element != element) continue;
    const double value = value_of(word, command) + word.offset;
    const OpfSignal& in_map = word.signal.word;
    if (!(value >= in_map.lowest && value <= in_map.highest))
      throw Error{fmt::format("'{}' would be {:.6g} {}, its word holds {:.6g} to {:.6g}",
                              in_map.name, value, in_map.unit, in_map.lowest, in_map.highest)};
    if (value < word.signal.lowest || value > word.signal.highest)
      throw Error{
          fmt::format("'{}' would be {:.6g} {}, the limits of its control point are {:.6g} "
                      "to {:.6g}",
                      word.signal.word.name, value, word.signal.word.unit, word.signal.lowest,
                      word.signal.highest)};
    commands[i] = value;
  }
}

}  // namespace rths::adapters
