// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/structure_files.hpp>

#include <algorithm>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/replace_files.hpp>
#include <rths/core/text.hpp>

#include "file_lines.hpp"
#include "matrix_market.hpp"

namespace rths::plant {
namespace {

constexpr std::string_view kNodesHeader = "node,x_m,y_m,z_m,dof_x,dof_y,dof_z";
constexpr std::string_view kBearingsHeader = "node";
constexpr std::string_view kFloorsHeader = "name,node";
constexpr Index kMostNodes = std::numeric_limits<int>::max();
constexpr const char* kDofs[kDirections] = {"dof_x", "dof_y", "dof_z"};
constexpr const char* kPlaces[kDirections] = {"x_m", "y_m", "z_m"};

/// A table with a given header: cells of its rows, in turn.
class TableFile {
 public:
  TableFile(const std::filesystem::path& file, std::string_view header)
      : lines_{file}, columns_{cells_of(header, ',').size()} {
    const auto found = cells_of(lines_.next().value_or(""), ',');
    if (found != cells_of(header, ','))
      lines_.fail(fmt::format("'{}', expected '{}'", lines_.text(), header));
  }
  std::optional<std::vector<std::string_view>> next() {
    while (const auto line = lines_.next()) {
      if (trimmed(*line).empty()) continue;
      auto cells = cells_of(*line, ',');
      if (cells.size() != columns_)
        lines_.fail(fmt::format("{} cells, expected {}", cells.size(), columns_));
      return cells;
    }
    return std::nullopt;
  }
  [[nodiscard]] FileLines& lines() { return lines_; }

 private:
  FileLines lines_;
  std::size_t columns_;
};

/// Things that may be there once, with the line of each.
template <class Key>
class Once {
 public:
  Once(const FileLines& lines, std::string what) : lines_{lines}, what_{std::move(what)} {}
  void add(const Key& key) {
    const auto [at, is_new] = line_of_.try_emplace(key, lines_.number_of_line());
    if (!is_new)
      lines_.fail(
          fmt::format("{} {} again, expected it once: it is on line {}", what_, key, at->second));
  }

 private:
  const FileLines& lines_;
  std::string what_;
  std::map<Key, std::size_t> line_of_;
};

/// Nodes by the numbers that they have in the files.
class NodeNumbers {
 public:
  void read(const std::filesystem::path& file, Structure& structure) {
    TableFile table{file, kNodesHeader};
    const FileLines& lines = table.lines();
    Once<Index> nodes{lines, "node"}, dofs{lines, "row"};
    while (const auto cells = table.next()) {
      const Index number = lines.whole((*cells)[0], "node", 1, kMostNodes);
      nodes.add(number);
      MeshNode node;
      for (std::size_t k = 0; k < kDirections; ++k) {
        node.place[k] = lines.number((*cells)[1 + k], kPlaces[k]);
        const Index row = lines.whole((*cells)[4 + k], kDofs[k], 0, structure.dofs());
        if (row > 0) dofs.add(row);
        node.dofs[k] = row - 1;
      }
      index_of_.emplace(number, structure.nodes.size());
      structure.nodes.push_back(node);
    }
  }

  /// The node of a cell, which must move in all directions.
  [[nodiscard]] std::size_t node(std::string_view cell, const FileLines& lines,
                                 const Structure& structure) const {
    const Index number = lines.whole(cell, "node", 1, kMostNodes);
    const auto at = index_of_.find(number);
    if (at == index_of_.end())
      lines.fail(fmt::format("node {} is not one of the {} nodes", number, index_of_.size()));
    for (std::size_t k = 0; k < kDirections; ++k)
      if (structure.nodes[at->second].dofs[k] < 0)
        lines.fail(fmt::format("node {} has no {}, expected all three", number, kDofs[k]));
    return at->second;
  }

 private:
  std::map<Index, std::size_t> index_of_;
};

void read_bearings(const std::filesystem::path& file, const NodeNumbers& numbers,
                   Structure& structure) {
  TableFile table{file, kBearingsHeader};
  Once<Index> bearings{table.lines(), "node"};
  while (const auto cells = table.next()) {
    structure.bearings.push_back(numbers.node((*cells)[0], table.lines(), structure));
    bearings.add(table.lines().whole((*cells)[0], "node", 1, kMostNodes));
  }
  if (structure.bearings.empty()) table.lines().fail_at_end("no bearings, expected at least 1");
}

// It becomes part of the names of recorded signals.
bool is_name(std::string_view name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) {
    return is_letter_or_digit(c) || c == '_' || c == '-' || c == '.';
  });
}

std::string name_error(std::string_view name) {
  return fmt::format("the name is '{}', expected letters, digits, '_', '-' and '.'", name);
}

void read_floors(const std::filesystem::path& file, const NodeNumbers& numbers,
                 Structure& structure) {
  TableFile table{file, kFloorsHeader};
  Once<std::string> names{table.lines(), "floor"};
  while (const auto cells = table.next()) {
    const std::string name{(*cells)[0]};
    if (!is_name(name)) table.lines().fail(name_error(name));
    names.add(name);
    structure.floors.push_back({name, numbers.node((*cells)[1], table.lines(), structure)});
  }
}

std::string nodes_text(const Structure& structure) {
  std::string text = fmt::format("{}\n", kNodesHeader);
  for (std::size_t i = 0; i < structure.nodes.size(); ++i) {
    const auto& [place, dofs] = structure.nodes[i];
    fmt::format_to(std::back_inserter(text), "{},{:.17g},{:.17g},{:.17g},{},{},{}\n", i + 1,
                   place[0], place[1], place[2], dofs[0] + 1, dofs[1] + 1, dofs[2] + 1);
  }
  return text;
}

std::string bearings_text(const Structure& structure) {
  std::string text = fmt::format("{}\n", kBearingsHeader);
  for (const std::size_t node : structure.bearings) text += fmt::format("{}\n", node + 1);
  return text;
}

std::string floors_text(const Structure& structure) {
  std::string text = fmt::format("{}\n", kFloorsHeader);
  for (const auto& [name, node] : structure.floors) {
    if (!is_name(name)) throw Error{"floor: " + name_error(name)};
    text += fmt::format("{},{}\n", name, node + 1);
  }
  return text;
}

}  // namespace

StructureFiles StructureFiles::in(const std::filesystem::path& folder) {
  return {folder / "k.mtx", folder / "m.mtx", folder / "nodes.csv", folder / "bearings.csv",
          folder / "floors.csv"};
}

Structure read_structure(const StructureFiles& files) {
  Structure structure;
  structure.stiffness = read_matrix(files.stiffness);
  structure.mass = read_diagonal(files.mass);
  if (structure.stiffness.rows() != structure.dofs())
    throw Error{fmt::format("{}: {} rows, expected {} as {} has", files.mass.string(),
                            structure.dofs(), structure.stiffness.rows(),
                            files.stiffness.string())};
  NodeNumbers numbers;
  numbers.read(files.nodes, structure);
  read_bearings(files.bearings, numbers, structure);
  read_floors(files.floors, numbers, structure);
  try {
    check(structure);
  } catch (const Error& error) {  // what remains is wrong in the stiffness
    throw Error{fmt::format("{}: {}", files.stiffness.string(), error.what())};
  }
  return structure;
}

void write_structure(const Structure& structure, const StructureFiles& files) {
  check(structure);
  if (structure.bearing_map.rows() > 0)
    throw Error{"the structure has a rigid mat, expected bearings at nodes of their own"};
  Replacements replacements;
  replacements.add(files.stiffness, lower_triangle_text(structure.stiffness));
  replacements.add(files.mass, diagonal_text(structure.mass));
  replacements.add(files.nodes, nodes_text(structure));
  replacements.add(files.bearings, bearings_text(structure));
  replacements.add(files.floors, floors_text(structure));
  replacements.commit();
}

}  // namespace rths::plant
