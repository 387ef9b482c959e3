// SPDX-License-Identifier: Apache-2.0
//
// The live page in Chromium.
#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/monitor/server.hpp>

#include "monitor/laboratory.hpp"
#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths::monitor {
namespace {

using test::Laboratory;
using test::settings_for;
using test::unique_ring;

/// A browser that asks the page questions of browse.js.
class Browser {
 public:
  Browser(const PageServer& server, const std::string& questions,
          std::vector<std::string> options = {})
      : script_{folder_.write(
            "script.js", "const asked = " + questions + ", token = 'secret';\n" +
                             test::content_of(test::source_tree() / "tests/monitor/browse.js"))},
        running_{command(server, std::move(options))} {}

  /// Its answers, a line each.
  [[nodiscard]] std::string answers() {
    const auto finished = running_.wait(120);
    return finished.out + finished.err;
  }

 private:
  [[nodiscard]] std::vector<std::string> command(const PageServer& server,
                                                 std::vector<std::string> options) const {
    std::vector<std::string> words{"/bin/bash",
                                   "-c",
                                   "exec python3 \"$@\" < " + script_.string(),
                                   "drive",
                                   (test::source_tree() / "tests/monitor/drive.py").string(),
                                   "http://127.0.0.1:" + std::to_string(server.port()) + "/"};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }
  test::TemporaryFolder folder_;
  std::filesystem::path script_;
  test::Running running_;
};

std::string missing(const std::string& answers, const std::vector<std::string>& expected) {
  std::string text;
  for (const auto& line : expected)
    if (("\n" + answers).find("\n" + line + "\n") == std::string::npos) text += line + "\n";
  return text;
}

class LivePage : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists("/usr/bin/chromium")) GTEST_SKIP() << "there is no Chromium";
  }
};

const std::vector<std::string> kTestPage{
    "state: true", "values move: true", "curves move: true",
    "unit: mm",    "safety: running",   "nodes: srmd alive, xpc alive",
    "loop: true",  "fits: true",        "errors: none"};

TEST_F(LivePage, ShowsMovingValuesInLight) {
  const Laboratory laboratory{unique_ring("light")};
  auto settings = settings_for(unique_ring("light"));
  settings.limits = {{"long", 0.02, std::numeric_limits<double>::infinity(), 1e-3}};
  const PageServer server{settings};

  const std::string answers = Browser{server, "['test']"}.answers();

  EXPECT_EQ(missing(answers, kTestPage), "") << answers;
  EXPECT_EQ(missing(answers, {"limits: 20 mm, 1 mm", "ground: rgb(245, 246, 248)"}), "") << answers;
}

TEST_F(LivePage, FitsANarrowScreenInTheDark) {
  const Laboratory laboratory{unique_ring("dark")};
  const PageServer server{settings_for(unique_ring("dark"))};

  const std::string answers =
      Browser{server, "['test']", {"--size", "400x900", "--dark"}}.answers();

  EXPECT_EQ(missing(answers, kTestPage), "") << answers;
  EXPECT_EQ(missing(answers, {"ground: rgb(18, 23, 28)"}), "") << answers;
}

TEST_F(LivePage, PausesScrollsAndZooms) {
  const Laboratory laboratory{unique_ring("time")};
  const PageServer server{settings_for(unique_ring("time"))};

  const std::string answers = Browser{server, "['test', 'time']"}.answers();

  EXPECT_EQ(missing(answers, {"paused: true", "stands still: true", "zooms in: true",
                              "scrolls back: true", "drag zooms: true", "all figures follow: true",
                              "live again: true", "errors: none"}),
            "")
      << answers;
}

TEST_F(LivePage, DrawsOnlyFiguresThatAreSeen) {
  const Laboratory laboratory{unique_ring("seen")};
  const PageServer server{settings_for(unique_ring("seen"))};

  const std::string answers = Browser{server, "['test', 'seen']", {"--size", "1400x600"}}.answers();

  EXPECT_EQ(missing(answers, {"draws what is seen: true", "draws nothing else: true",
                              "draws what is scrolled to: true", "errors: none"}),
            "")
      << answers;
}

TEST_F(LivePage, IsUsedByKeysAlone) {
  const Laboratory laboratory{unique_ring("keys")};
  const PageServer server{settings_for(unique_ring("keys"))};

  const std::string answers = Browser{server, "['test', 'keys']"}.answers();

  EXPECT_EQ(missing(answers, {"space pauses: true", "plus zooms: true", "l follows: true",
                              "slash searches: true", "enter shows: true", "digit opens: true",
                              "arrows open: true", "focus is shown: true", "errors: none"}),
            "")
      << answers;
}

TEST_F(LivePage, ShowsAnySignal) {
  const Laboratory laboratory{unique_ring("signals")};
  const PageServer server{settings_for(unique_ring("signals"))};

  const std::string answers = Browser{server, "['test', 'signals']"}.answers();

  EXPECT_EQ(missing(answers, {"search: monitor.xpc.displacement.out.long", "figure: true",
                              "two signals: 2", "difference: 0.1", "writer: xpc",
                              "last write: true", "removed: true", "errors: none"}),
            "")
      << answers;
}

TEST_F(LivePage, ChangesAParameterWithTheTokenOnly) {
  const Laboratory laboratory{unique_ring("tuned")};
  auto settings = settings_for(unique_ring("tuned"));
  settings.controls = true;
  settings.token = "secret";
  const PageServer server{settings};

  const std::string answers = Browser{server, "['test', 'parameter']"}.answers();

  EXPECT_EQ(
      missing(answers, {"without token: the token is wrong", "wrong token: the token is wrong",
                        "beyond its range: tune.srmd.gain=7: expected 0.5 to 2 1",
                        "with token: done", "value: true", "event: true", "errors: none"}),
      "")
      << answers;
}

TEST_F(LivePage, ShowsHostsAndViolationsOfOwnership) {
  const Laboratory laboratory{unique_ring("ring")};
  const PageServer server{settings_for(unique_ring("ring"))};
  Browser browser{server, "['test', 'ring']"};
  auto other = broker::Ring::attach(unique_ring("ring"));
  broker::Node client = other.join_plain("");
  for (int i = 0; i < 3000 && server.viewers() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{10});

  client.plain_memory()[32] = 7;  // the parameter, which nobody writes

  const std::string answers = browser.answers();
  EXPECT_EQ(missing(answers, {"hop: srmd east 2.00 0.50", "violation: tune.srmd.gain",
                              "is said: true", "errors: none"}),
            "")
      << answers;
}

TEST_F(LivePage, ListsAndComparesRuns) {
  const test::TemporaryFolder folder;
  for (const std::string run : {"one", "two"}) {
    std::filesystem::create_directory(folder.path() / run);
    folder.write(run + "/run.h5", "");
    folder.write(run + "/report.html", "");
    folder.write(run + "/report.json", R"({"name": ")" + run + R"(", "conclusive": true})");
  }
  auto settings = settings_for(unique_ring("results"));
  settings.runs = folder.path();
  settings.compare = [](const auto& a, const auto& b) {
    return a.filename().string() + " and " + b.filename().string();
  };
  const PageServer server{settings};

  const std::string answers = Browser{server, "['runs']"}.answers();

  EXPECT_EQ(missing(answers, {"runs: one, two", "compared: true", "errors: none"}), "") << answers;
  EXPECT_NE(answers.find("/report.html\n"), std::string::npos) << answers;
}

// The page has 0.2 s from the write of the safety layer. A busy host may delay one trip.
TEST_F(LivePage, ShowsATripWithinAFifthOfASecond) {
  const auto now_ms = [] {
    return std::chrono::duration_cast<std::chrono::milliseconds>(
               std::chrono::system_clock::now().time_since_epoch())
        .count();
  };
  long long least = 1'000'000;
  std::string answers;
  for (int attempt = 0; attempt < 3 && least > 200; ++attempt) {
    Laboratory laboratory{unique_ring("tripped")};
    const PageServer server{settings_for(unique_ring("tripped"))};
    Browser browser{server, "['trip']"};
    for (int i = 0; i < 3000 && server.viewers() == 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
    std::this_thread::sleep_for(std::chrono::seconds{3});
    const auto tripped = now_ms();
    laboratory.trip();
    answers = browser.answers();
    constexpr const char* kAt = "tripped at: ";
    const auto at = answers.find(kAt);
    ASSERT_NE(at, std::string::npos) << answers;
    least = std::min(least, std::stoll(answers.substr(at + std::string{kAt}.size())) - tripped);
  }

  EXPECT_LE(least, 200) << answers;
  RecordProperty("milliseconds", std::to_string(least));
  EXPECT_EQ(missing(answers, {"ready: true",
                              "cause: Safety layer of srmd tripped: long: velocity of the command "
                              "is 2.1 m/s, expected at most 1.8 m/s",
                              "listed: true", "errors: none"}),
            "")
      << answers;
}

TEST_F(LivePage, GoesOnWithAnotherRing) {
  std::optional<Laboratory> laboratory{std::in_place, unique_ring("next")};
  const PageServer server{settings_for(unique_ring("next"))};
  Browser browser{server, "['restart']"};
  for (int i = 0; i < 3000 && server.viewers() == 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{10});
  std::this_thread::sleep_for(std::chrono::seconds{2});

  laboratory.reset();
  std::this_thread::sleep_for(std::chrono::seconds{2});
  laboratory.emplace(unique_ring("next"), 5);

  const std::string answers = browser.answers();
  EXPECT_EQ(missing(answers, {"ended: ended", "another: true", "its words: 1", "moves: true",
                              "keeps no figure of the first: true", "errors: none"}),
            "")
      << answers;
}

}  // namespace
}  // namespace rths::monitor
