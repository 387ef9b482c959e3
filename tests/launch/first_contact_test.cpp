// SPDX-License-Identifier: Apache-2.0
//
// The shell's completion, the manual page, and answers to a misspelt command.
#include <algorithm>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/broker/ring.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths {
namespace {

using test::run_rths;
using Lines = std::multiset<std::string>;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream{text};
  for (std::string line; std::getline(stream, line);)
    if (!line.empty()) lines.insert(line);
  return lines;
}

Lines completed(std::vector<std::string> words) {
  words.insert(words.begin(), "complete");
  return lines_of(run_rths(words).out);
}

TEST(FirstContact, NamesTheCommandsWhenOneIsMisspelt) {
  const auto misspelt = run_rths({"daignose", "x"});
  EXPECT_EQ(misspelt.exit_code, 3);
  EXPECT_NE(misspelt.err.find("there is no command 'daignose' (did you mean 'diagnose'?)"),
            std::string::npos)
      << misspelt.err;
  EXPECT_NE(misspelt.err.find("run, check, "), std::string::npos);
  EXPECT_NE(run_rths({"map", "lst"}).err.find("did you mean 'list'?"), std::string::npos);
}

TEST(FirstContact, CompletesCommandsOptionsAndValues) {
  EXPECT_EQ(completed({"ru"}), Lines{"run"});
  EXPECT_EQ(completed({"map", ""}), (Lines{"list", "check", "gen"}));
  EXPECT_EQ(completed({"run", "x.toml", "--cl"}), Lines{"--clock"});
  EXPECT_EQ(completed({"run", "--clock", ""}), (Lines{"wall", "virtual"}));
  EXPECT_EQ(completed({"run", "--clock", "virtual", "--no"}), Lines{"--no-diagnosis"});
  EXPECT_EQ(completed({"loop", ""}), (Lines{"eqsb", "lprb", "tpfb"}));
  EXPECT_EQ(completed({"map", "check", "sr"}), Lines{"srmd"});
  EXPECT_EQ(completed({"run", "exa"}), Lines{}) << "files are for the shell";
  EXPECT_EQ(completed({"node", "--r"}), (Lines{"--recording", "--ring"}));
  EXPECT_EQ(completed({"no"}), Lines{}) << "hidden";
}

TEST(FirstContact, CompletesTheNamesOfRings) {
  const std::string name = test::unique_ring("completion");
  const test::RingRemoval removal{name};
  const auto ring = broker::Ring::create(name, test::small_map());

  EXPECT_EQ(completed({"who", name.substr(0, name.size() - 1)}).count(name), 1U);
}

TEST(FirstContact, HasAManualPageOfAllCommandsInTheHelp) {
  const std::string page = run_rths({"manual"}).out;
  EXPECT_EQ(page.rfind(".TH RTHS 1", 0), 0U);
  for (const char* command :
       {"run", "check", "dump", "export", "who", "watch", "send", "bench ring", "loop", "terms",
        "diagnose", "map list", "report", "doctor", "clean"})
    EXPECT_NE(page.find(std::string{".SS rths "} + command), std::string::npos) << command;
  EXPECT_EQ(page.find(".SS rths node"), std::string::npos) << "is for the launcher";
  EXPECT_NE(page.find("\\-\\-clock wall|virtual"), std::string::npos);
}

TEST(FirstContact, ListsTheBuiltInMaps) {
  const std::string list = run_rths({"map", "list"}).out;
  for (const char* map : {"srmd ", "sts ", "mts469d_gt "})
    EXPECT_NE(list.find(map), std::string::npos) << list;
}

TEST(FirstContact, PrintsTermsAndWritersAsJson) {
  const auto term =
      nlohmann::json::parse(run_rths({"terms", "lead_heating", "--format", "json"}).out);
  EXPECT_EQ(term["term"], "lead_heating");
  EXPECT_EQ(term["parameters"][1]["key"], "lead_radius_m");

  const std::string name = test::unique_ring("writers");
  const test::RingRemoval removal{name};
  broker::Ring ring = broker::Ring::create(name, test::small_map());
  broker::Node node = ring.join("controller", ring.map().hash());
  ASSERT_EQ(node.write(test::kControllerWord, 7), Status::Ok);
  const auto who = run_rths({"who", name, "--format", "json"});
  const auto first = nlohmann::json::parse(who.out.substr(0, who.out.find('\n')));
  EXPECT_EQ(first["node"], "controller") << who.out << who.err;
  EXPECT_TRUE(first["written"]);
}

}  // namespace
}  // namespace rths
