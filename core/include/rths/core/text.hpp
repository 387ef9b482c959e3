// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rths {

/// Letters and digits of ASCII. Unlike the functions of <cctype>, the same in every locale.
[[nodiscard]] constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
[[nodiscard]] constexpr bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}
[[nodiscard]] constexpr bool is_letter_or_digit(char c) { return is_letter(c) || is_digit(c); }
[[nodiscard]] constexpr char upper(char c) {
  return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
}

/// Whether a name is one of some names.
[[nodiscard]] inline bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Whether a name matches one of some shell patterns (* and ?), or there are no patterns.
[[nodiscard]] bool matches(const std::string& name, const std::vector<std::string>& patterns);

using KeyValue = std::pair<std::string, std::string>;

/// The parts of "key=value"; empty if the text has no key or no '='.
[[nodiscard]] std::optional<KeyValue> key_value(const std::string& text);

/// Texts as a TOML array, `["a", "b"]`: a value for Config::set.
[[nodiscard]] std::string toml_list(const std::vector<std::string>& texts);

/// Replaces each `from` by `to`.
void replace_all(std::string& text, std::string_view from, std::string_view to);

/// Content of a text file, at most `kMostTextBytes`.
/// @throws Error as `read_file`, for UTF-16 and for bytes that are zero   @setup
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// Lines of a text, which end with LF, CR LF or CR alone, without these ends and without a byte
/// order mark. They point into the text.
[[nodiscard]] std::vector<std::string_view> lines_of(std::string_view text);

/// With the capital letters of ASCII made small.
[[nodiscard]] std::string in_small_letters(std::string_view text);

/// Without blanks and tabs at both ends.
[[nodiscard]] std::string_view trimmed(std::string_view text);

/// Cells of a line without blanks and quotation marks around them.
/// @param separator  of the cells; ' ' stands for any blanks and tabs
[[nodiscard]] std::vector<std::string_view> cells_of(std::string_view line, char separator);

/// A number that is the whole text, in any locale; it may begin with '+', and have the exponent of
/// Fortran, "5.0D-03".
[[nodiscard]] std::optional<double> number_of(std::string_view text);

/// The text with points in the numbers of its rows, if their commas are decimal: no number of a row
/// has a point, blanks, tabs, semicolons or quotation marks separate the numbers, and a comma
/// cannot be that of thousands.
[[nodiscard]] std::string with_decimal_points(std::string text);

/// True for "0,005,1,5" split at its commas: pairs of whole numbers; at least one second number has
/// a leading zero, as only a fraction does.
[[nodiscard]] bool are_halves(const std::vector<std::string_view>& row);

}  // namespace rths
