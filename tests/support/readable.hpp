// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cctype>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace rths::test {

/// Numbers of a text, as they stand in it: "5.7", "0.84". Digits within a word are none.
inline std::vector<std::string> numbers_in(const std::string& text) {
  const std::regex number{R"((?:^|[^\w.])(\d+(?:\.\d+)?(?:e[-+]?\d+)?))"};
  std::vector<std::string> numbers;
  for (std::sregex_iterator at{text.begin(), text.end(), number}, end; at != end; ++at)
    numbers.push_back((*at)[1]);
  return numbers;
}

inline std::size_t words_in(const std::string& text) {
  std::istringstream stream{text};
  std::size_t words = 0;
  for (std::string word; stream >> word;)
    if (std::any_of(word.begin(), word.end(),
                    [](unsigned char c) { return c < 0x80 && std::isalnum(c) != 0; }))
      ++words;
  return words;
}

/// Percentages of a text: "5.7".
inline std::set<std::string> percentages_in(const std::string& text) {
  const std::regex share{R"((\d[\d.e+-]*) ?%)"};
  std::set<std::string> shares;
  for (std::sregex_iterator at{text.begin(), text.end(), share}, end; at != end; ++at)
    shares.insert((*at)[1]);
  return shares;
}

/// Why a person does not understand a verdict in a minute; empty: nothing hinders.
/// @param answers  what is missing, how sure, what now
inline std::string unreadable(const std::string& headline,
                              const std::vector<std::string>& answers) {
  constexpr std::size_t kMostWords = 25, kMostNumbers = 3;
  std::string faults;
  const auto fault = [&](bool is_fault, const std::string& text) {
    if (is_fault) faults += text + "\n";
  };
  fault(headline.empty() || headline.back() != '.', "the headline is no sentence");
  fault(words_in(headline) > kMostWords, "the headline has too many words");
  fault(numbers_in(headline).size() > kMostNumbers, "the headline has too many numbers");
  fault(headline.find('_') != std::string::npos, "the headline has a name of code");
  std::string all = headline;
  for (const auto& answer : answers) {
    fault(answer.empty(), "an answer is empty");
    all += " " + answer;
  }
  for (const auto& share : percentages_in(all))
    fault(std::stod(share) > 100, "a share is " + share + " %");
  fault(all.find("1.00") != std::string::npos, "something is certain");
  fault(all.find("confidence") != std::string::npos,
        "a confidence instead of how often it is right");
  fault(std::regex_search(all, std::regex{R"(\dE?e[-+]\d)"}), "a number has an exponent");
  fault(std::regex_search(all, std::regex{R"(\bnan\b)"}), "a number is missing");
  fault(
      std::regex_search(
          all,
          std::regex{
              R"(\b(auxiliary|force|displacement|velocity|acceleration|input|output|\w+_\w+)\.(?!csv\b)[a-z])"}),
      "a channel or parameter has its name of code");
  // An error of the headline is that of the second answer.
  for (const auto& share : percentages_in(headline))
    if (answers.size() > 1 && headline.find(" by " + share) == std::string::npos)
      fault(percentages_in(answers[1]).count(share) == 0, share + " % has another value below");
  return faults.empty() ? "" : faults + all;
}

}  // namespace rths::test
