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
    EXPECT_EQ(table.column_with_gaps("u").values[0], 1);
    EXPECT_TRUE(std::isnan(table.column_with_gaps("u").values[1]));
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
  EXPECT_EQ(load("t,u,day\n0,1,Mon\n,,Mon\n").column_with_gaps("u").values.size(), 2U);
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
  EXPECT_TRUE(std::isnan(hole.column_with_gaps("u").values[0]));
}

TEST_F(TableTest, RefusesUtf16) {
  for (const std::string mark : {"\xFF\xFE", "\xFE\xFF"})
    EXPECT_EQ(error(mark + "t,u\n0,1\n"), "log.csv: found text in UTF-16, expected UTF-8");
  EXPECT_EQ(error(std::string{"t\0,\0u\0\n\0", 8}),
            "log.csv: found bytes that are zero, expected text");
}

TEST_F(TableTest, ReadsDecimalCommasBetweenOtherSeparators) {
  for (const char* text : {"t;u\n0;1,5\n0,1;2,5\n", "t\tu\n0\t1,5\n0,1\t2,5\n",
                           "t u\r0 1,5\r0,1 2,5\r", "Rate;100.5\nt;u\ns;mm\n0;1,5\n0,1;2,5\n"}) {
    const Table table = load(text);
    EXPECT_EQ(table.column("t"), (Values{0, 0.1})) << text;
    EXPECT_EQ(table.column("u"), (Values{1.5, 2.5})) << text;
  }
}

TEST_F(TableTest, KeepsTheUnitsBelowTheNames) {
  EXPECT_EQ(load("t,u\ns,mm\n0,1\n").columns()[1].unit, "mm");
  EXPECT_EQ(load("t [s],u [mm]\n0,1\n").columns()[1].unit, "");
}

TEST_F(TableTest, RefusesAmbiguousDecimalCommas) {
  const auto expect = [&](const std::string& text, int line, const std::string& cell) {
    EXPECT_EQ(error(text), "log.csv:" + std::to_string(line) + ": '" + cell +
                               "' looks like numbers with decimal commas, expected points");
  };
  expect("t;u\n0,0;1.5\n", 2, "0,0");
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

/// Writes MAT files; variables are freed with it.
class MatFile {
 public:
  MatFile(const std::filesystem::path& file, mat_ft version)
      : file_{Mat_CreateVer(file.c_str(), nullptr, version)} {}
  ~MatFile() { Mat_Close(file_); }
  MatFile(const MatFile&) = delete;
  MatFile& operator=(const MatFile&) = delete;

  /// @param values  column by column
  static matvar_t* matrix(const char* name, std::size_t rows, Values values) {
    std::size_t sizes[] = {rows, values.size() / rows};
    return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes, values.data(), 0);
  }
  static matvar_t* structures(const char* name, std::size_t count,
                              std::vector<const char*> fields) {
    std::size_t sizes[] = {1, count};
    return Mat_VarCreateStruct(name, 2, sizes, fields.data(), static_cast<unsigned>(fields.size()));
  }
  void write(matvar_t* variable) {
    EXPECT_EQ(Mat_VarWrite(file_, variable, MAT_COMPRESSION_NONE), 0);
    Mat_VarFree(variable);
  }

 private:
  mat_t* file_;
};

// As programs of control systems write them: rec.X.Data, rec.Y(1).Data, rec.Y(2).Data.
TEST_F(TableTest, ReadsEveryElementOfAnArrayOfStructures) {
  for (const auto version : {MAT_FT_MAT5, MAT_FT_MAT73}) {
    const auto file = folder_.path() / "log.mat";
    {
      MatFile mat{file, version};
      matvar_t* rec = MatFile::structures("rec", 1, {"X", "Y"});
      matvar_t* x = MatFile::structures("X", 1, {"Data"});
      matvar_t* y = MatFile::structures("Y", 2, {"Data"});
      Mat_VarSetStructFieldByName(x, "Data", 0, MatFile::matrix("Data", 1, {0, 0.1, 0.2}));
      Mat_VarSetStructFieldByName(y, "Data", 0, MatFile::matrix("Data", 1, {1, 2, 3}));
      Mat_VarSetStructFieldByName(y, "Data", 1, MatFile::matrix("Data", 1, {10, 20, 30}));
      Mat_VarSetStructFieldByName(rec, "X", 0, x);
      Mat_VarSetStructFieldByName(rec, "Y", 0, y);
      mat.write(rec);
    }

    const Table table = Table::load(file);

    EXPECT_EQ(table.columns().size(), 3U) << version;
    EXPECT_EQ(table.column("rec.X.Data"), (Values{0, 0.1, 0.2})) << version;
    EXPECT_EQ(table.column("rec(1).X(1).Data"), (Values{0, 0.1, 0.2})) << version;
    EXPECT_EQ(table.column("rec.Y(1).Data"), (Values{1, 2, 3})) << version;
    EXPECT_EQ(table.column("rec.Y(2).Data"), (Values{10, 20, 30})) << version;
    EXPECT_EQ(table.column("rec.Y(2).Data(:)"), (Values{10, 20, 30})) << version;
    EXPECT_NE(test::error_of([&] {
                static_cast<void>(table.column("rec.Y.Data"));
              }).find("there is no column 'rec.Y.Data'"),
              std::string::npos);
  }
}

TEST_F(TableTest, ReadsCellsByIndex) {
  const auto file = folder_.path() / "log.mat";
  {
    MatFile mat{file, MAT_FT_MAT5};
    std::size_t sizes[] = {1, 2};
    matvar_t* cells = Mat_VarCreate("signals", MAT_C_CELL, MAT_T_CELL, 2, sizes, nullptr, 0);
    Mat_VarSetCell(cells, 0, MatFile::matrix("", 3, {1, 2, 3}));
    Mat_VarSetCell(cells, 1, MatFile::matrix("", 3, {10, 20, 30}));
    mat.write(cells);
  }

  EXPECT_EQ(Table::load(file).column("signals{2}"), (Values{10, 20, 30}));
}

// A recording has more samples than signals.
TEST_F(TableTest, TakesTheLongerSideOfAMatrixForTime) {
  const auto file = folder_.path() / "log.mat";
  {
    MatFile mat{file, MAT_FT_MAT5};
    mat.write(MatFile::matrix("ans", 2, {0, 10, 1, 20, 2, 30}));
    mat.write(MatFile::matrix("u", 3, {0, 1, 2, 10, 20, 30}));
  }

  const Table table = Table::load(file);

  for (const char* name : {"ans(2)", "ans(2,:)", "u(2)", "u(:,2)"})
    EXPECT_EQ(table.column(name), (Values{10, 20, 30})) << name;
  EXPECT_NE(test::error_of([&] { static_cast<void>(table.column("ans(:,2)")); }), "");
}

/// One row of a compound.
struct Sample {
  double time;
  std::int32_t force;
  double motion[2];
};

TEST_F(TableTest, ReadsMembersOfCompounds) {
  const auto path = folder_.path() / "log.h5";
  const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  const hsize_t count[] = {3}, pair[] = {2};
  const hid_t space = H5Screate_simple(1, count, nullptr);
  const hid_t type = H5Tcreate(H5T_COMPOUND, sizeof(Sample));
  const hid_t list = H5Tarray_create2(H5T_NATIVE_DOUBLE, 1, pair);
  H5Tinsert(type, "time", HOFFSET(Sample, time), H5T_NATIVE_DOUBLE);
  H5Tinsert(type, "force", HOFFSET(Sample, force), H5T_NATIVE_INT32);
  H5Tinsert(type, "motion", HOFFSET(Sample, motion), list);
  const hid_t data = H5Dcreate2(file, "log", type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  const Sample rows[] = {{0, 1, {10, 100}}, {0.1, 2, {20, 200}}, {0.2, 3, {30, 300}}};
  H5Dwrite(data, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows);
  for (const auto close :
       {H5Dclose(data), H5Tclose(list), H5Tclose(type), H5Sclose(space), H5Fclose(file)})
    ASSERT_GE(close, 0);

  const Table table = Table::load(path);

  EXPECT_EQ(table.column("log.time"), (Values{0, 0.1, 0.2}));
  EXPECT_EQ(table.column("log.force"), (Values{1, 2, 3}));
  EXPECT_EQ(table.column("log.motion(2)"), (Values{100, 200, 300}));
  EXPECT_TRUE(Table::is_format_of(path));
}

std::string lvm(const std::string& columns, const std::string& segment) {
  return "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\n"
         "Multi_Headings\tYes\nX_Columns\t" +
         columns + "\nTime\t14:37:48.2010\n***End_of_Header***\t\n\t\n" + segment;
}

std::string lvm_header(const std::string& samples = "3\t3", const std::string& step = "0.1\t0.1",
                       const std::string& start = "0\t0") {
  return "Channels\t2\t\t\nSamples\t" + samples + "\nDate\t2024/05/13\t2024/05/13\nX0\t" + start +
         "\nDelta_X\t" + step + "\n***End_of_Header***\t\t\n";
}

TEST_F(TableTest, ReadsLvmWithAnyColumnsOfX) {
  const std::string one = lvm("One", lvm_header() +
                                         "X_Value\tu\tF\tComment\n0\t1\t10\tstart\n0.1\t2\t20\n"
                                         "0.2\t3\t30\n");
  const std::string multi = lvm("Multi", lvm_header() +
                                             "X_Value\tu\tX_Value\tF\tComment\n0\t1\t0.05\t10\n"
                                             "0.1\t2\t0.15\t20\n0.2\t3\t0.25\t30\n");
  const std::string none =
      lvm("No", lvm_header() + "X_Value\tu\tF\tComment\n\t1\t10\n\t2\t20\n\t3\t30\n");
  std::string commas = none;
  commas.replace(commas.find("Separator\t."), 11, "Separator\t,");
  for (auto at = commas.find("0.1"); at != std::string::npos; at = commas.find("0.1"))
    commas.replace(at, 3, "0,1");
  for (const auto& text : {one, multi, none, commas}) {
    const Table table = load(text);
    const auto& time = table.column("X_Value");
    ASSERT_EQ(time.size(), 3U) << text;
    EXPECT_NEAR(time[2], 0.2, 1e-12) << text;
    EXPECT_EQ(table.column("u"), (Values{1, 2, 3})) << text;
    EXPECT_EQ(table.column("F"), (Values{10, 20, 30})) << text;
  }
  EXPECT_EQ(load(multi).column("X_Value(2)"), (Values{0.05, 0.15, 0.25}));
  EXPECT_TRUE(Table::is_format_of(folder_.write("log.lvm", one)));
}

TEST_F(TableTest, JoinsSegmentsOfLvmThatGoOn) {
  const std::string names = "X_Value\tu\tF\n";
  const std::string first = lvm_header("2\t2") + names + "0\t1\t10\n0.1\t2\t20\n\n";
  const std::string next = lvm_header("1\t1", "0.1\t0.1", "0.2\t0.2") + names + "0.2\t3\t30\n";

  EXPECT_EQ(load(lvm("One", first + next)).column("F"), (Values{10, 20, 30}));
  EXPECT_NE(error(lvm("One", first + first)).find("a further segment begins at 0 s, after 0.1 s"),
            std::string::npos);
  EXPECT_NE(error(lvm("One", first + lvm_header("1\t1") + "X_Value\tu\tG\n0.2\t3\t30\n"))
                .find("the segment has other channels than the first one"),
            std::string::npos);
}

// Then Samples counts the first packet alone.
TEST_F(TableTest, ReadsFurtherPacketsOfLvmWithoutHeader) {
  std::string text = lvm("One", lvm_header("1\t1") + "X_Value\tu\tF\n0\t1\t10\n0.1\t2\t20\n");
  text.replace(text.find("Yes"), 3, "No");

  EXPECT_EQ(load(text).column("F"), (Values{10, 20}));
}

TEST_F(TableTest, RefusesDamagedLvmByItsLine) {
  const std::string rows = "X_Value\tu\tF\n0\t1\t10\n0.1\t2\t20\n0.2\t3\t30\n";
  const auto expect = [&](const std::string& text, const std::string& message) {
    EXPECT_NE(error(text).find(message), std::string::npos) << error(text);
  };
  expect(lvm("One", lvm_header("4\t4") + rows), "3 rows found, expected Samples = 4");
  expect(lvm("One", lvm_header("2\t2") + rows), "3 rows found, expected Samples = 2");
  expect(lvm("One", "Channels\t2\n"), "found no end of the header");
  expect(lvm("One", lvm_header()), "found no names below the header");
  expect(lvm("One", ""), "found no segment");
  expect(lvm("One", lvm_header() + "X_Value\tu\tu\n0\t1\t10\n"), "two columns are named 'u'");
  expect(lvm("No", lvm_header("1\t1", "0.1\t0.2") + "X_Value\tu\tF\n\t1\t10\n"),
         "'Delta_X' of the channels differ");
  const Table table = load(lvm("One", lvm_header("1\t1") + "X_Value\tu\tF\n0\tx\t10\n"));
  EXPECT_NE(test::error_of([&] {
              static_cast<void>(table.column("u"));
            }).find("found 'x' in column 'u', expected a finite number"),
            std::string::npos);
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
