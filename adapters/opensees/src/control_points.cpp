// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/control_points.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths::adapters {
namespace {

constexpr const char* kDirections[] = {"ux", "uy", "uz", "rx", "ry", "rz"};

struct Declared {
  int dof = 0;  ///< from 1
  OpfQuantity quantity = OpfQuantity::Displacement;
  ControlSignal options;
};

struct ControlPoint {
  std::string tag;
  std::vector<Declared> signals;
};

std::optional<OpfQuantity> type_named(const std::string& word) {
  struct Name {
    const char* name;
    OpfQuantity quantity;
  };
  constexpr Name kNames[] = {
      {"1", OpfQuantity::Displacement},    {"dsp", OpfQuantity::Displacement},
      {"disp", OpfQuantity::Displacement}, {"2", OpfQuantity::Velocity},
      {"vel", OpfQuantity::Velocity},      {"3", OpfQuantity::Acceleration},
      {"acc", OpfQuantity::Acceleration},  {"accel", OpfQuantity::Acceleration},
      {"4", OpfQuantity::Force},           {"frc", OpfQuantity::Force},
      {"force", OpfQuantity::Force},       {"5", OpfQuantity::Time},
      {"tme", OpfQuantity::Time},          {"time", OpfQuantity::Time}};
  for (const auto& known : kNames)
    if (word == known.name) return known.quantity;
  return std::nullopt;
}

std::optional<int> dof_named(const std::string& word) {
  const auto direction = std::find(std::begin(kDirections), std::end(kDirections), word);
  if (direction != std::end(kDirections))
    return static_cast<int>(direction - std::begin(kDirections)) + 1;
  const bool is_lettered = !word.empty() && is_letter(word[0]);
  const char *first = word.data() + (is_lettered ? 1 : 0), *last = word.data() + word.size();
  int dof = 0;
  const auto [end, error] = std::from_chars(first, last, dof);
  if (error != std::errc{} || end != last || dof < 1) return std::nullopt;
  return dof;
}

/// Reads the words of one line in order.
class ControlLine {
 public:
  explicit ControlLine(const std::string& text) : text_{text} {
    std::istringstream words{text};
    for (std::string word; words >> word;) words_.push_back(word);
  }
  [[nodiscard]] bool is_over() const { return at_ >= words_.size(); }
  [[nodiscard]] bool take(const char* word) {
    if (is_over() || words_[at_] != word) return false;
    ++at_;
    return true;
  }
  std::string next(const char* expected) {
    if (is_over()) fail("the end of the line", expected);
    return words_[at_++];
  }
  double number(const char* expected) {
    const std::string word = next(expected);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value))
      fail("'" + word + "'", expected);
    return value;
  }
  [[noreturn]] void fail(const std::string& found, const char* expected) const {
    throw Error{fmt::format("control point '{}': found {}, expected {}", text_, found, expected)};
  }

 private:
  std::string text_;
  std::vector<std::string> words_;
  std::size_t at_ = 0;
};

void read_options(ControlLine& line, ControlSignal& signal) {
  for (;;) {
    if (line.take("-fact"))
      line.fail("'-fact'",
                "no -fact: OpenFresco's SCRAMNet controls ignore it, and the map defines units");
    if (line.take("-lim")) {
      signal.lowest = line.number("the lower limit");
      signal.highest = line.number("the upper limit");
      if (signal.lowest > signal.highest)
        line.fail("a lower limit above the upper limit", "low, then high");
    } else if (line.take("-relTrial")) {
      signal.is_relative_to_first = true;
    } else if (line.take("-relCtrl") || line.take("-relDaq")) {
      signal.is_relative_to_measured = true;
    } else if (!line.take("-relOut")) {
      return;
    }
  }
}

ControlPoint read_line(const std::string& text) {
  ControlLine line{text};
  static_cast<void>(line.take("expControlPoint"));
  ControlPoint point{line.next("a tag"), {}};
  if (line.take("-node")) static_cast<void>(line.number("a node's tag"));
  while (!line.is_over()) {
    Declared declared;
    const std::string dof = line.next("a degree of freedom");
    if (dof.starts_with('-'))
      line.fail("'" + dof + "'", "-lim, -relTrial, -relCtrl, -relDaq or -relOut");
    const auto number = dof_named(dof);
    if (!number) line.fail("'" + dof + "'", "a degree of freedom: 1, d1 or ux");
    const std::string type = line.next("disp, vel, accel, force or time");
    const auto quantity = type_named(type);
    if (!quantity) line.fail("'" + type + "'", "disp, vel, accel, force or time");
    declared.dof = *number;
    declared.quantity = *quantity;
    read_options(line, declared.options);
    point.signals.push_back(declared);
  }
  if (point.signals.empty()) line.fail("the end of the line", "at least one signal");
  return point;
}

// "2 vel": the notation of a control point.
std::string text_of(int dof, OpfQuantity quantity) {
  return fmt::format("{} {}", dof, to_text(quantity));
}

/// Numbers a block's words as control points do: along the axes of each quantity.
std::vector<int> numbers_of(const std::vector<OpfSignal>& words) {
  std::vector<int> numbers;
  for (std::size_t i = 0; i < words.size(); ++i)
    numbers.push_back(i > 0 && words[i - 1].quantity == words[i].quantity ? numbers[i - 1] + 1 : 1);
  return numbers;
}

// OpenFresco itself reports no error: it would read the flags from the words of signals.
[[noreturn]] void fail(const ControlPoint& point, const char* role, const std::string& how,
                       const std::vector<OpfSignal>& words) {
  throw Error{
      fmt::format("{} control point {} declares {}; the map has {} words there, '{}' to '{}': all "
                  "words after the "
                  "difference would be misread",
                  role, point.tag, how, words.size(), words.front().name, words.back().name)};
}

ControlSignal with_word(const Declared& declared, const OpfSignal& word) {
  ControlSignal signal = declared.options;
  signal.word = word;
  signal.lowest *= word.map_unit;
  signal.highest *= word.map_unit;
  return signal;
}

std::vector<ControlSignal> without_control_points(const std::vector<OpfSignal>& words) {
  std::vector<ControlSignal> signals;
  for (const auto& word : words) signals.push_back({word});
  return signals;
}

void require_all_declared(std::size_t declared, const std::vector<OpfSignal>& words,
                          const ControlPoint& last, const char* role) {
  if (declared < words.size())
    fail(last, role,
         fmt::format("too few signals: '{}' ({}) is the first of {} missing signals",
                     text_of(numbers_of(words)[declared], words[declared].quantity),
                     words[declared].name, words.size() - declared),
         words);
}

std::vector<ControlSignal> checked_signals(const std::vector<OpfSignal>& words,
                                           const std::vector<std::string>& lines,
                                           const char* role) {
  if (lines.empty()) return without_control_points(words);
  if (words.empty()) throw Error{fmt::format("the map has no words for {} control points", role)};
  std::vector<ControlSignal> signals;
  const auto numbers = numbers_of(words);
  std::optional<ControlPoint> previous;
  for (const auto& text : lines) {
    const ControlPoint point = read_line(text);
    for (std::size_t i = 0; i < point.signals.size(); ++i) {
      const Declared& declared = point.signals[i];
      const std::size_t at = signals.size();
      const std::string found = text_of(declared.dof, declared.quantity);
      if (at == words.size())
        fail(point, role, fmt::format("too many signals, the first of them '{}'", found), words);
      const std::string expected = text_of(numbers[at], words[at].quantity);
      if (found != expected && i == 0 && previous)
        fail(*previous, role,
             fmt::format("too few signals: '{}' ({}) is missing, control point {} begins with '{}'",
                         expected, words[at].name, point.tag, found),
             words);
      if (found != expected)
        fail(point, role,
             fmt::format("'{}' where '{}' ({}) is expected", found, expected, words[at].name),
             words);
      signals.push_back(with_word(declared, words[at]));
    }
    previous = point;
  }
  require_all_declared(signals.size(), words, *previous, role);
  return signals;
}

}  // namespace

ControlPoints control_points(const OpfLayout& layout, const std::vector<std::string>& trial,
                             const std::vector<std::string>& output) {
  return {!trial.empty() || !output.empty(), checked_signals(layout.commands, trial, "trial"),
          checked_signals(layout.feedbacks, output, "output")};
}

}  // namespace rths::adapters
