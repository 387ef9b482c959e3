// SPDX-License-Identifier: Apache-2.0
//
// Packed FMUs, and the temporary folders that they leave: none.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include <gtest/gtest.h>

#include "bench_node.hpp"
#include "support/bench.hpp"
#include "test_fmu.hpp"

namespace rths::fmi {
namespace {

namespace fs = std::filesystem;

/// Temporary folders of this test are in a folder of its own.
class PackedFmu : public ::testing::Test {
 protected:
  PackedFmu() { setenv("TMPDIR", temporary.path().c_str(), 1); }
  ~PackedFmu() override { unsetenv("TMPDIR"); }

  [[nodiscard]] long left() const {
    return std::distance(fs::directory_iterator{temporary.path()}, fs::directory_iterator{});
  }
  [[nodiscard]] std::string error_of_load(const fs::path& file) const {
    return test::error_of([&] { static_cast<void>(node.make(file, test::lag_table(3))); });
  }

  // A process that has loaded the FMU and is killed.
  void be_killed_with(const fs::path& file) const {
    const pid_t process = fork();
    if (process == 0) {
      const auto adapter = node.make(file, test::lag_table(3));
      raise(SIGKILL);
    }
    waitpid(process, nullptr, 0);
  }

  test::TemporaryFolder folder, temporary;
  test::BenchNode node;
};

TEST_F(PackedFmu, OfAKilledProcessIsRemovedAtTheEndOfAnother) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 3, "correct"));
  {
    const auto adapter = node.make(file, test::lag_table(3));
    be_killed_with(file);
    EXPECT_EQ(left(), 4);
  }
  EXPECT_EQ(left(), 0);
}

TEST_F(PackedFmu, IsUnpackedWhileItsAdapterLives) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 3, "correct"));
  {
    const auto adapter = node.make(file, test::lag_table(3));
    EXPECT_EQ(left(), 2);  // the folder and its lock
    adapter->activate();
    test::Bench bench{*adapter};
    EXPECT_EQ(bench.step(0), Status::Ok) << bench.message();
    adapter->deactivate();
  }
  EXPECT_EQ(left(), 0);
}

TEST_F(PackedFmu, LeavesNothingInAProcessOfItsOwn) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 2, "crashes"));
  {
    const auto adapter = node.make(file, test::lag_table(2), "own_process = true\n");
    adapter->activate();
    test::Bench bench{*adapter};
    Status status = Status::Ok;
    for (int i = 0; i < 110 && status == Status::Ok; ++i) status = bench.step(0.001 * i);
    EXPECT_EQ(status, Status::Fault);
  }
  EXPECT_EQ(left(), 0);
}

TEST_F(PackedFmu, LeavesNothingWhenItsLibraryIsMissingOrBroken) {
  const auto description = test::lag_description(3, "correct");
  const auto without = test::pack_fmu(test::write_fmu(folder, description, "", 3));
  EXPECT_NE(error_of_load(without).find("it has no binaries"), std::string::npos)
      << error_of_load(without);

  const auto root = test::write_fmu(folder, description, test::lag_library(3, "correct"), 3);
  std::ofstream{root / "binaries/x86_64-linux/correct.so"} << "no library";
  EXPECT_NE(error_of_load(test::pack_fmu(root)).find("cannot load its library"), std::string::npos);

  const auto other = test::write_fmu(folder, test::lag_description(3, "correct"),
                                     test::lag_library(2, "correct"), 3);
  EXPECT_NE(error_of_load(test::pack_fmu(other)).find("exports no fmi3InstantiateCoSimulation"),
            std::string::npos);
  EXPECT_EQ(left(), 0);
}

TEST_F(PackedFmu, DoesNotWriteOutsideItsFolder) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 3, "correct"), "../outside.xml");

  EXPECT_NE(
      error_of_load(file).find("holds a file '../outside.xml', expected names inside the FMU"),
      std::string::npos)
      << error_of_load(file);
  EXPECT_EQ(left(), 0);
}

TEST_F(PackedFmu, ThatIsDamagedIsRefused) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 3, "correct"));
  fs::resize_file(file, fs::file_size(file) / 2);
  EXPECT_NE(error_of_load(file).find("cannot be read as an FMU"), std::string::npos);

  const auto text = folder.write("text.fmu", "no archive");
  EXPECT_NE(error_of_load(text).find("cannot be read as an FMU"), std::string::npos);
  fs::create_directory(folder.path() / "empty");
  EXPECT_NE(error_of_load(folder.path() / "empty").find("has no modelDescription.xml"),
            std::string::npos);
  EXPECT_NE(error_of_load(folder.path() / "none.fmu").find("expected an FMU"), std::string::npos);
  EXPECT_EQ(left(), 0);
}

TEST_F(PackedFmu, NamesTheFolderThatIsMissing) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 3, "correct"));
  setenv("TMPDIR", "/no/such", 1);

  EXPECT_EQ(error_of_load(file),
            "node 'mac': /no/such: no folder for temporary files: No such file or directory; the "
            "variable TMPDIR names it");
}

TEST_F(PackedFmu, OfAKilledProcessIsRemovedByTheNext) {
  const auto file = test::pack_fmu(test::lag_fmu(folder, 3, "correct"));
  be_killed_with(file);
  ASSERT_EQ(left(), 2);

  {
    const auto first = node.make(file, test::lag_table(3));
    EXPECT_EQ(left(), 2);
    // Another FMU of a living process stays.
    const auto second = node.make(file, test::lag_table(3));
    EXPECT_EQ(left(), 4);
  }
  EXPECT_EQ(left(), 0);
}

}  // namespace
}  // namespace rths::fmi
