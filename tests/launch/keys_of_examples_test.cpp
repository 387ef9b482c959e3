// SPDX-License-Identifier: Apache-2.0
//
// No key of an example is ignored: each one changes a recorded signal or a number of the report
// when it changes, or the experiment is refused. What `rths check` accepts, `rths run` accepts.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <rths/core/config.hpp>

#include "experiment_keys.hpp"
#include "fmi/test_fmu.hpp"
#include "short_run.hpp"
#include "support/files.hpp"
#include "support/long_run.hpp"
#include "support/opensees.hpp"
#include "support/process.hpp"

namespace rths::launch {
namespace {

/// Keys whose change leaves a short healthy test in virtual time as it was, and why.
struct Exception {
  const char* keys;  ///< regular expression of the dotted key
  const char* why;
};
constexpr Exception kExceptions[] = {
    {"name|motion\\.name", "labels of the results"},
    {".*\\.port", "the program has to connect to it"},
    {"model\\.(fitted|bounds.*|machine.*)", "the diagnosis reads it, not the test"},
    {"held_out\\.name", "the page of the diagnosis shows it"},
    {"solver\\.model_computing_time", "virtual time always has the modelled computing time"},
    {"(.*\\.)?(wait_deadline_s|connect_deadline_s|answer_deadline_s|deadline_s|silence_s)",
     "a deadline that a healthy test never reaches"},
    {"stop\\..*", "the machine is at rest at the end of a short test"},
    {"node\\.[a-z]+\\.safety\\..*", "a limit that a healthy test never reaches"},
    {"network\\..*|host\\..*|node\\.[a-z]+\\.host", "one process runs all nodes in virtual time"},
    {"node\\.opf\\.processes", "processors change how fast a script computes, not what"},
    {"targets\\.to_Hz", "above the frequencies of a short test"},
};

std::optional<std::string> exception_of(const std::string& key) {
  for (const auto& exception : kExceptions)
    if (std::regex_match(key, std::regex{exception.keys})) return exception.why;
  return std::nullopt;
}

std::vector<std::filesystem::path> examples() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator{test::source_tree() / "examples"}) {
    if (entry.path().extension() != ".toml") continue;
    const Config config = Config::load(entry.path());
    if (config.is_table("node") && config.has("format")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// What an example needs to run in virtual time on this computer.
struct Preparation {
  std::vector<Set> sets;
  std::string fixed = "";  ///< regular expression of the keys that these sets replace
};

bool has_adapter(const Config& example, const std::string& adapter) {
  const Config nodes = example.table("node");
  const auto names = nodes.keys();
  return std::any_of(names.begin(), names.end(), [&](const auto& name) {
    return nodes.table(name).text("adapter") == adapter;
  });
}

/// Examples as they run in virtual time, without programs that are not at hand.
class Example : public ::testing::TestWithParam<std::filesystem::path> {
 protected:
  void SetUp() override {
    config_ = Config::load(GetParam());
    if (has_adapter(config_, "opensees") && !test::opensees_python())
      GTEST_SKIP() << "SKIPPED: OpenSees is not installed";
    if (config_.table("node").table_or_empty("opf").has("processes") && !test::has_mpich())
      GTEST_SKIP() << test::kWithoutMpich;
    if (has_adapter(config_, "fmu")) use_built_fmu();
    if (has_adapter(config_, "external")) replace_program();
    if (has_adapter(config_, "opensees")) use_opensees();
    for (const auto& [key, value] : preparation_.sets) config_.set(key, value);
  }

  /// @param key  the companion that it changes runs too
  [[nodiscard]] std::vector<Set> sets_for(const std::string& key) const {
    std::vector<Set> sets = preparation_.sets;
    const bool is_imposed = config_.has("targets");
    if (!is_imposed || config_.table("targets").text("kind") == "response")
      sets.push_back({"duration_s", "2.0"});
    if (config_.has("rest_s")) sets.push_back({"rest_s", "0.2"});
    for (const char* companion : {"held_out", "uncompensated"})
      if (config_.has(companion) && !key.starts_with(companion)) sets.push_back({companion, "{}"});
    return sets;
  }

  const ShortRun& unchanged(const std::string& key) {
    const auto sets = sets_for(key);
    std::string name;
    for (const auto& set : sets) name += set.key + " ";
    auto& run = unchanged_[name];
    if (!run) run = std::make_unique<ShortRun>(GetParam(), sets);
    return *run;
  }

  /// The keys of this run: all of them, or every 41st.
  [[nodiscard]] std::vector<Key> tried_keys() const {
    const std::size_t stride = test::is_long() ? 1 : 41;
    // Another place in each example, so that the sample has all kinds of tables.
    const auto all = examples();
    auto place =
        static_cast<std::size_t>(std::find(all.begin(), all.end(), GetParam()) - all.begin());
    std::vector<Key> tried;
    place *= 7;
    for (const auto& key : keys_of(config_)) {
      if (exception_of(key.name) || std::regex_match(key.name, std::regex{preparation_.fixed}))
        continue;
      if (place++ % stride == 0) tried.push_back(key);
    }
    return tried;
  }

 private:
  void use_built_fmu() {
    const auto description =
        test::content_of(test::source_tree() / "examples/fmu/modelDescription.xml");
    const auto fmu = test::write_fmu(folder_, description, test::lag_library(3, "machine"), 3);
    preparation_ = {{{"node.srmd.file", "\"" + fmu.string() + "\""}}, "node\\.srmd\\.file"};
  }
  // A program of the user's own runs in real time only. The solver here needs the map of the SRMD.
  void replace_program() {
    preparation_ = {{{"node.opf", R"({adapter = "numerical"})"}, {"map", "srmd"}},
                    "map|node\\.opf\\..*"};
  }
  // Examples run at the same time, each with a port of its own.
  void use_opensees() {
    const Config node = config_.table("node").table("opf");
    const auto port = fmt::format("{}", test::free_port());
    auto elements = node.tables("element");
    for (auto& element : elements) element.set("port", port);
    std::string arguments;
    for (const auto& argument : node.texts("arguments"))
      arguments += fmt::format("\"{}\", ", argument);
    preparation_.sets = {{"node.opf.element", list_of_tables(elements)},
                         {"node.opf.python", "\"" + *test::opensees_python() + "\""},
                         {"node.opf.arguments", "[" + arguments + "\"--port\", \"" + port + "\"]"}};
  }

  test::TemporaryFolder folder_;
  Config config_;
  Preparation preparation_;
  std::map<std::string, std::unique_ptr<ShortRun>> unchanged_;
};

TEST_P(Example, HasNoKeyThatIsIgnored) {
  for (const auto& key : tried_keys()) {
    const ShortRun& usual = unchanged(key.name);
    ASSERT_TRUE(usual.has_run() && usual.finished().exit_code <= 1) << usual.finished().err;
    for (const auto& change : key.changes) {
      auto sets = sets_for(key.name);
      sets.push_back(change);
      const ShortRun changed{GetParam(), sets};
      if (changed.has_run()) {
        const bool is_remarked = changed.finished().err.find(key.name) != std::string::npos;
        EXPECT_FALSE(changed.has_same_results(usual) && !is_remarked)
            << key.name << " is ignored: " << change.key << "=" << change.value;
        break;
      }
      // Another value may be accepted.
      EXPECT_FALSE(changed.is_accepted_by_check())
          << change.key << "=" << change.value
          << " is accepted by check and refused by run: " << changed.finished().err;
    }
  }
}

std::string name_of(const ::testing::TestParamInfo<std::filesystem::path>& info) {
  auto name = std::filesystem::relative(info.param, test::source_tree() / "examples")
                  .replace_extension()
                  .string();
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Keys, Example, ::testing::ValuesIn(examples()), name_of);

}  // namespace
}  // namespace rths::launch
