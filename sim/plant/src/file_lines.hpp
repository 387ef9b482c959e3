// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <rths/plant/structure.hpp>

namespace rths::plant {

/// Lines of a text file in turn, with errors that name the file and the line.
class FileLines {
 public:
  /// @throws Error as read_text
  explicit FileLines(std::filesystem::path file);

  [[nodiscard]] std::optional<std::string_view> next();
  [[nodiscard]] std::string_view text() const;  ///< of the line that `next` gave
  [[nodiscard]] std::size_t number_of_line() const { return next_; }
  [[nodiscard]] std::size_t count() const { return lines_.size(); }

  /// @throws Error unless the cell is a whole number in a range
  [[nodiscard]] Index whole(std::string_view cell, std::string_view what, Index least,
                            Index most) const;
  /// @throws Error unless the cell is a finite number
  [[nodiscard]] double number(std::string_view cell, std::string_view what) const;

  /// @throws Error always, at the line that `next` gave, at another line, or at the end
  [[noreturn]] void fail(const std::string& what) const { fail_at(next_, what); }
  [[noreturn]] void fail_at(std::size_t line, const std::string& what) const;
  [[noreturn]] void fail_at_end(const std::string& what) const;

 private:
  std::filesystem::path file_;
  std::string content_;
  std::vector<std::string_view> lines_;
  std::size_t next_ = 0;
};

}  // namespace rths::plant
