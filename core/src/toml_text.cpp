// SPDX-License-Identifier: Apache-2.0
#include "toml_text.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>
#include <toml++/toml.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

namespace rths {
namespace {

// Reads text that need not be TOML: the parser reports other mistakes.
class DepthScan {
 public:
  explicit DepthScan(std::string_view text) : text_{text} {}

  std::size_t line_too_deep() {
    while (at_ < text_.size()) {
      read_next();
      if (dots_ >= kDeepest || open_ > kDeepest) return line_;
    }
    return 0;
  }

 private:
  void read_next() {
    const char c = text_[at_];
    if (c == '"' || c == '\'') return skip_string(c);
    if (c == '#') return skip_to(text_.find('\n', at_));
    ++at_;
    if (c == '\n') ++line_;
    if (c == '.') ++dots_;
    if (c == '[' || c == '{') ++open_;
    if ((c == ']' || c == '}') && open_ > 0) --open_;
    // Anything else that cannot be inside a key ends it.
    if (c == '\n' || c == '=' || c == ',' || c == '[' || c == ']' || c == '{' || c == '}')
      dots_ = 0;
  }

  void skip_to(std::size_t position) { at_ = std::min(position, text_.size()); }

  void skip_string(char quote) {
    const bool is_long = text_.substr(at_, 3) == std::string_view{quote == '"' ? "\"\"\"" : "'''"};
    const std::size_t length = is_long ? 3 : 1;
    const std::string_view end = text_.substr(at_, length);
    for (at_ += length; at_ < text_.size(); ++at_) {
      if (text_[at_] == '\n') ++line_;
      if (text_[at_] == '\n' && !is_long) return;  // not closed
      if (text_[at_] == '\\' && quote == '"')
        ++at_;
      else if (text_.substr(at_, length) == end)
        return skip_to(at_ + length);
    }
  }

  std::string_view text_;
  std::size_t at_ = 0, line_ = 1, dots_ = 0, open_ = 0;
};

std::string place(const std::string& name, const toml::source_region& source) {
  return fmt::format("{}:{}:{}", name, source.begin.line, source.begin.column);
}

ConfigValue convert(const toml::node& node, const std::string& name);

// Names are printed and become those of files, so none may change a terminal.
std::string checked_text(std::string text, const std::string& where) {
  const bool has_controls = std::any_of(text.begin(), text.end(), [](unsigned char c) {
    return (c < ' ' && c != '\n' && c != '\t' && c != '\r') || c == 0x7F;
  });
  if (has_controls)
    throw Error{fmt::format("{}: the text '{}' has control characters, expected printable ones",
                            where, printable(text))};
  return text;
}

ConfigValue::Table convert_table(const toml::table& table, const std::string& name) {
  ConfigValue::Table result;
  for (const auto& [key, value] : table)
    result.emplace(checked_text(std::string{key.str()}, place(name, key.source())),
                   convert(value, name));
  return result;
}

ConfigValue convert(const toml::node& node, const std::string& name) {
  const std::string where = place(name, node.source());
  if (const auto* table = node.as_table()) return {convert_table(*table, name), where};
  if (const auto* array = node.as_array()) {
    ConfigValue::Array items;
    for (const auto& item : *array) items.push_back(convert(item, name));
    return {std::move(items), where};
  }
  if (const auto truth = node.value_exact<bool>()) return {*truth, where};
  if (const auto whole = node.value_exact<std::int64_t>()) return {*whole, where};
  if (const auto real = node.value_exact<double>()) return {*real, where};
  if (const auto text = node.value_exact<std::string>()) return {checked_text(*text, where), where};
  throw Error{where + ": dates and times are not supported"};
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\')
      result += {'\\', c};
    else if (static_cast<unsigned char>(c) < ' ' || c == 0x7F)
      result += fmt::format("\\u{:04X}", static_cast<int>(c));
    else
      result += c;
  }
  return result + '"';
}

std::string key_of(const std::string& key) {
  const bool is_bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return is_letter_or_digit(c) || c == '_' || c == '-';
  });
  return is_bare ? key : quoted(key);
}

// The shortest digits that read back the same; always those of a real number.
std::string real_text(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return text;
}

std::string inline_text(const ConfigValue& item);

template <class Items, class Text>
std::string joined(const Items& items, const Text& text) {
  std::string result;
  for (const auto& item : items) result += (result.empty() ? "" : ", ") + text(item);
  return result;
}

struct InlineText {
  std::string operator()(bool truth) const { return truth ? "true" : "false"; }
  std::string operator()(std::int64_t whole) const { return std::to_string(whole); }
  std::string operator()(double real) const { return real_text(real); }
  std::string operator()(const std::string& text) const { return quoted(text); }
  std::string operator()(const ConfigValue::Array& items) const {
    return "[" + joined(items, inline_text) + "]";
  }
  std::string operator()(const ConfigValue::Table& table) const {
    return "{" +
           joined(table,
                  [](const auto& entry) {
                    return key_of(entry.first) + " = " + inline_text(entry.second);
                  }) +
           "}";
  }
};

std::string inline_text(const ConfigValue& item) { return std::visit(InlineText{}, item.value); }

const ConfigValue::Table* table_in(const ConfigValue& item) {
  return std::get_if<ConfigValue::Table>(&item.value);
}

// The tables of [[key]]; null for any other value.
const ConfigValue::Array* tables_in(const ConfigValue& item) {
  const auto* items = std::get_if<ConfigValue::Array>(&item.value);
  const bool are_tables =
      items != nullptr && !items->empty() && std::all_of(items->begin(), items->end(), table_in);
  return are_tables ? items : nullptr;
}

// Values first, then tables, each with its full name.
void write_table(const ConfigValue::Table& table, const std::string& prefix, std::string& text) {
  for (const auto& [key, item] : table)
    if (table_in(item) == nullptr && tables_in(item) == nullptr)
      text += key_of(key) + " = " + inline_text(item) + "\n";
  for (const auto& [key, item] : table) {
    const std::string name = prefix + key_of(key);
    if (const auto* inner = table_in(item)) {
      text += fmt::format("\n[{}]\n", name);
      write_table(*inner, name + ".", text);
    } else if (const auto* items = tables_in(item)) {
      for (const auto& one : *items) {
        text += fmt::format("\n[[{}]]\n", name);
        write_table(*table_in(one), name + ".", text);
      }
    }
  }
}

}  // namespace

std::string toml_list(const std::vector<std::string>& texts) {
  return "[" + joined(texts, quoted) + "]";
}

std::string write_toml(const ConfigValue::Table& table) {
  std::string text;
  write_table(table, "", text);
  return text;
}

ConfigValue::Table parse_toml(std::string_view text, const std::string& name) {
  if (const std::size_t line = line_too_deep(text); line != 0)
    throw Error{
        fmt::format("{}:{}: a key or value is nested too deeply, expected at most {} levels", name,
                    line, kDeepest)};
  try {
    return convert_table(toml::parse(text, name), name);
  } catch (const toml::parse_error& error) {
    throw Error{fmt::format("{}: {}", place(name, error.source()), error.description())};
  }
}

std::size_t line_too_deep(std::string_view text) noexcept {
  return DepthScan{text}.line_too_deep();
}

}  // namespace rths
