// SPDX-License-Identifier: Apache-2.0
//
// A verdict in a headline and three answers: what is missing and where, how sure, what now.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/text.hpp>
#include <rths/verdict/verdict.hpp>

#include "confidence.hpp"
#include "quantity.hpp"
#include "report.hpp"

namespace rths::diagnosis {
namespace {

constexpr std::size_t kMostWords = 25, kMostNumbers = 3;  // of a headline

/// How much of a headline is told. Each step leaves out more.
struct Detail {
  bool has_titles = true;  ///< of the catalogue; else names, which are shorter
  bool has_sizes = true;
  bool has_both_errors = true;  ///< before and after; else their ratio
  bool has_errors = true;
  std::size_t most_named = 9;  ///< causes, and rivals of each
};
constexpr Detail kDetails[] = {{},
                               {true, true, false},
                               {true, false, true},
                               {true, false, false},
                               {false, true, false},
                               {false, false, true},
                               {false, false, false},
                               {false, false, false, true, 2},
                               {false, false, false, false, 2},
                               {false, false, false, false, 1}};

std::size_t words_in(const std::string& text) {
  std::size_t words = 0;
  bool is_word = false;
  for (const char c : text + " ") {
    if (c != ' ') is_word = is_word || is_letter_or_digit(c) || (c & 0x80) != 0;
    if (c == ' ' && std::exchange(is_word, false)) ++words;
  }
  return words;
}

std::size_t numbers_in(const std::string& text) {
  std::size_t numbers = 0;
  for (std::size_t i = 0; i < text.size(); ++i)
    if (is_digit(text[i]) && (i == 0 || (!is_letter_or_digit(text[i - 1]) && text[i - 1] != '.')))
      ++numbers;
  return numbers;
}

// "Coulomb friction" of "coulomb_friction".
std::string spoken(std::string name) {
  constexpr std::pair<const char*, const char*> kSpelling[] = {
      {"_dependent", "-dependent"}, {"coulomb", "Coulomb"}, {"bouc_wen", "Bouc-Wen"},
      {"stribeck", "Stribeck"},     {"p_delta", "P-delta"}, {"_", " "}};
  for (const auto& [from, to] : kSpelling) replace_all(name, from, to);
  return name;
}

// "pressure" of "auxiliary.pressure", "longitudinal force" of "force.long", "yield displacement" of
// "bouc_wen.yield_displacement": what a name with dots is called.
std::string spoken_role(const std::string& name) {
  constexpr std::pair<std::string_view, const char*> kAxes[] = {
      {"long", "longitudinal"}, {"lat", "lateral"}, {"vert", "vertical"}};
  const std::string last{last_name(name)};
  for (const auto& [axis, adjective] : kAxes)
    if (last == axis && last.size() < name.size())
      return fmt::format("{} {}", adjective, spoken(name.substr(0, name.find('.'))));
  return spoken(last);
}

// A text in which each name with dots is spoken. Numbers stay.
std::string with_spoken_roles(const std::string& text) {
  std::string result, word;
  for (const char c : text + " ") {
    if (is_letter_or_digit(c) || c == '_' || c == '.') {
      word += c;
      continue;
    }
    const auto dot = word.find('.');
    const bool is_role = dot != std::string::npos && is_letter(word[0]) && dot + 1 < word.size() &&
                         is_letter(word[dot + 1]);
    result += (is_role ? spoken_role(word) : word) + c;
    word.clear();
  }
  result.pop_back();
  return result;
}

// Titles without their remarks in brackets; names with their channel, "offset at u".
std::string title_of(const std::string& title, const std::string& name, const Detail& detail) {
  if (detail.has_titles && !title.empty())
    return with_spoken_roles(title.substr(0, title.find(" (")));
  const auto channel = title.rfind(" at ");
  return spoken(name) +
         (channel == std::string::npos ? "" : with_spoken_roles(title.substr(channel)));
}

// "a", "a and b", "a, b and c"
std::string enumerated(const std::vector<std::string>& items, const char* last = " and ") {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i)
    text += (i == 0 ? "" : i + 1 == items.size() ? last : ", ") + items[i];
  return text;
}

// "force" of "force.long"; "y" of "output.y".
std::string channel_of(const Verdict& verdict) {
  const std::string role = !verdict.conclusion.where.channel.empty()
                               ? verdict.conclusion.where.channel
                           : verdict.relations.empty() || verdict.relations[0].outputs.empty()
                               ? ""
                               : verdict.relations[0].outputs[0];
  const auto dot = role.find('.');
  const std::string family = role.substr(0, dot);
  return family == "output" && dot != std::string::npos ? role.substr(dot + 1) : family;
}

// "friction force 41 ± 0.7 kN"; a value per joule, which is told as its inverse: "softening
// over 8.2 ± 0.3 MJ".
std::string told(const Estimate& size) {
  return fmt::format("{} {}{}", spoken(std::string{last_name(size.name)}),
                     size.unit.starts_with("1/") ? "over " : "", with_interval(size));
}

// The one size that a headline tells of a cause; empty: it has several of equal rank, or none.
std::string size_of(const Cause& cause) {
  if (cause.is_rule) return "";
  const auto sizes = told_sizes(cause);
  if (sizes.empty()) return "";
  const auto is_same = [&](const Estimate& other) {
    return last_name(other.name) == last_name(sizes[0].name);
  };
  if (std::count_if(cause.parameters.begin(), cause.parameters.end(), is_same) > 1) return "";
  return told(sizes[0]);
}

// "Coulomb friction (machine)", "one of two (bearing): heating or degradation"
std::string named(const Cause& cause, const Verdict& verdict, const Detail& detail) {
  const std::string place = place_of(cause.part, verdict);
  const std::string title = (cause.is_rule ? "another hysteresis rule, " : "") +
                            title_of(cause.title, cause.name, detail);
  if (cause.alternatives.empty()) {
    std::vector<std::string> remarks;
    if (title.find(place) == std::string::npos) remarks.push_back(place);
    if (detail.has_sizes) remarks.push_back(size_of(cause));
    std::erase(remarks, "");
    return remarks.empty() ? title : fmt::format("{} ({})", title, fmt::join(remarks, ", "));
  }
  constexpr const char* kCounts[] = {"two", "three", "four", "several"};
  const std::size_t rivals = cause.alternatives.size();
  std::vector<std::string> names{title_of(cause.title, cause.name, detail)};
  for (const auto& rival : cause.alternatives)
    if (names.size() < detail.most_named)
      names.push_back(title_of(rival.title, rival.name, detail));
  if (names.size() <= rivals) names.emplace_back(names.size() == rivals ? "another" : "others");
  return fmt::format("one of {} ({}): {}", kCounts[std::min(rivals, std::size(kCounts)) - 1], place,
                     enumerated(names, " or "));
}

// "friction (machine), perhaps heating (bearing), and others"
std::string all_named(const Verdict& verdict, const Detail& detail) {
  const auto& causes = verdict.conclusion.causes;
  const bool has_causes = !are_guesses(causes);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(causes.size(), detail.most_named); ++i)
    names.push_back((has_causes && is_guess(causes[i]) ? "perhaps " : "") +
                    named(causes[i], verdict, detail));
  const std::size_t rest = causes.size() - names.size();
  if (rest > 0) names.push_back(rest == 1 ? "another effect" : "others");
  return enumerated(names, names.size() > 1 ? ", and " : " and ");
}

std::string error_of(const Verdict& verdict) {
  const std::string channel = channel_of(verdict);
  return channel.empty() ? "the error" : fmt::format("the {} error", channel);
}

// "5.7 %"; an error above the signal itself is no share of it.
std::string size_of_error(double error) {
  return error <= 1 ? percent_of(error) : two_digits(error) + " times the signal";
}

// "the force error falls from 5.7 % to 1.7 %", "the force error falls 14-fold".
std::string improvement_of(const Verdict& verdict, const Detail& detail) {
  constexpr double kSame = 0.99, kTwice = 2;  // [-] of the error
  const ProofSummary& proof = verdict.evaluation.proof;
  const std::string error = error_of(verdict);
  if (!detail.has_errors || !(proof.before > 0) || !(proof.after > 0)) return "";
  if (proof.after >= kSame * proof.before)
    return verdict.evaluation.proof_record.empty() ? error + " hardly falls"
                                                   : error + " on unseen data does not fall";
  if (detail.has_both_errors && proof.before <= 1)
    return fmt::format("{} falls from {} to {}", error, percent_of(proof.before),
                       percent_of(proof.after));
  const double times = proof.before / proof.after;
  return times >= kTwice ? fmt::format("{} falls {}-fold", error, two_digits(times))
                         : fmt::format("{} falls by {}", error, percent_of(1 - 1 / times));
}

// "an unknown law of the velocity", of which all guesses are parts; empty: there is none.
std::string unknown_law(const Verdict& verdict) {
  if (!are_guesses(verdict.conclusion.causes) || verdict.relations.empty()) return "";
  const std::string& law = verdict.relations[0].common_law;
  if (law.empty()) return "";
  return law == "f(v)" ? "an unknown law of the velocity" : "an unknown law of the displacement";
}

// "Perhaps missing: friction (machine)"
std::string start_of(const Verdict& verdict, const Detail& detail) {
  const std::string law = unknown_law(verdict), names = all_named(verdict, detail);
  if (!law.empty()) return fmt::format("Missing: {}, perhaps {}", law, names);
  return (are_guesses(verdict.conclusion.causes) ? "Perhaps missing: " : "Missing: ") + names;
}

// The most detailed of some texts that is short enough; else the shortest.
template <class Text>
std::string shortest_of(const Text& text) {
  std::string shortest;
  for (const auto& detail : kDetails) {
    shortest = text(detail);
    if (words_in(shortest) <= kMostWords && numbers_in(shortest) <= kMostNumbers) break;
  }
  return shortest;
}

std::string missing_headline(const Verdict& verdict) {
  const Conclusion& found = verdict.conclusion;
  return shortest_of([&](const Detail& detail) {
    std::string text = start_of(verdict, detail);
    const std::string improvement = improvement_of(verdict, detail);
    if (!improvement.empty()) text += "; " + improvement;
    return text + (found.has_remainder ? ", but more is missing." : ".");
  });
}

std::string none_headline(const Verdict& verdict) {
  constexpr double kNoise = 1.25;  // [-] times the noise
  const ProofSummary& proof = verdict.evaluation.proof;
  const std::string start = "Nothing is missing that these data can show";
  if (!(proof.after > 0)) return start + ".";
  std::string error = error_of(verdict);
  if (proof.after <= 1) error += " of " + percent_of(proof.after);
  if (!proof.is_noise_known)
    return fmt::format("{}, but their noise is not known; {} has no pattern.", start, error);
  return fmt::format("{}: {} {}.", start, error,
                     proof.after <= kNoise * proof.floor ? "is noise" : "has no pattern");
}

// "velocity": the variable that the residual depends on; empty: none is known.
std::string variable_of(const Verdict& verdict) {
  const Description* form = form_of_rest(verdict);
  if (form == nullptr) return "";
  const std::string& label = form->x_label;
  return with_spoken_roles(label.substr(0, label.find(" [")));
}

// Whether a residual is left that no term explains, and no guess.
bool has_unknown_rest(const Verdict& verdict) {
  return std::any_of(verdict.relations.begin(), verdict.relations.end(), [](const auto& relation) {
    return relation.has_remainder || relation.outcome == Outcome::Unknown;
  });
}

std::string unknown_headline(const Verdict& verdict) {
  const Conclusion& found = verdict.conclusion;
  const double after = verdict.evaluation.proof.after;
  if (found.causes.empty()) {
    const auto with = [&](const std::string& variable) {
      return fmt::format("Something is missing ({}){}, but no effect can be named; {} {}.",
                         place_of(found.where.part, verdict),
                         variable.empty() ? "" : " that depends on " + variable, error_of(verdict),
                         after > 0 ? "stays at " + size_of_error(after) : "is systematic");
    };
    const std::string text = with(variable_of(verdict));
    return words_in(text) <= kMostWords ? text : with("");
  }
  return shortest_of([&](const Detail& detail) {
    const std::string improvement = improvement_of(verdict, detail);
    return fmt::format("{}{}{}", start_of(verdict, detail),
                       !improvement.empty() ? "; " + improvement : "",
                       has_unknown_rest(verdict) ? "; the rest has no name." : ".");
  });
}

// --- the three answers ---------------------------------------------------------------------------

// "Coulomb friction with presliding in the machine: friction force 41 ± 0.7 kN."
std::string told(const Cause& cause, const Verdict& verdict) {
  const std::string place = place_of(cause.part, verdict);
  const std::string title = with_spoken_roles(cause.title);
  std::string text = is_guess(cause) ? "Perhaps " + title : capitalised(title);
  if (cause.is_rule) text = "Another hysteresis rule: " + title;
  if (text.find(place) == std::string::npos) text += " in the " + place;
  std::vector<std::string> sizes;
  for (const auto& size : told_sizes(cause)) sizes.push_back(told(size));
  text += fmt::format("{}{}.", sizes.empty() ? "" : ": ", fmt::join(sizes, ", "));
  std::vector<std::string> rivals;
  for (const auto& rival : cause.alternatives) rivals.push_back(with_spoken_roles(rival.title));
  if (!rivals.empty())
    text += fmt::format(" Or instead of it: {}, which explain{} as much.",
                        enumerated(rivals, " or "), rivals.size() == 1 ? "s" : "");
  return text;
}

std::string remainder_told(const Verdict& verdict) {
  const Conclusion& found = verdict.conclusion;
  if (found.outcome != Outcome::Unknown && !found.has_remainder) return "";
  if (!found.causes.empty() && !has_unknown_rest(verdict)) return "";
  std::string text = found.causes.empty()
                         ? fmt::format("The error of the {} is systematic, and shows in the {}.",
                                       channel_of(verdict), place_of(found.where.part, verdict))
                         : "A systematic residual remains.";
  const Description* best = form_of_rest(verdict);
  if (best == nullptr) return text;
  const std::string variable = variable_of(verdict);
  return text + fmt::format(" {}: {} explains {} of it.",
                            variable.empty() ? "Its best form" : "It depends on " + variable,
                            with_spoken_roles(best->form), percent_of(std::min(1.0, best->share)));
}

// "Most of it lies from 3.1 to 5.2 s.": only of few intervals, which a reader can keep in mind.
std::string intervals_told(const Where& where) {
  constexpr std::size_t kFew = 2;
  constexpr double kLong = 100;  // [s] an instant without decimals
  if (where.intervals.empty() || where.intervals.size() > kFew || !where.has_time) return "";
  std::vector<std::string> intervals;
  for (const auto& [from, to] : where.intervals)
    intervals.push_back(to < kLong ? fmt::format("{:.3g} to {:.3g}", from, to)
                                   : fmt::format("{:.0f} to {:.0f}", from, to));
  return fmt::format("Most of it lies in {}, at {} s.", where.record, enumerated(intervals));
}

std::string missing_answer(const Verdict& verdict) {
  const Conclusion& found = verdict.conclusion;
  std::vector<std::string> parts;
  if (found.outcome == Outcome::None) parts.emplace_back("No effect is missing.");
  if (const std::string law = unknown_law(verdict); !law.empty())
    parts.push_back(fmt::format("Together the following draw {}.", law));
  for (const auto& cause : found.causes) parts.push_back(told(cause, verdict));
  parts.push_back(remainder_told(verdict));
  if (!found.withdrawn.empty())
    parts.push_back("Selected, but not named: " + with_spoken_roles(enumerated(found.withdrawn)) +
                    ".");
  if (found.outcome != Outcome::None) parts.push_back(intervals_told(found.where));
  std::erase(parts, "");
  return fmt::format("{}", fmt::join(parts, " "));
}

// "Such a name is right in 9 of 10 cases."
std::string frequencies_of(const Verdict& verdict) {
  const Conclusion& found = verdict.conclusion;
  if (found.causes.empty()) {
    if (found.outcome == Outcome::None && !verdict.evaluation.proof.is_noise_known)
      return "The noise is not known, so a small effect may be hidden in it.";
    return fmt::format("Such a verdict is right in {} cases.", frequency_of(found.confidence));
  }
  std::vector<std::string> each;
  for (const auto& cause : found.causes) each.push_back(frequency_of(cause.confidence));
  if (std::all_of(each.begin(), each.end(), [&](const auto& one) { return one == each[0]; }))
    return fmt::format("{} right in {} cases.",
                       each.size() == 1 ? "Such a name is" : "Such names are", each[0]);
  for (std::size_t i = 0; i < each.size(); ++i)
    each[i] = fmt::format("{} in {}", spoken(found.causes[i].name), each[i]);
  return fmt::format("Such names are right: {} cases.", enumerated(each));
}

std::string errors_told(const Verdict& verdict) {
  const ProofSummary& proof = verdict.evaluation.proof;
  if (!(proof.after > 0)) return "";
  const bool is_named = !verdict.conclusion.causes.empty() && proof.before > 0;
  const std::string on = verdict.evaluation.proof_record.empty()
                             ? "No record was held out to prove it. On the fitted data"
                             : "On data that were not fitted,";
  const std::string noise = !proof.is_noise_known
                                ? ""
                                : fmt::format("; {} noise alone causes {}",
                                              proof.has_noise_at_rest   ? "the measured"
                                              : verdict.noise.is_stated ? "the stated"
                                                                        : "the guessed",
                                              percent_of(proof.floor));
  const std::string course =
      !is_named ? "is " + size_of_error(proof.after)
                : fmt::format("{} from {} to {}", proof.after < proof.before ? "falls" : "changes",
                              size_of_error(proof.before), size_of_error(proof.after));
  return fmt::format("{} {} {}{}.", on, error_of(verdict), course, noise);
}

std::string certainty_answer(const Verdict& verdict) {
  std::vector<std::string> parts{frequencies_of(verdict), errors_told(verdict)};
  std::erase(parts, "");
  return fmt::format("{}", fmt::join(parts, " "));
}

std::string next_answer(const Verdict& verdict) {
  const Conclusion& found = verdict.conclusion;
  std::vector<std::string> parts;
  const bool is_tied = std::any_of(found.causes.begin(), found.causes.end(),
                                   [](const Cause& cause) { return !cause.alternatives.empty(); });
  if (!verdict.next.text.empty())
    parts.push_back(fmt::format("Run the next test: {}.", spoken(verdict.next.text)));
  else if (is_tied)
    parts.emplace_back("No known test separates the rivals: choose by what is known of the " +
                       place_of(found.where.part, verdict) + ".");
  if (!found.causes.empty() && !verdict.improvement.source.file.keys().empty())
    parts.emplace_back(found.has_remainder || found.outcome == Outcome::Unknown
                           ? "Take the improved model as a better start, not as the answer."
                           : "Use the improved model.");
  if (!verdict.noise.remedy.empty() && (found.outcome != Outcome::Missing || found.has_remainder))
    parts.push_back(capitalised(verdict.noise.remedy) + ".");
  if (verdict.evaluation.proof_record.empty())
    parts.emplace_back("Record a second test and hold it out as a proof.");
  if (parts.empty())
    parts.emplace_back(found.outcome == Outcome::None
                           ? "Keep the model, within the states that were tested."
                           : "Look at the form of the residual, and add that law to the model.");
  return fmt::format("{}", fmt::join(parts, " "));
}

}  // namespace

std::string place_of(Part part, const Verdict& verdict) {
  const bool is_free = verdict.specimen == kSystem || verdict.specimen == kStructure;
  if (part == Part::Actuator && is_free) return "input";
  const bool is_object = part == Part::Machine || part == Part::Bearing || part == Part::Structure;
  return is_object && !verdict.specimen.empty() ? verdict.specimen : name_of(part);
}

Answers answers_of(const Verdict& verdict) {
  const Outcome outcome = verdict.conclusion.outcome;
  return {outcome == Outcome::Missing ? missing_headline(verdict)
          : outcome == Outcome::None  ? none_headline(verdict)
                                      : unknown_headline(verdict),
          missing_answer(verdict), certainty_answer(verdict), next_answer(verdict)};
}

}  // namespace rths::diagnosis
