// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths_adapter.h>

#include <algorithm>
#include <cstdio>
#include <regex>

#include <rths/plugin/conformance.hpp>
#include <rths/plugin/library.hpp>
#include <rths/plugin/plugin_adapter.hpp>

#include "support/bench.hpp"
#include "support/files.hpp"
#include "support/process.hpp"

extern "C" std::size_t size_of_adapter_in_c(void);

namespace rths::plugin {
namespace {

std::filesystem::path broken(const std::string& name) {
  return test::build_tree() / "broken" / (name + ".so");
}

TEST(AdapterAbi, IsTheSameInCAndCpp) { EXPECT_EQ(size_of_adapter_in_c(), sizeof(rths_adapter)); }

TEST(AdapterAbi, LoadsAnEarlierMinorWithoutItsLaterMembers) {
  const Library library{broken("earlier_minor")};

  EXPECT_EQ(library.adapter().abi & 0xFFFF, 0U);
  EXPECT_EQ(library.stop(), nullptr);
  EXPECT_EQ(library.message(), nullptr);
}

TEST(AdapterAbi, RunsAnAdapterBuiltAgainstThePreviousHeader) {
  PluginSettings settings;
  settings.library = broken("abi_1_0");
  const auto adapter = make_plugin(settings);
  adapter->activate();
  test::Bench bench{*adapter};
  bench.in("xpc.long.displ.ref") = 0.02;

  EXPECT_EQ(bench.step(0), Status::Ok);
  EXPECT_EQ(bench.out("srmd.long.displ.fbk"), 0.01);
  // It has no `stop`, so the host ramps its output.
  Status status = bench.step(0.001, true);
  EXPECT_GT(bench.out("srmd.long.displ.fbk"), 0);
  for (int i = 2; i < 1500 && status == Status::Ok; ++i) status = bench.step(0.001 * i, true);
  EXPECT_EQ(status, Status::Done);
  EXPECT_EQ(bench.out("srmd.long.displ.fbk"), 0);
}

TEST(AdapterAbi, KeepsAllRulesForAnAdapterBuiltAgainstThePreviousHeader) {
  const auto findings = check_plugin(broken("abi_1_0"), {});

  for (const auto& finding : findings)
    EXPECT_NE(finding.outcome, Finding::Outcome::Fail) << finding.rule << ": " << finding.text;
  const auto abi = std::find_if(findings.begin(), findings.end(),
                                [](const auto& finding) { return finding.rule == "abi"; });
  ASSERT_NE(abi, findings.end());
  EXPECT_NE(abi->text.find("adapter ABI 1.0"), std::string::npos) << abi->text;
}

/// Result of a compiler on one file, with all warnings as errors.
void expect_compiles(const std::string& compiler, const std::string& standard,
                     const std::filesystem::path& file) {
  const auto include = [](const char* folder) {
    return "-I" + (test::source_tree() / folder / "include").string();
  };
  test::Running running{{"/usr/bin/env", compiler, "-std=" + standard, "-fsyntax-only", "-Wall",
                         "-Wextra", "-Wpedantic", "-Wshadow", "-Werror", include("adapters/plugin"),
                         include("foreign"), file.string()}};
  const auto result = running.wait();
  constexpr int kNoCommand = 127;
  if (result.exit_code == kNoCommand) {
    std::printf("SKIPPED: %s is not installed\n", compiler.c_str());
    return;
  }
  EXPECT_EQ(result.exit_code, 0) << compiler << " " << file << ": " << result.err;
}

TEST(AdapterAbi, HeadersAndTemplatesCompileInBothLanguagesWithBothCompilers) {
  const test::TemporaryFolder folder;
  const std::string text =
      "#include <rths_adapter.h>\n#include <rths/fmi/fmi2.h>\n#include "
      "<rths/fmi/fmi3.h>\nint main(void) { return 0; }\n";
  const auto templates = test::source_tree() / "adapters/plugin/templates/adapter";
  const std::vector<std::filesystem::path> in_c{
      folder.write("header.c", text), templates / "machine.c", templates / "controller.c"};
  const std::vector<std::filesystem::path> in_cpp{
      folder.write("header.cpp", text), templates / "machine.cpp", templates / "controller.cpp"};

  for (const char* compiler : {"gcc", "clang-14"})
    for (const auto& file : in_c) expect_compiles(compiler, "c11", file);
  for (const char* compiler : {"g++", "clang++-14"})
    for (const auto& file : in_cpp) expect_compiles(compiler, "c++20", file);
}

// A controller has as many signals as a machine, and the flags of the exchange with the solver.
TEST(AdapterTemplates, AreShort) {
  const std::regex comments{R"(//[^\n]*|#[^i\n][^\n]*|/\*[\s\S]*?\*/|"""[\s\S]*?""")"};
  const std::regex lines_of_code{"[^\n]*[^ \n][^\n]*"};
  for (const char* ending : {"c", "cpp", "py"})
    for (const auto& [role, most] : {std::pair{"machine", 40}, std::pair{"controller", 48}}) {
      const auto name = std::string{role} + "." + ending;
      const auto code = std::regex_replace(
          test::content_of(test::source_tree() / "adapters/plugin/templates/adapter" / name),
          comments, "");
      const auto count = std::distance(
          std::sregex_iterator{code.begin(), code.end(), lines_of_code}, std::sregex_iterator{});
      EXPECT_GT(count, 20) << name;
      EXPECT_LE(count, most) << name;
    }
}

TEST(AdapterAbi, LoadsALaterMinor) { EXPECT_NE(Library{broken("later_minor")}.stop(), nullptr); }

TEST(AdapterAbi, RefusesAnotherMajor) {
  EXPECT_EQ(test::error_of([] { Library{broken("wrong_major")}; }),
            broken("wrong_major").string() +
                ": has adapter ABI 2.0, expected 1.x: build it against this version's "
                "rths_adapter.h");
}

TEST(AdapterAbi, RefusesAFileThatIsNoLibrary) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("text.so", "not a library");

  EXPECT_NE(test::error_of([&] { Library{file}; }).find("cannot load the plugin"),
            std::string::npos);
}

}  // namespace
}  // namespace rths::plugin
