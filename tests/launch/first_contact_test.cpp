// SPDX-License-Identifier: Apache-2.0
//
// The shell's completion, the manual page, and answers to a misspelt command.
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
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

TEST(FirstContact, FailsIfItsOutputIsLost) {
  const auto run =
      test::Running{{"/bin/bash", "-c", test::rths_command() + " --version >/dev/full"}}.wait(60);

  EXPECT_EQ(run.exit_code, 2);
  EXPECT_EQ(run.err, "rths: standard output cannot be written: No space left on device\n");
}

TEST(FirstContact, FailsInOrderIfItsMessagesAreLost) {
  for (const char* streams : {"2>/dev/full", "2>&-", ">&- 2>&-", ">/dev/full 2>/dev/full"})
    for (const char* command : {" diagnose nowhere ", " bogus "}) {
      const auto run =
          test::Running{{"/bin/bash", "-c", test::rths_command() + command + streams}}.wait(60);
      EXPECT_EQ(run.exit_code, command == std::string{" bogus "} ? 3 : 2) << command << streams;
    }
}

TEST(FirstContact, CompletesCommandsOptionsAndValues) {
  EXPECT_EQ(completed({"ru"}), Lines{"run"});
  EXPECT_EQ(completed({"map", ""}), (Lines{"list", "check", "gen"}));
  EXPECT_EQ(completed({"run", "x.toml", "--cl"}), Lines{"--clock"});
  EXPECT_EQ(completed({"run", "--clock", ""}), (Lines{"wall", "virtual", "auto"}));
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
  for (const char* command : {"run", "check", "dump", "export", "who", "watch", "send", "bench",
                              "loop", "terms", "diagnose", "map list", "report", "doctor", "clean"})
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

TEST(FirstContact, ListsRingsAsJson) {
  const std::string name = test::unique_ring("doctor");
  const test::RingRemoval removal{name};
  broker::Ring ring = broker::Ring::create(name, test::small_map());
  const broker::Node node = ring.join("machine", 0);
  bool found = false;
  for (const auto& line : lines_of(run_rths({"doctor", "--format", "json"}).out)) {
    const auto json = nlohmann::json::parse(line);
    if (json.value("ring", "") != name) continue;
    found = true;
    EXPECT_EQ(json["map"], "small");
    EXPECT_TRUE(json["in_use"]);
    const auto& processes = json["processes"];
    EXPECT_TRUE(std::any_of(processes.begin(), processes.end(), [](const auto& process) {
      return process["node"] == "machine" && process["pid"] == getpid() && process["alive"] == true;
    })) << line;
  }
  EXPECT_TRUE(found);
}

/// Output of a command on a terminal.
std::string on_terminal(const std::vector<std::string>& arguments) {
  int master = -1;
  const pid_t child = forkpty(&master, nullptr, nullptr, nullptr);
  if (child == 0) {
    std::vector<char*> words{const_cast<char*>("rths")};
    for (const auto& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    execv(test::rths_command().c_str(), words.data());
    _exit(127);
  }
  std::string output;
  std::array<char, 4096> bytes{};
  for (ssize_t got = 0; (got = read(master, bytes.data(), bytes.size())) > 0;)
    output.append(bytes.data(), static_cast<std::size_t>(got));
  close(master);
  waitpid(child, nullptr, 0);
  return output;
}

TEST(FirstContact, ShowsTheStepsOfADiagnosisOnATerminal) {
  const test::TemporaryFolder out;
  const std::string shown =
      on_terminal({"diagnose", (test::source_tree() / "examples/diagnosis/actuator").string(),
                   "--out", out.path().string()});
  EXPECT_NE(shown.find("step 1 of 2: the diagnosis, 0 s"), std::string::npos) << shown;
  const auto last = shown.rfind("step ");
  const auto cleared = shown.find("\r\033[K", last);
  EXPECT_NE(cleared, std::string::npos) << "the line stays";
  EXPECT_LT(cleared, shown.find("report    ")) << shown;
}

}  // namespace
}  // namespace rths
