// SPDX-License-Identifier: Apache-2.0
//
// A structure in files: the round trip, and what is refused.
#include <rths/plant/structure_files.hpp>

#include <gtest/gtest.h>

#include <rths/core/text.hpp>

#include "plant/drive.hpp"
#include "plant/plants.hpp"
#include "support/files.hpp"

namespace rths::plant {
namespace {

using rths::test::content_of;
using rths::test::error_of;

TEST(StructureFiles, GiveTheResponseOfTheGeneratedPlant) {
  constexpr double kStep = 0.01, kLength = 1;  // [s]
  const rths::test::TemporaryFolder folder;
  const auto& generated = test::large_plant();
  write_structure(generated.structure, StructureFiles::in(folder.path()));

  const Structure read = read_structure(StructureFiles::in(folder.path()));

  const auto floors_of = [&](const Structure& structure) {
    PlantSettings settings;
    settings.time_step = kStep;
    const auto plant = make_full(structure, generated.bearings, test::petrolia(), settings);
    return test::drive(*plant, test::lead_rubber(), kStep, kLength).floors;
  };
  const MatrixXd expected = floors_of(generated.structure);
  EXPECT_GT(expected.norm(), 0);
  EXPECT_LE(test::difference(floors_of(read), expected), 1e-12 * 100);
}

/// Files of a box of one element, which a test changes.
class FilesOfABox : public testing::Test {
 protected:
  FilesOfABox() { write_structure(box_, files_); }

  // Replaces a text in a file by another one. @returns the error of reading it, without the folder
  std::string error_after(const std::string& name, const std::string& from,
                          const std::string& to) const {
    std::string text = content_of(folder_.path() / name);
    EXPECT_NE(text.find(from), std::string::npos) << name << " has no '" << from << "'";
    text.replace(text.find(from), from.size(), to);
    return error_with(name, text);
  }
  [[nodiscard]] std::string error_with(const std::string& name, const std::string& text) const {
    const std::string before = content_of(folder_.path() / name);
    folder_.write(name, text);
    std::string error = error_of([&] { static_cast<void>(read_structure(files_)); });
    folder_.write(name, before);
    replace_all(error, folder_.path().string() + "/", "");
    return error;
  }

  rths::test::TemporaryFolder folder_;
  StructureFiles files_ = StructureFiles::in(folder_.path());
  Structure box_ = assemble(test::boxes({}));
};

TEST_F(FilesOfABox, GiveTheSameNumbers) {
  const Structure read = read_structure(files_);

  EXPECT_EQ(read.mass, box_.mass);
  EXPECT_LT((MatrixXd{read.stiffness} - MatrixXd{box_.stiffness}).cwiseAbs().maxCoeff(),
            1e-15 * box_.stiffness.diagonal().maxCoeff());
  EXPECT_EQ(read.bearings, box_.bearings);
  ASSERT_EQ(read.floors.size(), 1U);
  EXPECT_EQ(read.floors[0].name, "top");
  EXPECT_EQ(read.floors[0].node, 7U);
  for (std::size_t i = 0; i < box_.nodes.size(); ++i) {
    EXPECT_EQ(read.nodes[i].place, box_.nodes[i].place);
    EXPECT_EQ(read.nodes[i].dofs, box_.nodes[i].dofs);
  }
}

TEST_F(FilesOfABox, MayHaveGeneralMatricesCommentsAndAnyNodeNumbers) {
  std::string mass = content_of(files_.mass);
  replace_all(mass, "symmetric\n", "general\n% a comment\n\n");
  folder_.write("m.mtx", mass);
  std::string nodes = content_of(files_.nodes);
  replace_all(nodes, "\n8,", "\n800,");
  folder_.write("nodes.csv", nodes);
  folder_.write("floors.csv", "name, node\r\n\"top\",800\r\n");

  const Structure read = read_structure(files_);

  EXPECT_EQ(read.mass, box_.mass);
  EXPECT_EQ(read.floors[0].node, 7U);
}

TEST_F(FilesOfABox, NeedTheHeaderOfMatrixMarket) {
  const char* const expected =
      ", expected '%%MatrixMarket matrix coordinate real symmetric' or '…general'";
  EXPECT_EQ(
      error_after("k.mtx", "real", "complex"),
      "k.mtx:1: '%%MatrixMarket matrix coordinate complex symmetric'" + std::string{expected});
  EXPECT_EQ(error_with("m.mtx", ""), "m.mtx:1: ''" + std::string{expected});
  EXPECT_EQ(error_with("m.mtx", "%%MatrixMarket matrix coordinate real general\n% none\n"),
            "m.mtx:2: no size, expected rows, columns and entries");
}

TEST_F(FilesOfABox, NeedASquareMatrixOfOneSize) {
  EXPECT_EQ(error_after("m.mtx", "24 24 24", "24 24"),
            "m.mtx:2: 2 numbers, expected rows, columns and entries");
  EXPECT_EQ(error_after("m.mtx", "24 24 24", "24 25 24"),
            "m.mtx:2: 24 rows and 25 columns, expected a square matrix");
  EXPECT_EQ(
      error_with("m.mtx", "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 1 5\n2 2 5\n"),
      "m.mtx: 2 rows, expected 24 as k.mtx has");
}

TEST_F(FilesOfABox, NeedAsManyEntriesAsTheySay) {
  EXPECT_EQ(error_after("m.mtx", "24 24 24", "24 24 23"),
            "m.mtx:26: a further entry, expected 23 as the size says");
  EXPECT_EQ(error_after("m.mtx", "24 24 24", "24 24 25"),
            "m.mtx:26: 24 entries, expected 25 as the size says");
}

TEST_F(FilesOfABox, NeedEntriesInsideTheMatrix) {
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n25 24 6000"),
            "m.mtx:26: row is '25', expected a whole number from 1 to 24");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 0 6000"),
            "m.mtx:26: column is '0', expected a whole number from 1 to 24");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n23 24 6000"),
            "m.mtx:26: row 23 column 24 is above the diagonal, expected the lower triangle of a "
            "symmetric matrix");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n23 23 6000"),
            "m.mtx:26: row 23 column 23 again, expected it once: it is on line 25");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 24"),
            "m.mtx:26: 2 numbers, expected row, column and value");
}

TEST_F(FilesOfABox, NeedFiniteNumbers) {
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 24 nan"),
            "m.mtx:26: the value is 'nan', expected a finite number");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 24 6,0"),
            "m.mtx:26: the value is '6,0', expected a finite number");
  EXPECT_EQ(error_after("nodes.csv", "\n8,2,", "\n8,inf,"),
            "nodes.csv:9: x_m is 'inf', expected a finite number");
}

TEST_F(FilesOfABox, NeedADiagonalPositiveMass) {
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 23 6000"),
            "m.mtx:26: row 24 column 23 is 6000, expected a diagonal matrix: lump the mass");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 24 -6000"),
            "m.mtx:26: row 24 is -6000, expected a positive mass");
  EXPECT_EQ(error_after("m.mtx", "\n24 24 6000", "\n24 23 0"),
            "m.mtx: row 24 has no mass, expected a positive one on the diagonal");
}

TEST_F(FilesOfABox, NeedASymmetricStiffness) {
  const std::string error = error_after("k.mtx", "symmetric", "general");

  EXPECT_EQ(error.rfind("k.mtx: stiffness: row ", 0), 0U) << error;
  EXPECT_NE(error.find("expected a symmetric matrix"), std::string::npos) << error;
}

TEST_F(FilesOfABox, NeedTablesWithTheirHeaders) {
  EXPECT_EQ(error_after("nodes.csv", "x_m", "x_mm"),
            "nodes.csv:1: 'node,x_mm,y_m,z_m,dof_x,dof_y,dof_z', expected "
            "'node,x_m,y_m,z_m,dof_x,dof_y,dof_z'");
  EXPECT_EQ(error_after("nodes.csv", "\n1,0,", "\n1,"), "nodes.csv:2: 6 cells, expected 7");
  EXPECT_EQ(error_with("bearings.csv", ""), "bearings.csv:1: '', expected 'node'");
  EXPECT_EQ(error_with("bearings.csv", "node\n"),
            "bearings.csv:1: no bearings, expected at least 1");
}

TEST_F(FilesOfABox, NeedEachNodeAndEachRowOnce) {
  EXPECT_EQ(error_after("nodes.csv", "\n8,", "\n7,"),
            "nodes.csv:9: node 7 again, expected it once: it is on line 8");
  EXPECT_EQ(error_after("nodes.csv", ",22,23,24\n", ",22,23,22\n"),
            "nodes.csv:9: row 22 again, expected it once: it is on line 9");
  EXPECT_EQ(error_after("nodes.csv", ",22,23,24\n", ",22,23,25\n"),
            "nodes.csv:9: dof_z is '25', expected a whole number from 0 to 24");
  EXPECT_EQ(error_after("nodes.csv", "\n8,", "\n8.5,"),
            "nodes.csv:9: node is '8.5', expected a whole number from 1 to 2147483647");
}

TEST_F(FilesOfABox, NeedBearingsAtNodesThatMove) {
  EXPECT_EQ(error_with("bearings.csv", "node\n1\n9\n"),
            "bearings.csv:3: node 9 is not one of the 8 nodes");
  EXPECT_EQ(error_with("bearings.csv", "node\n1\n01\n"),
            "bearings.csv:3: node 1 again, expected it once: it is on line 2");
  EXPECT_EQ(error_after("nodes.csv", ",1,2,3\n", ",1,2,0\n"),
            "bearings.csv:2: node 1 has no dof_z, expected all three");
}

TEST_F(FilesOfABox, NeedFloorsWithDifferentNamesAtNodesThatMove) {
  EXPECT_EQ(error_with("floors.csv", "name,node\ntop,8\ntop,7\n"),
            "floors.csv:3: floor top again, expected it once: it is on line 2");
  EXPECT_EQ(error_with("floors.csv", "name,node\nthe top,8\n"),
            "floors.csv:2: the name is 'the top', expected letters, digits, '_', '-' and '.'");
  EXPECT_EQ(error_with("floors.csv", "name,node\ntop,80\n"),
            "floors.csv:2: node 80 is not one of the 8 nodes");
}

TEST_F(FilesOfABox, AreNotWrittenForABadStructure) {
  box_.floors[0].name = "a,b";
  EXPECT_EQ(error_of([&] { write_structure(box_, files_); }),
            "floor: the name is 'a,b', expected letters, digits, '_', '-' and '.'");

  box_.mass[0] = -1;
  EXPECT_EQ(error_of([&] { write_structure(box_, files_); }),
            "mass: row 1 is -1 kg, expected a positive number");
}

}  // namespace
}  // namespace rths::plant
