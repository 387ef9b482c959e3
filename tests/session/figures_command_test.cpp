// SPDX-License-Identifier: Apache-2.0
//
// Figures of a page as files: `--figures` of the commands that write a page.
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/files.hpp"
#include "support/process.hpp"

namespace rths {
namespace {

namespace fs = std::filesystem;
using test::content_of;
using test::Finished;

constexpr const char* kBrowser = "/usr/bin/chromium";

/// Sets a variable of the environment as long as it lives.
class Variable {
 public:
  Variable(std::string name, const std::string& value) : name_{std::move(name)} {
    if (const char* before = std::getenv(name_.c_str())) before_ = before;
    setenv(name_.c_str(), value.c_str(), 1);
  }
  ~Variable() {
    if (before_.empty())
      unsetenv(name_.c_str());
    else
      setenv(name_.c_str(), before_.c_str(), 1);
  }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  std::string name_, before_;
};

/// Two tables whose force differs in one row.
class FiguresCommand : public ::testing::Test {
 protected:
  FiguresCommand() {
    folder_.write("a.csv", "time [s],force [kN]\n0,1\n0.1,2\n0.2,3\n0.3,4\n");
    folder_.write("b.csv", "time [s],force [kN]\n0,1\n0.1,2\n0.2,5\n0.3,4\n");
    fs::create_directory(folder_.path() / "temporary");
    fs::create_directory(folder_.path() / "programs");
    fs::create_directory(folder_.path() / "home");
  }
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& options) const {
    std::vector<std::string> words{"compare", (folder_.path() / "a.csv").string(),
                                   (folder_.path() / "b.csv").string()};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  [[nodiscard]] std::vector<std::string> with_figures(
      const std::vector<std::string>& options = {}) const {
    auto words = command(
        {"--page", (folder_.path() / "page #1.html").string(), "--figures", figures_.string()});
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  /// A program in the place of the browser.
  void replace_browser(const std::string& script) const {
    const auto file = folder_.write("programs/chromium", "#!/bin/sh\n" + script + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }
  [[nodiscard]] bool left_nothing() const {
    return fs::is_empty(folder_.path() / "temporary") && fs::is_empty(folder_.path() / "home");
  }

  const test::TemporaryFolder folder_;
  const fs::path figures_ = folder_.path() / "out/figures";
  const Variable temporary_{"TMPDIR", (folder_.path() / "temporary").string()};
  const Variable home_{"HOME", (folder_.path() / "home").string()};
};

TEST_F(FiguresCommand, WritesEachFigureInThreeFormats) {
  if (!fs::exists(kBrowser)) GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";

  const Finished written = test::run_rths(with_figures());

  EXPECT_EQ(written.exit_code, 0) << written.err;
  EXPECT_NE(written.out.find(figures_.string() + ": 6 files\n"), std::string::npos) << written.out;
  for (const char* name : {"force", "force_difference"}) {
    EXPECT_TRUE(content_of(figures_ / (std::string{name} + ".png")).starts_with("\x89PNG")) << name;
    const std::string drawing = content_of(figures_ / (std::string{name} + ".svg"));
    EXPECT_TRUE(drawing.starts_with("<svg ")) << drawing.substr(0, 100);
    EXPECT_TRUE(drawing.ends_with("</svg>"));
  }
  EXPECT_EQ(content_of(figures_ / "force_difference.csv"),
            "time [s],other − baseline: difference [kN]\n0,0\n0.1,0\n0.2,2\n0.3,0\n");
  EXPECT_TRUE(left_nothing());
}

TEST_F(FiguresCommand, ReplacesFiguresOnlyIfItIsForced) {
  if (!fs::exists(kBrowser)) GTEST_SKIP() << "SKIPPED: no Chromium here; './lab test' installs it";
  fs::create_directories(figures_);
  folder_.write("out/figures/force.csv", "mine");
  folder_.write("out/figures/note.txt", "mine");

  const Finished refused = test::run_rths(with_figures());
  const std::string kept = content_of(figures_ / "force.csv");
  const Finished forced = test::run_rths(with_figures({"--force"}));

  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err, "rths: " + figures_.string() +
                             ": has files, expected a new folder for the figures, or --force to "
                             "replace those of the same names\n");
  EXPECT_EQ(kept, "mine");
  EXPECT_EQ(forced.exit_code, 0) << forced.err;
  EXPECT_NE(content_of(figures_ / "force.csv"), "mine");
  EXPECT_EQ(content_of(figures_ / "note.txt"), "mine");
}

TEST_F(FiguresCommand, SaysWhichProgramIsMissing) {
  const Variable path{"PATH", (folder_.path() / "programs").string()};

  const Finished refused = test::run_rths(with_figures());

  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_EQ(refused.err,
            "rths: the figures need Chromium, which draws them: none of chromium, "
            "chromium-browser, google-chrome is in PATH; install it, on Debian by 'apt install "
            "chromium'\n");
  EXPECT_FALSE(fs::exists(figures_));
  EXPECT_TRUE(left_nothing());
}

TEST_F(FiguresCommand, RefusesAPageThatWasNotDrawn) {
  const Variable path{"PATH", (folder_.path() / "programs").string() + ":/usr/bin:/bin"};
  replace_browser("echo '<html></html>'");

  const Finished refused = test::run_rths(with_figures());

  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("Chromium has not drawn its figures"), std::string::npos)
      << refused.err;
  EXPECT_FALSE(fs::exists(figures_));
  EXPECT_TRUE(left_nothing());
}

TEST_F(FiguresCommand, LeavesNothingWhenItIsInterrupted) {
  const Variable path{"PATH", (folder_.path() / "programs").string() + ":/usr/bin:/bin"};
  replace_browser("touch \"$TMPDIR/begun\"; sleep 100");
  auto words = with_figures();
  words.insert(words.begin(), test::rths_command());
  test::Running running{words};
  const auto has_begun = [&] {
    for (const auto& entry : fs::recursive_directory_iterator{folder_.path() / "temporary"})
      if (entry.path().filename() == "begun") return true;
    return false;
  };
  for (int i = 0; i < 1000 && !has_begun(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{20});

  kill(running.pid(), SIGINT);
  const Finished ended = running.wait(30);

  EXPECT_EQ(ended.exit_code, 1) << ended.err;
  EXPECT_EQ(ended.err, "rths: interrupted\n");
  EXPECT_LT(ended.host_seconds, 20);
  EXPECT_TRUE(left_nothing());
}

TEST_F(FiguresCommand, NeedsTheNameOfAPage) {
  EXPECT_EQ(test::run_rths(command({"--page", ""})).err,
            "rths: the file for the results has no name\n");
  EXPECT_EQ(test::run_rths(command({"--figures", "x"})).exit_code, 3);
}

}  // namespace
}  // namespace rths
