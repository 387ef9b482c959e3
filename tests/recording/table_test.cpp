// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/table.hpp>

#include <hdf5.h>
#include <matio.h>

#include <cmath>

#include <gtest/gtest.h>

#include <rths/recording/recording.hpp>

#include "support/files.hpp"

namespace rths::recording {
namespace {

using Values = std::vector<double>;

class TableTest : public ::testing::Test {
 protected:
  Table load(const std::string& text) { return Table::load(folder_.write("log.csv", text)); }
  std::string error(const std::string& text) {
    const auto message = test::error_of([&] { static_cast<void>(load(text)); });
    const auto at = message.find("log.csv");
    return at == std::string::npos ? message : message.substr(at);
  }

  test::TemporaryFolder folder_;
};

TEST_F(TableTest, ReadsColumnsWithAnySeparator) {
  for (const char* text :
       {"t,u\n0,1.5\n0.1,+2e-3\n", "t;u\r\n0;1.5\r\n0.1;2e-3\r\n", "t\tu\n0\t1.5\n0.1\t2e-3",
        "  t u\n  0   1.5\n 0.1 2e-3 \n\n", "t,u\r0,1.5\r0.1,2e-3\r",
        "# a comment\n\"t\",\"u\"\n% another\n0,1.5\n0.1,0.002\n"}) {
    const Table table = load(text);
    EXPECT_EQ(table.column("t"), (Values{0, 0.1})) << text;
    EXPECT_EQ(table.column("u"), (Values{1.5, 2e-3})) << text;
  }
}

TEST_F(TableTest, RefusesDirectoriesDevicesAndPipes) {
  for (const std::string& file : {std::string{"/dev/zero"}, folder_.path().string()})
    EXPECT_NE(test::error_of([&] {
                static_cast<void>(Table::load(file));
              }).find(": cannot be read: it is a "),
              std::string::npos);
}

TEST_F(TableTest, NumbersColumnsWithoutNames) {
  const Table table = load("0 1\n2 3\n");

  EXPECT_EQ(table.column("2"), (Values{1, 3}));
  EXPECT_EQ(table.column("#1"), (Values{0, 2}));
}

TEST_F(TableTest, ReportsTheLineOfAnError) {
  EXPECT_EQ(error("t,u\n0,1\n0.1\n"), "log.csv:3: 1 columns, expected 2 as in the first row");
  EXPECT_EQ(error("# nothing\n"), "log.csv: found no columns of numbers, expected at least one");
  EXPECT_EQ(error("t,u\n"), "log.csv: found column names but no rows, expected at least one row");
  EXPECT_EQ(error("t,u,t\n0,1,2\n"),
            "log.csv:1: two columns are named 't', expected different names");
}

TEST_F(TableTest, ReportsAMissingNumberOnlyInARequestedColumn) {
  for (const std::string cell : {"one", "nan", ""}) {
    const Table table = load("t,u,day\n0,1,Mon\n0.1," + cell + ",Mon\n");

    EXPECT_EQ(table.column("t"), (Values{0, 0.1}));
    const auto message = test::error_of([&] { static_cast<void>(table.column("u")); });
    EXPECT_EQ(message.substr(message.find("log.csv")),
              "log.csv:3: found '" + cell + "' in column 'u', expected a finite number");
    EXPECT_EQ(table.column_with_gaps("u")[0], 1);
    EXPECT_TRUE(std::isnan(table.column_with_gaps("u")[1]));
  }
}

TEST_F(TableTest, SkipsLinesAboveAndBelowTheNames) {
  const Table table = load("MTS793|BTW|ENU|1|2\nDate: Monday\n\nt\tu\ns\tmm\n0\t1\n0.1\t2\n");

  EXPECT_EQ(table.column("t"), (Values{0, 0.1}));
  EXPECT_EQ(table.column("u"), (Values{1, 2}));
}

TEST_F(TableTest, SkipsLinesWithANumberAboveTheNames) {
  for (const std::string heading :
       {"Sample rate,100\n", "DAQ 3\n", "Operator,Smith\nSample rate,100\nChannels,2\n\n"}) {
    const Table table = load(heading + "t,u,day\ns,mm,-\n0,1,Mon\n0.1,2,Mon\n");

    EXPECT_EQ(table.column("t"), (Values{0, 0.1})) << heading;
    EXPECT_EQ(table.column("u"), (Values{1, 2})) << heading;
  }
  const Table pair = load("Sample rate,100\nt,u\n0,1\n0.1,2\n");
  EXPECT_EQ(pair.column("t"), (Values{0, 0.1}));
  // A row with a text is a row.
  EXPECT_EQ(load("t,u,day\n0,1,Mon\n0.1,,Mon\n").column("t"), (Values{0, 0.1}));
  EXPECT_EQ(load("t,u,day\n0,1,Mon\n,,Mon\n").column_with_gaps("u").size(), 2U);
}

// A logger ends each line with a separator, or leaves a cell empty.
TEST_F(TableTest, ReadsEmptyCellsOfTheFirstRow) {
  for (const std::string names : {"t,u,,\n", "t,u\n", "Operator,Smith\nt,u,,\n"}) {
    const Table trailing = load(names + "0.0,1.5,,\n0.1,2.5,,\n");

    EXPECT_EQ(trailing.column("u"), (Values{1.5, 2.5}));
    EXPECT_EQ(trailing.columns().size(), 4U);
  }
  const Table hole = load("t,u,F\n0,,5\n1,2,6\n");
  EXPECT_EQ(hole.column("F"), (Values{5, 6}));
  EXPECT_TRUE(std::isnan(hole.column_with_gaps("u")[0]));
}

TEST_F(TableTest, RefusesUtf16) {
  for (const std::string mark : {"\xFF\xFE", "\xFE\xFF"})
    EXPECT_EQ(error(mark + "t,u\n0,1\n"), "log.csv: found text in UTF-16, expected UTF-8");
}

TEST_F(TableTest, RefusesDecimalCommas) {
  const auto expect = [&](const std::string& text, int line, const std::string& cell) {
    EXPECT_EQ(error(text), "log.csv:" + std::to_string(line) + ": '" + cell +
                               "' looks like numbers with decimal commas, expected points");
  };
  expect("t;u\n0,0;1,5\n", 2, "0,0");
  expect("t\tu\n0,0\t1,5\n", 2, "0,0");
  expect("0,0;1,5\n0,1;2,5\n", 1, "0,0;1,5");
  expect("0,0 1,5\n", 1, "0,0 1,5");
  expect("t,u\n0,005,1,5\n", 2, "0,005,1,5");
  EXPECT_EQ(load("0,5,1,500\n").columns().size(), 4U);
}

TEST_F(TableTest, NamesTheNearestColumn) {
  const Table table = load("time,force_N\n0,1\n");

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(table.column("force_kN"));
            }).find("there is no column 'force_kN' (did you mean 'force_N'?)"),
            std::string::npos);
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(table.column("#3"));
            }).find("there is no column #3, expected #1 to #2"),
            std::string::npos);
}

TEST_F(TableTest, ReadsMatFilesOfEveryVersion) {
  for (const auto version : {MAT_FT_MAT4, MAT_FT_MAT5, MAT_FT_MAT73}) {
    const auto file = folder_.path() / ("log" + std::to_string(version) + ".mat");
    mat_t* mat = Mat_CreateVer(file.c_str(), nullptr, version);
    ASSERT_NE(mat, nullptr);
    double row[] = {1, 2, 3};
    double matrix[] = {1, 2, 3, 4, 5, 6};
    std::size_t lying[] = {1, 3}, two[] = {3, 2};
    matvar_t* t = Mat_VarCreate("t", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, lying, row, 0);
    matvar_t* u = Mat_VarCreate("u", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, two, matrix, 0);
    Mat_VarWrite(mat, t, MAT_COMPRESSION_NONE);
    Mat_VarWrite(mat, u, MAT_COMPRESSION_NONE);
    Mat_VarFree(t);
    Mat_VarFree(u);
    Mat_Close(mat);

    const Table table = Table::load(file);

    EXPECT_EQ(table.column("t"), (Values{1, 2, 3})) << version;
    EXPECT_EQ(table.column("u(2)"), (Values{4, 5, 6})) << version;
  }
}

// A bit of its data flips, which its checksum shows.
TEST_F(TableTest, NamesTheFileAndTheDatasetThatItCannotRead) {
  const auto path = folder_.path() / "log.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size[] = {3};
  const hid_t space = H5Screate_simple(1, size, nullptr);
  const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
  ASSERT_GE(H5Pset_chunk(layout, 1, size), 0);
  ASSERT_GE(H5Pset_fletcher32(layout), 0);
  const hid_t data =
      H5Dcreate2(file, "force", H5T_NATIVE_DOUBLE, space, H5P_DEFAULT, layout, H5P_DEFAULT);
  const double values[] = {1.5, 2.5, 3.5};
  H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
  for (const auto close : {H5Dclose(data), H5Pclose(layout), H5Sclose(space), H5Fclose(file)})
    ASSERT_GE(close, 0);
  std::string bytes = test::content_of(path);
  const std::string stored{reinterpret_cast<const char*>(values), sizeof values};
  bytes[bytes.find(stored)] ^= 1;
  folder_.write("log.h5", bytes);

  EXPECT_EQ(test::error_of([&] { static_cast<void>(Table::load(path)); }),
            path.string() + ": reading force failed");
}

// The name of its group alone does not make it the recording of a run.
TEST_F(TableTest, ReadsDatasetsOfAnyHdf5File) {
  const auto path = folder_.path() / "log.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hid_t group = H5Gcreate2(file, "signals", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t size[] = {3, 2};
  const hid_t space = H5Screate_simple(2, size, nullptr);
  const hid_t data =
      H5Dcreate2(group, "motion", H5T_NATIVE_FLOAT, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const float rows[] = {1, 10, 2, 20, 3, 30};
  H5Dwrite(data, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows);
  for (const auto close : {H5Dclose(data), H5Sclose(space), H5Gclose(group), H5Fclose(file)})
    ASSERT_GE(close, 0);

  EXPECT_EQ(Table::load(path).column("signals/motion(2)"), (Values{10, 20, 30}));
}

TEST_F(TableTest, ReadsRecordingsBySignalName) {
  memmap::MapDescription description;
  description.name = "small";
  description.size_longwords = 1024;
  description.nodes = {{"daq", NodeId{1}, ""}};
  memmap::Signal signal;
  signal.name = "force";
  signal.unit = "N";
  memmap::Partition partition;
  partition.name = "daq";
  partition.node = "daq";
  partition.longwords = 1;
  partition.signals = {signal};
  description.partitions = {partition};
  const memmap::Map map{description};
  const auto path = folder_.path() / "run.h5";
  Writer writer{path, map, {SignalId{0}}, {}};
  for (int i = 0; i < 3; ++i) {
    const double row[] = {2.0 * i};
    writer.append(from_seconds(0.5 * i), row);
  }
  writer.close();

  const Table table = Table::load(path);

  EXPECT_EQ(table.column("time"), (Values{0, 0.5, 1}));
  EXPECT_EQ(table.column("daq.force"), (Values{0, 2, 4}));
}

}  // namespace
}  // namespace rths::recording
