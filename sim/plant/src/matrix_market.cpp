// SPDX-License-Identifier: Apache-2.0
#include "matrix_market.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <tuple>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/text.hpp>

#include "file_lines.hpp"

namespace rths::plant {
namespace {

constexpr std::string_view kHeader = "%%MatrixMarket matrix coordinate real ";

struct Entry {
  Index row = 0, column = 0;  // from 0
  double value = 0;
  std::size_t line = 0;
};

struct Entries {
  Index rows = 0;
  bool is_symmetric = false;
  std::vector<Entry> list;
};

/// The lines of a Matrix Market file, in turn.
class MatrixFile {
 public:
  explicit MatrixFile(const std::filesystem::path& file) : lines_{file} {}

  Entries read() {
    Entries entries;
    entries.is_symmetric = read_symmetry();
    const std::size_t count = read_size(entries);
    entries.list.reserve(std::min(count, lines_.count()));
    while (const auto cells = next()) {
      if (entries.list.size() == count)
        lines_.fail(fmt::format("a further entry, expected {} as the size says", count));
      entries.list.push_back(entry(*cells, entries));
    }
    if (entries.list.size() < count)
      lines_.fail_at_end(
          fmt::format("{} entries, expected {} as the size says", entries.list.size(), count));
    require_no_repetition(entries.list);
    return entries;
  }

 private:
  bool read_symmetry() {
    const std::string header = in_small_letters(lines_.next().value_or(""));
    const auto begin = in_small_letters(kHeader);
    const bool begins = header.rfind(begin, 0) == 0;
    const auto symmetry = begins ? trimmed(std::string_view{header}.substr(begin.size())) : "";
    if (symmetry != "symmetric" && symmetry != "general")
      lines_.fail(
          fmt::format("'{}', expected '{}symmetric' or '…general'", lines_.text(), kHeader));
    return symmetry == "symmetric";
  }

  std::size_t read_size(Entries& entries) {
    const auto cells = next();
    if (!cells) lines_.fail_at_end("no size, expected rows, columns and entries");
    if (cells->size() != 3)
      lines_.fail(fmt::format("{} numbers, expected rows, columns and entries", cells->size()));
    entries.rows = lines_.whole((*cells)[0], "rows", 1, kMostRows);
    const Index columns = lines_.whole((*cells)[1], "columns", 1, kMostRows);
    if (columns != entries.rows)
      lines_.fail(
          fmt::format("{} rows and {} columns, expected a square matrix", entries.rows, columns));
    return static_cast<std::size_t>(
        lines_.whole((*cells)[2], "entries", 0, entries.rows * entries.rows));
  }

  Entry entry(const std::vector<std::string_view>& cells, const Entries& entries) {
    if (cells.size() != 3)
      lines_.fail(fmt::format("{} numbers, expected row, column and value", cells.size()));
    Entry entry;
    entry.row = lines_.whole(cells[0], "row", 1, entries.rows) - 1;
    entry.column = lines_.whole(cells[1], "column", 1, entries.rows) - 1;
    entry.value = lines_.number(cells[2], "the value");
    entry.line = lines_.number_of_line();
    if (entries.is_symmetric && entry.row < entry.column)
      lines_.fail(fmt::format(
          "row {} column {} is above the diagonal, expected the lower triangle of a symmetric "
          "matrix",
          entry.row + 1, entry.column + 1));
    return entry;
  }

  void require_no_repetition(std::vector<Entry>& entries) const {
    const auto place = [](const Entry& entry) {
      return std::tuple{entry.column, entry.row, entry.line};
    };
    std::ranges::sort(entries, {}, place);
    for (std::size_t i = 1; i < entries.size(); ++i)
      if (entries[i].row == entries[i - 1].row && entries[i].column == entries[i - 1].column)
        lines_.fail_at(entries[i].line,
                       fmt::format("row {} column {} again, expected it once: it is on line {}",
                                   entries[i].row + 1, entries[i].column + 1, entries[i - 1].line));
  }

  // Cells of the next line that is neither empty nor a comment.
  std::optional<std::vector<std::string_view>> next() {
    while (const auto line = lines_.next())
      if (const auto text = trimmed(*line); !text.empty() && text.front() != '%')
        return cells_of(text, ' ');
    return std::nullopt;
  }

  static constexpr Index kMostRows = std::numeric_limits<int>::max();
  FileLines lines_;
};

std::string header_text(Index rows, Index entries) {
  return fmt::format("{}symmetric\n{} {} {}\n", kHeader, rows, rows, entries);
}

}  // namespace

SparseMatrix read_matrix(const std::filesystem::path& file) {
  const Entries entries = MatrixFile{file}.read();
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve((entries.is_symmetric ? 2 : 1) * entries.list.size());
  for (const auto& [row, column, value, line] : entries.list) {
    triplets.emplace_back(static_cast<int>(row), static_cast<int>(column), value);
    if (entries.is_symmetric && row != column)
      triplets.emplace_back(static_cast<int>(column), static_cast<int>(row), value);
  }
  SparseMatrix matrix(entries.rows, entries.rows);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

VectorXd read_diagonal(const std::filesystem::path& file) {
  const Entries entries = MatrixFile{file}.read();
  VectorXd diagonal = VectorXd::Zero(entries.rows);
  for (const auto& [row, column, value, line] : entries.list) {
    const auto fail = [&, at = line](const std::string& what) {
      throw Error{fmt::format("{}:{}: {}", file.string(), at, what)};
    };
    if (row != column && value != 0)
      fail(fmt::format("row {} column {} is {:g}, expected a diagonal matrix: lump the mass",
                       row + 1, column + 1, value));
    if (row == column && !(value > 0))
      fail(fmt::format("row {} is {:g}, expected a positive mass", row + 1, value));
    if (row == column) diagonal[row] = value;
  }
  for (Index row = 0; row < entries.rows; ++row)
    if (!(diagonal[row] > 0))
      throw Error{fmt::format("{}: row {} has no mass, expected a positive one on the diagonal",
                              file.string(), row + 1)};
  return diagonal;
}

std::string lower_triangle_text(const SparseMatrix& matrix) {
  std::string entries;
  Index count = 0;
  for (Index column = 0; column < matrix.outerSize(); ++column)
    for (SparseMatrix::InnerIterator entry{matrix, column}; entry; ++entry) {
      if (entry.row() < column) continue;
      fmt::format_to(std::back_inserter(entries), "{} {} {:.17g}\n", entry.row() + 1, column + 1,
                     entry.value());
      ++count;
    }
  return header_text(matrix.rows(), count) + entries;
}

std::string diagonal_text(const VectorXd& diagonal) {
  std::string text = header_text(diagonal.size(), diagonal.size());
  for (Index row = 0; row < diagonal.size(); ++row)
    fmt::format_to(std::back_inserter(text), "{} {} {:.17g}\n", row + 1, row + 1, diagonal[row]);
  return text;
}

}  // namespace rths::plant
