// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <utility>

#include <rths/core/constants.hpp>
#include <rths/core/text.hpp>
#include <rths/sim/motion_file.hpp>

#include "motion_text.hpp"

namespace rths::sim {
namespace {

using UnitKind = MotionUnit::Kind;

constexpr double kFoot = 0.3048, kInch = 0.0254;  // [m]

struct Spelling {
  std::string_view text;  ///< in small letters, as `plain` writes it
  MotionUnit unit;
};
constexpr MotionUnit kPercent{"% of g", UnitKind::Acceleration, 100};
constexpr MotionUnit kGal{"gal (cm/s²)", UnitKind::Acceleration, 100 * kStandardGravity};
constexpr Spelling kSpellings[] = {
    {"g", kUnitG},
    {"g's", kUnitG},
    {"gs", kUnitG},
    {"gravity", kUnitG},
    {"%g", kPercent},
    {"%ofg", kPercent},
    {"g%", kPercent},
    {"g/10", {"g/10", UnitKind::Acceleration, 10}},
    {"mg", {"mg (g/1000)", UnitKind::Acceleration, 1000}},
    {"gal", kGal},
    {"gals", kGal},
    {"cm/s2", kGal},
    {"cm/ss", kGal},
    {"cms2", kGal},
    {"cms/s2", kGal},
    {"mgal", {"mGal", UnitKind::Acceleration, 1e5 * kStandardGravity}},
    {"m/s2", {"m/s²", UnitKind::Acceleration, kStandardGravity}},
    {"m/ss", {"m/s²", UnitKind::Acceleration, kStandardGravity}},
    {"ms2", {"m/s²", UnitKind::Acceleration, kStandardGravity}},
    {"mm/s2", {"mm/s²", UnitKind::Acceleration, 1000 * kStandardGravity}},
    {"mm/ss", {"mm/s²", UnitKind::Acceleration, 1000 * kStandardGravity}},
    {"ft/s2", {"ft/s²", UnitKind::Acceleration, kStandardGravity / kFoot}},
    {"in/s2", {"in/s²", UnitKind::Acceleration, kStandardGravity / kInch}},
    {"m/s", {"m/s", UnitKind::Velocity}},
    {"cm/s", {"cm/s", UnitKind::Velocity}},
    {"mm/s", {"mm/s", UnitKind::Velocity}},
    {"in/s", {"in/s", UnitKind::Velocity}},
    {"ft/s", {"ft/s", UnitKind::Velocity}},
    {"kine", {"kine (cm/s)", UnitKind::Velocity}},
    {"m", {"m", UnitKind::Displacement}},
    {"cm", {"cm", UnitKind::Displacement}},
    {"mm", {"mm", UnitKind::Displacement}},
    {"in", {"in", UnitKind::Displacement}},
    {"ft", {"ft", UnitKind::Displacement}},
    {"s", {"s", UnitKind::Other}},
    {"ms", {"ms", UnitKind::Other}},
    {"deg", {"deg", UnitKind::Other}},
    {"°", {"°", UnitKind::Other}},
    {"rad", {"rad", UnitKind::Other}},
    {"rad/s", {"rad/s", UnitKind::Other}},
    {"deg/s", {"deg/s", UnitKind::Other}},
    {"rad/s2", {"rad/s²", UnitKind::Other}},
    {"n", {"N", UnitKind::Other}},
    {"kn", {"kN", UnitKind::Other}},
    {"v", {"V", UnitKind::Other}},
    {"mv", {"mV", UnitKind::Other}},
    {"hz", {"Hz", UnitKind::Other}},
    {"count", {"counts", UnitKind::Other}},
    {"counts", {"counts", UnitKind::Other}}};

// "CM / SEC ^ 2", "cm s⁻²", "cm/sec/sec" and "$cm/s^{2}$" are "cm/s2".
std::string plain(std::string_view text) {
  std::string result;
  for (const char c : in_small_letters(text))
    if (std::string_view{" \t^*{}$"}.find(c) == std::string_view::npos) result += c;
  constexpr std::pair<std::string_view, std::string_view> kReplaced[] = {
      {"²", "2"},      {"⁻", "-"},    {"·", ""},      {"squared", "2"}, {"seconds", "s"},
      {"second", "s"}, {"sec.", "s"}, {"sec", "s"},   {".s-2", "/s2"},  {"s-2", "/s2"},
      {"s-1", "/s"},   {"//", "/"},   {"/s/s", "/s2"}};
  for (const auto& [from, to] : kReplaced) replace_all(result, from, to);
  if (!result.empty() && result.back() == '\xB2') result.back() = '2';  // ² of Latin-1
  return result;
}

// In brackets, such as "h1 [deg]".
std::optional<std::string_view> bracketed(std::string_view heading) {
  const auto open = heading.find_first_of("[(");
  if (open == std::string_view::npos) return std::nullopt;
  const auto close = heading.find_first_of("])", open);
  return trimmed(
      heading.substr(open + 1, close == std::string_view::npos ? close : close - open - 1));
}

// Of a heading; units keep their signs.
std::vector<std::string_view> words_of(std::string_view heading) {
  constexpr std::string_view kBetween = " \t_,;:=[]()\"";
  std::vector<std::string_view> words;
  while (true) {
    const auto begin = heading.find_first_not_of(kBetween);
    if (begin == std::string_view::npos) return words;
    heading.remove_prefix(begin);
    const auto end = std::min(heading.find_first_of(kBetween), heading.size());
    words.push_back(heading.substr(0, end));
    heading.remove_prefix(end);
  }
}

// No other word looks like it: "gal" or "m/s2", but not "g" or "mg", which may also name a station.
bool is_unmistakable(const MotionUnit& unit) {
  return (unit.per_g != 1 && unit.per_g != 1000) || unit.kind == UnitKind::Velocity;
}

// The last word may be any unit of motion; "V" and "N" are directions there.
const MotionUnit* unit_of_words(const std::vector<std::string_view>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    const MotionUnit* unit = find_unit(words[i]);
    if (unit == nullptr || unit->kind == UnitKind::Other) continue;
    if (is_unmistakable(*unit) || (i + 1 == words.size() && unit != find_unit("in"))) return unit;
  }
  return nullptr;
}

const MotionUnit* unit_of_quantity(const std::vector<std::string_view>& words) {
  static constexpr MotionUnit kVelocity{"velocity", UnitKind::Velocity};
  static constexpr MotionUnit kDisplacement{"displacement", UnitKind::Displacement};
  for (const auto word : words) {
    const std::string text = plain(word);
    if (text == "vel" || text == "velocity") return &kVelocity;
    if (text == "disp" || text == "displ" || text == "displacement") return &kDisplacement;
  }
  return nullptr;
}

// "h1_m_s2" and "cm per s2" have no slash.
std::string with_slashes(std::string_view heading) {
  std::string text{heading};
  constexpr std::pair<std::string_view, std::string_view> kReplaced[] = {
      {"% of g", "%g"}, {"% g", "%g"},     {"_per_", "/"},  {" per ", "/"},
      {"m_s2", "m/s2"}, {"m_s^2", "m/s2"}, {"m_s²", "m/s2"}};
  for (const auto& [from, to] : kReplaced) replace_all(text, from, to);
  for (const std::string_view end : {"_m_s", "_cm_s", "_mm_s"})
    if (text.ends_with(end)) text[text.size() - 2] = '/';
  return text;
}

// "in g" or "units: gal"
std::string_view without_words(std::string_view unit) {
  for (const std::string_view word : {"units", "unit", ":", "of ", "in "}) {
    unit = trimmed(unit);
    if (unit.starts_with(word)) unit.remove_prefix(word.size());
  }
  return trimmed(unit);
}

}  // namespace

const MotionUnit* find_unit(std::string_view name) {
  const std::string text = plain(name);
  const auto found = std::find_if(std::begin(kSpellings), std::end(kSpellings),
                                  [&](const Spelling& one) { return one.text == text; });
  return found == std::end(kSpellings) ? nullptr : &found->unit;
}

bool mentions_other_acceleration(std::string_view line) {
  for (const auto word : words_of(line))
    if (const MotionUnit* unit = find_unit(word))
      if (unit->kind == UnitKind::Acceleration && is_unmistakable(*unit)) return true;
  const std::string text = plain(line);
  for (const std::string_view part : {"/ss", "mps2", "mpss", "mpsps", "perspers", "pers2"})
    if (text.find(part) != std::string::npos) return true;
  constexpr std::string_view kSquare = "/s2";  // but not "760 m/s, 2001" or "760 m/s 2001"
  for (auto at = text.find(kSquare); at != std::string::npos; at = text.find(kSquare, at + 1)) {
    const std::size_t next = at + kSquare.size();
    if (next == text.size() || text[next] < '0' || text[next] > '9') return true;
  }
  return false;
}

StatedUnit stated_unit(std::string_view heading) {
  const auto within = bracketed(heading);
  if (within)
    if (const MotionUnit* unit = find_unit(without_words(*within))) return {unit, ""};
  // In parentheses there may be any remark.
  const bool is_unit =
      within && !within->empty() && *within != "-" &&
      (heading.find('[') != std::string_view::npos || within->find('/') != std::string_view::npos ||
       unit_of_words(words_of(*within)) != nullptr);
  if (is_unit) return {nullptr, std::string{*within}};
  const std::string text = with_slashes(heading);
  const auto words = words_of(text);
  if (const MotionUnit* unit = unit_of_words(words)) return {unit, ""};
  return {unit_of_quantity(words), ""};
}

}  // namespace rths::sim
