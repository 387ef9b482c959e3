// SPDX-License-Identifier: Apache-2.0
//
// Programs and experiments of strangers, where present: ../shared/data/strangers.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths::launch {
namespace {

namespace fs = std::filesystem;

class Strangers : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(data_)) GTEST_SKIP() << "SKIPPED: there is no ../shared/data/strangers";
  }
  /// Compiles a program for GT cards.
  void compile(const std::string& source, const std::string& program) const {
    const auto library = test::build_tree() / "broker/scramnet";
    const auto compiled = test::Running{
        {"/usr/bin/cc", source,
         "-I" + (test::source_tree() / "broker/scramnet/include/scramnet").string(),
         "-L" + library.string(), "-Wl,-rpath," + library.string(), "-lscgtapi", "-o",
         program}}.wait();
    ASSERT_EQ(compiled.exit_code, 0) << compiled.err;
  }
  /// Runs an experiment whose solver is a program.
  [[nodiscard]] test::Finished run(const std::string& experiment, const std::string& program) {
    return test::run_rths({"run", (data_ / experiment).string(), "--out", out().string(), "--ring",
                           ring_, "--set", "node.opf.command=[\"" + program + "\"]"});
  }
  [[nodiscard]] fs::path out() const { return folder_.path() / "out"; }
  [[nodiscard]] nlohmann::json report() const {
    return nlohmann::json::parse(test::content_of(out() / "report.json"));
  }

  fs::path data_ = test::source_tree() / "../shared/data/strangers";
  test::TemporaryFolder folder_;
  std::string ring_ = test::unique_ring("strangers");
  test::RingRemoval removal_{ring_};
};

TEST_F(Strangers, ThatStoreIntoTheWordOfTheControllerAreNamed) {
  const std::string thief = (folder_.path() / "thief").string();
  ASSERT_NO_FATAL_FAILURE(compile((data_ / "ownership/thief.c").string(), thief));

  const auto finished = run("ownership/t.toml", thief);

  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  ASSERT_TRUE(test::breaks(report(), "owner")) << report()["broken"];
  for (const auto& broken : report()["broken"])
    if (broken["condition"] == "owner") {
      EXPECT_EQ(broken["signal"], "daq.force.fbk");
      EXPECT_NE(std::string{broken["found"]}.find(" by opf (process "), std::string::npos);
      EXPECT_EQ(broken["expected"], "stores by its owner xpc alone");
    }
}

TEST_F(Strangers, ThatRaiseTheirFirstFlagAndHangDoNotReachTheEnd) {
  const std::string idle = (folder_.path() / "idle").string();
  ASSERT_NO_FATAL_FAILURE(compile((data_ / "end/idle.c").string(), idle));

  const auto finished = run("end/e.toml", idle);

  EXPECT_EQ(finished.exit_code, 1) << finished.out << finished.err;
  EXPECT_TRUE(test::breaks(report(), "end")) << report()["broken"];
}

}  // namespace
}  // namespace rths::launch
