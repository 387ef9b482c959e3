// SPDX-License-Identifier: Apache-2.0
#include <rths/core/text.hpp>

#include <fnmatch.h>

#include <algorithm>
#include <charconv>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths {
namespace {

constexpr std::string_view kDigits = "0123456789";

bool is_blank(char c) { return c == ' ' || c == '\t'; }

std::string_view unquoted(std::string_view text) {
  const bool quoted = text.size() >= 2 && text.front() == '"' && text.back() == '"';
  return quoted ? text.substr(1, text.size() - 2) : text;
}

bool is_whole(std::string_view cell) {
  return !cell.empty() && cell.find_first_not_of(kDigits) == std::string_view::npos;
}

// Of a number with a fraction, such as "0294E-03".
bool is_fraction(std::string_view cell) {
  const auto exponent = cell.find_first_of("eE");
  if (exponent == std::string_view::npos) return is_whole(cell);
  std::string_view power = cell.substr(exponent + 1);
  if (power.starts_with('-') || power.starts_with('+')) power.remove_prefix(1);
  return is_whole(cell.substr(0, exponent)) && is_whole(power);
}

// Words between blanks, semicolons and quotation marks; a comma alone separates them.
std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view kBetween = " \t;\"";
  std::vector<std::string_view> words;
  while (true) {
    line.remove_prefix(std::min(line.find_first_not_of(kBetween), line.size()));
    if (line.empty()) return words;
    const auto word = line.substr(0, line.find_first_of(kBetween));
    if (word != ",") words.push_back(word);
    line.remove_prefix(word.size());
  }
}

// The only comma of "-1,5e3"; null: it is no such number.
const char* decimal_comma_of(std::string_view word) {
  const auto comma = word.find(',');
  if (comma == word.npos || comma + 1 == word.size()) return nullptr;
  std::string_view whole = word.substr(0, comma);
  if (whole.starts_with('-') || whole.starts_with('+')) whole.remove_prefix(1);
  return (whole.empty() || is_whole(whole)) && is_fraction(word.substr(comma + 1))
             ? word.data() + comma
             : nullptr;
}

constexpr std::string_view kOfNumbers = "0123456789+-.,eE";

// "1,234" may have thousands; "0,234" and "1,5" do not.
bool may_be_thousands(std::string_view word, const char* comma) {
  std::string_view whole = word.substr(0, static_cast<std::size_t>(comma - word.data()));
  const std::string_view fraction = word.substr(whole.size() + 1);
  if (whole.starts_with('-') || whole.starts_with('+')) whole.remove_prefix(1);
  return fraction.size() == 3 && !whole.empty() && whole.size() <= 3 && whole.front() != '0';
}

/// A line as a row of numbers with decimal commas.
struct CommaRow {
  std::vector<const char*> commas;
  bool is_certain = false;   ///< a comma is no separator of thousands
  bool is_contrary = false;  ///< its numbers have points, or commas separate them
};

CommaRow comma_row(std::string_view line) {
  const auto words = words_of(line);
  CommaRow row;
  std::size_t numbers = 0;
  for (const auto word : words) {
    if (const char* comma = decimal_comma_of(word)) {
      row.commas.push_back(comma);
      row.is_certain = row.is_certain || !may_be_thousands(word, comma);
    } else if (number_of(word)) {
      row.is_contrary = row.is_contrary || word.find('.') != word.npos;
    } else if (word.find(',') != word.npos && word.find_first_not_of(kOfNumbers) == word.npos) {
      row.is_contrary = true;
    } else {
      continue;
    }
    ++numbers;
  }
  const bool is_half =
      2 * numbers > words.size() || (2 * numbers == words.size() && !row.commas.empty());
  const bool is_row = is_half && (numbers > 1 || words.size() == 1);
  if (!is_row || line.starts_with('#') || line.starts_with('%')) return {};
  row.is_contrary = row.is_contrary || (words.size() == 1 && !row.commas.empty());
  return row;
}

}  // namespace

bool matches(const std::string& name, const std::vector<std::string>& patterns) {
  return patterns.empty() ||
         std::any_of(patterns.begin(), patterns.end(), [&](const std::string& pattern) {
           return fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
         });
}

std::optional<KeyValue> key_value(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) return std::nullopt;
  return KeyValue{text.substr(0, equals), text.substr(equals + 1)};
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
  for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
}

std::string read_text(const std::filesystem::path& file) {
  std::string text = read_file(file, kMostTextBytes);
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    throw Error{fmt::format("{}: found text in UTF-16, expected UTF-8", file.string())};
  if (text.find('\0') != text.npos)
    throw Error{fmt::format("{}: found bytes that are zero, expected text", file.string())};
  return text;
}

std::vector<std::string_view> lines_of(std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const auto end = text.find_first_of("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + (text.substr(end, 2) == "\r\n" ? 2 : 1));
  }
  return lines;
}

std::string in_small_letters(std::string_view text) {
  std::string result{text};
  std::transform(result.begin(), result.end(), result.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return result;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
  std::vector<std::string_view> result;
  if (separator != ' ') {
    while (true) {
      const auto end = line.find(separator);
      result.push_back(unquoted(trimmed(line.substr(0, end))));
      if (end == std::string_view::npos) return result;
      line.remove_prefix(end + 1);
    }
  }
  while (true) {
    line = trimmed(line);
    if (line.empty()) return result;
    const auto end = std::min(line.find_first_of(" \t"), line.size());
    result.push_back(unquoted(line.substr(0, end)));
    line.remove_prefix(end);
  }
}

std::optional<double> number_of(std::string_view text) {
  if (!text.empty() && text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [stopped, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem == std::errc{} && stopped == text.data() + text.size()) return value;
  const auto exponent = text.find_first_of("dD");
  if (exponent == text.npos) return std::nullopt;
  std::string with_e{text};
  with_e[exponent] = 'e';
  return number_of(with_e);
}

std::string with_decimal_points(std::string text) {
  bool is_certain = false;
  std::vector<std::size_t> commas;
  for (const auto line : lines_of(text)) {
    const auto row = comma_row(line);
    if (row.is_contrary) return text;
    is_certain = is_certain || row.is_certain;
    for (const char* comma : row.commas)
      commas.push_back(static_cast<std::size_t>(comma - text.data()));
  }
  for (const std::size_t comma : commas) text[comma] = is_certain ? '.' : ',';
  return text;
}

bool are_halves(const std::vector<std::string_view>& row) {
  bool fraction = false;
  if (row.size() % 2 != 0) return false;
  for (std::size_t i = 0; i < row.size(); i += 2) {
    const bool has_sign = !row[i].empty() && (row[i].front() == '-' || row[i].front() == '+');
    if (!is_whole(row[i].substr(has_sign ? 1 : 0)) || !is_fraction(row[i + 1])) return false;
    fraction = fraction || (row[i + 1].size() > 1 && row[i + 1].front() == '0');
  }
  return fraction;
}

}  // namespace rths
