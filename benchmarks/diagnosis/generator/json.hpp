// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace trial {

/// Writes JSON sequentially; the caller opens and closes objects in order.
class Json {
 public:
  void open(std::string_view key = "");  ///< an object
  void open_list(std::string_view key);
  void close();

  void add(std::string_view key, std::string_view text);
  void add(std::string_view key, const char* text) { add(key, std::string_view{text}); }
  void add(std::string_view key, double number);
  void add(std::string_view key, bool yes);
  void add(std::string_view key, const std::vector<std::size_t>& numbers);
  void add(std::string_view key, const std::vector<double>& numbers);

  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  void next(std::string_view key);
  void number(double value);

  std::string text_;
  std::vector<char> closing_;
  bool is_first_ = true;
};

}  // namespace trial
