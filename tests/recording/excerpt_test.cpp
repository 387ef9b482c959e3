// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/excerpt.hpp>

#include <matio.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>

#include <gtest/gtest.h>

#include <rths/recording/table.hpp>

#include "support/files.hpp"

namespace rths::recording {
namespace {

const Excerpt kExcerpt{
    {0.5, 0.501}, {"srmd.long.displ.fbk", "daq.atTarget"}, {"m", "1"}, {{0.1, -2e-9}, {1, NAN}}};

std::vector<std::string> cells(const std::filesystem::path& file, const char* name) {
  mat_t* opened = Mat_Open(file.c_str(), MAT_ACC_RDONLY);
  matvar_t* variable = Mat_VarRead(opened, name);
  std::vector<std::string> texts;
  for (std::size_t i = 0; variable != nullptr && i < variable->dims[0]; ++i) {
    const matvar_t* cell = Mat_VarGetCell(variable, static_cast<int>(i));
    texts.emplace_back(static_cast<const char*>(cell->data), cell->nbytes);
  }
  Mat_VarFree(variable);
  Mat_Close(opened);
  return texts;
}

TEST(Excerpt, IsWrittenAsCsvWithUnitsInTheHeader) {
  const test::TemporaryFolder folder;
  write_csv(kExcerpt, folder.path() / "run.csv");

  EXPECT_EQ(test::content_of(folder.path() / "run.csv"),
            "time [s],srmd.long.displ.fbk [m],daq.atTarget [1]\n"
            "0.500000000,0.1,1\n"
            "0.501000000,-2e-09,NaN\n");
}

TEST(Excerpt, IsWrittenAsAMatFile) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "run.mat";
  write_mat(kExcerpt, file);

  const Table table = Table::load(file);
  EXPECT_EQ(table.column("time"), kExcerpt.time);
  EXPECT_EQ(table.column("values(1)"), kExcerpt.values[0]);
  EXPECT_EQ(table.column_with_gaps("values(2)").values[0], 1);
  EXPECT_TRUE(std::isnan(table.column_with_gaps("values(2)").values[1]));
  EXPECT_EQ(cells(file, "names"), kExcerpt.names);
  EXPECT_EQ(cells(file, "units"), kExcerpt.units);
}

// An earlier file is kept, and no half of the new one remains.
TEST(Excerpt, ReportsAFullFileSystem) {
  const test::TemporaryFolder folder;
  Excerpt excerpt{{}, {"a"}, {"m"}, {{}}};
  for (int i = 0; i < 100'000; ++i) {
    excerpt.time.push_back(i * 1e-3);
    excerpt.values[0].push_back(std::sin(i));
  }
  for (const auto write : {write_csv, write_mat}) {
    const auto file = folder.write("table", "an earlier table");
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{50'000, 50'000};
      setrlimit(RLIMIT_FSIZE, &limit);
      const std::string error = test::error_of([&] { write(excerpt, file); });
      _exit(error.starts_with(file.string() + ": cannot be written") ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
    EXPECT_EQ(test::content_of(file), "an earlier table");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator{folder.path()}, {}), 1);
  }
}

}  // namespace
}  // namespace rths::recording
