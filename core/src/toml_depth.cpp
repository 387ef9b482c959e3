// SPDX-License-Identifier: Apache-2.0
#include "toml_depth.hpp"

#include <algorithm>

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

}  // namespace

std::size_t line_too_deep(std::string_view text) noexcept {
  return DepthScan{text}.line_too_deep();
}

}  // namespace rths
