// SPDX-License-Identifier: Apache-2.0
//
// Tables of recordings, written with the command.
#include <sys/stat.h>

#include <algorithm>

#include <gtest/gtest.h>

#include <rths/memmap/map.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/table.hpp>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

/// A recording of 1 s in the folder of a run.
class ExportCommand : public ::testing::Test {
 protected:
  ExportCommand() {
    const memmap::Map map = memmap::parse_map(R"(
ringmap = 1
[ring]
name = "sample"
version = 1
size_bytes = 4096
[nodes]
machine = 1
[[partition]]
name = "fbk"
node = "machine"
offset = 0
longwords = 3
[[partition.signal]]
name = "displ"
index = ["long", "lat"]
offset = 0
type = "f32"
unit = "mm"
[[partition.signal]]
name = "force"
offset = 2
type = "f32"
unit = "kN"
)",
                                              "sample");
    recording::Writer writer{
        recording(), map, {SignalId{0}, SignalId{1}, SignalId{2}}, recording::RecordingInfo{}};
    for (int i = 0; i <= 1000; ++i)
      writer.append(Duration{i * 1'000'000LL}, std::vector<double>{i * 1e-3, i * -1e-3, 5.0 * i});
    writer.close();
  }
  [[nodiscard]] std::filesystem::path recording() const { return folder.path() / "run.h5"; }
  [[nodiscard]] std::filesystem::path table() const { return folder.path() / "table"; }
  [[nodiscard]] test::Finished run(const std::vector<std::string>& options) const {
    return run_to(table(), options);
  }
  [[nodiscard]] test::Finished run_to(const std::filesystem::path& out,
                                      const std::vector<std::string>& options) const {
    std::vector<std::string> arguments{"export", folder.path().string(), "--out", out.string()};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return test::run_rths(arguments);
  }

  test::TemporaryFolder folder;
};

TEST_F(ExportCommand, WritesOneRowPerTimeWithTheChosenSignals) {
  const auto finished = run({"--signals", "fbk.l*.displ", "--from", "0.5", "--to", "0.502"});

  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(test::content_of(table()),
            "time [s],fbk.long.displ [m],fbk.lat.displ [m]\n"
            "0.500000000,0.5,-0.5\n"
            "0.501000000,0.501,-0.501\n"
            "0.502000000,0.502,-0.502\n");
  EXPECT_NE(finished.out.find("3 rows of 2 signals, 0.500 to 0.502 s"), std::string::npos);
}

TEST_F(ExportCommand, WritesTheWholeRecordingAsAMatFile) {
  ASSERT_EQ(run({"--format", "mat"}).exit_code, 0);

  const auto read = recording::Table::load(table());
  EXPECT_EQ(read.column("time").size(), 1001U);
  EXPECT_EQ(read.column("values(3)").back(), 5000);
}

TEST_F(ExportCommand, ReportsWrongInputAndWritesNothing) {
  const auto error = [&](const std::vector<std::string>& options) { return run(options).err; };
  const std::string file = recording().string();

  EXPECT_EQ(error({"--signals", "fbk.lng.displ"}),
            "rths: " + file +
                ": no signal matches 'fbk.lng.displ' (did you mean "
                "'fbk.long.displ'?)\n");
  EXPECT_EQ(error({"--signals", "fbk.*", "nothing.*"}),
            "rths: " + file + ": no signal matches 'nothing.*'\n");
  EXPECT_EQ(error({"--from", "2", "--to", "3"}),
            "rths: no row from 2 to 3 s, expected times from 0 to 1 s\n");
  EXPECT_EQ(error({"--from", "0.6", "--to", "0.4"}),
            "rths: no row from 0.6 to 0.4 s, expected times from 0 to 1 s\n");
  EXPECT_EQ(run_to(recording(), {}).err,
            "rths: " + recording().string() +
                ": is the recording itself, expected another file (--out)\n");
  const auto other = recording().parent_path() / "other.h5";
  std::filesystem::copy_file(recording(), other);
  EXPECT_EQ(run_to(other, {}).err, "rths: " + other.string() +
                                       ": is a recording, expected another file for the results\n");
  EXPECT_EQ(test::content_of(other), test::content_of(recording()));
  EXPECT_EQ(run({"--format", "xls"}).exit_code, 3);
  EXPECT_EQ(run({"--from", "soon"}).exit_code, 3);
  EXPECT_FALSE(std::filesystem::exists(table()));
  EXPECT_EQ(test::run_rths({"export", "/no/such.h5"}).exit_code, 2);
}

TEST_F(ExportCommand, ReplacesNothingButAnEarlierTable) {
  const auto other = folder.path() / "other.csv";
  folder.write("table.part", "of somebody else");
  folder.write("other.csv", "an earlier table");
  std::filesystem::create_symlink("other.csv", folder.path() / "link");
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);

  EXPECT_EQ(run({}).exit_code, 0);
  EXPECT_EQ(test::content_of(folder.path() / "table.part"), "of somebody else");
  EXPECT_EQ(run_to(folder.path() / "link", {}).exit_code, 0);
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path() / "link"));
  EXPECT_EQ(test::content_of(other), test::content_of(table()));
  for (const char* name : {"pipe", "."}) {
    const auto refused = folder.path() / name;
    EXPECT_EQ(run_to(refused, {}).err,
              "rths: " + refused.string() + ": is no regular file, expected one for the results\n");
  }
  EXPECT_TRUE(std::filesystem::is_fifo(folder.path() / "pipe"));
  const auto nowhere = folder.path() / "missing/table";
  EXPECT_EQ(run_to(nowhere, {}).err,
            "rths: " + nowhere.string() + ": cannot be written: No such file or directory\n");
}

}  // namespace
}  // namespace rths
