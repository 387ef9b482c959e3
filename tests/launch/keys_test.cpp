// SPDX-License-Identifier: Apache-2.0
//
// No key of an accepted experiment is ignored: each one changes a recorded signal or a number of
// the report when it changes, or the experiment is refused.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <regex>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <fmt/format.h>
#include <rths/app/builtin_adapters.hpp>
#include <rths/core/config.hpp>
#include <rths/recording/recording.hpp>

#include "support/files.hpp"
#include "support/json.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"

namespace rths::launch {
namespace {

using Json = nlohmann::json;

/// Keys whose change leaves a short healthy test in virtual time as it was, and why.
struct Exception {
  const char* keys;  ///< regular expression of the dotted key
  const char* why;
};
constexpr Exception kExceptions[] = {
    {"model\\.(fitted|bounds.*|machine.*)", "the diagnosis reads it, not the test"},
    {"held_out\\.name", "the page of the diagnosis shows it"},
    {"solver\\.model_computing_time", "virtual time always has the modelled computing time"},
    {"(.*\\.)?(wait_deadline_s|connect_deadline_s|answer_deadline_s|deadline_s|silence_s)",
     "a deadline that a healthy test never reaches"},
    {"stop\\..*", "the machine is at rest at the end of a short test"},
    {"node\\.[a-z]+\\.safety\\..*", "a limit that a healthy test never reaches"},
    {"network\\..*|host\\..*", "one process runs all nodes in virtual time"},
    {"targets\\.to_Hz", "above the frequencies of a short test"},
    {"plant\\.stick|node\\.opf\\.element", "a list of tables, which --set replaces as a whole"},
};

/// Experiments that cannot run in virtual time, or need OpenSees.
bool runs_virtually(const std::string& file) {
  return file.find("foreign") == std::string::npos && file.find("fmu") == std::string::npos &&
         file.find("opensees") == std::string::npos && file.find("hosts") == std::string::npos;
}

std::optional<std::string> exception_of(const std::string& key) {
  for (const auto& exception : kExceptions)
    if (std::regex_match(key, std::regex{exception.keys})) return exception.why;
  return std::nullopt;
}

std::string list_of(const std::vector<double>& values, double factor, double increment) {
  std::string text;
  for (const double value : values)
    text += fmt::format("{}{}", text.empty() ? "" : ", ", value == 0 ? increment : factor * value);
  return "[" + text + "]";
}

/// Other values of a key, as TOML: the first one that the experiment accepts is tried.
std::vector<std::string> changes_of(const Config& table, const std::string& key) {
  if (key == "duration_s") return {"2.5"};  // of a short run
  if (key == "rest_s") return {"0.3"};
  try {
    return {table.flag(key, false) ? "false" : "true"};
  } catch (const Error&) {
  }
  try {
    const auto whole = table.integer(key);
    return {fmt::format("{}", whole + 1), fmt::format("{}", whole - 1)};
  } catch (const Error&) {
  }
  try {
    const double number = table.number(key);
    if (number == 0) return {"0.01", "1.0"};
    return {fmt::format("{}", 1.1 * number), fmt::format("{}", 0.9 * number)};
  } catch (const Error&) {
  }
  try {
    const auto numbers = table.numbers(key);
    return {list_of(numbers, 1.1, 0.01), list_of(numbers, 0.9, 0.01)};
  } catch (const Error&) {
  }
  try {
    return {fmt::format("\"{}_\"", table.text(key))};
  } catch (const Error&) {
  }
  return {"[\"long\"]"};
}

/// A key of an experiment and other values for it.
struct Key {
  std::string name;
  std::vector<std::string> changes;
};

void add_keys(const Config& table, const std::string& prefix, std::vector<Key>& keys) {
  for (const auto& key : table.keys())
    if (table.is_table(key))
      add_keys(table.table(key), prefix + key + ".", keys);
    else
      keys.push_back({prefix + key, changes_of(table, key)});
}

std::vector<std::filesystem::path> examples() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator{test::source_tree() / "examples"}) {
    const auto& file = entry.path();
    if (file.extension() != ".toml" || !runs_virtually(file.string())) continue;
    const Config config = Config::load(file);
    if (config.is_table("node") && config.has("format")) files.push_back(file);
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// A short run of an example, in a folder of its own.
class ShortRun {
 public:
  ShortRun(const std::filesystem::path& example, const std::string& key,
           const std::string& change) {
    std::vector<std::string> command{"run",
                                     example.string(),
                                     "--clock",
                                     "virtual",
                                     "--no-diagnosis",
                                     "--out",
                                     (folder_.path() / "run").string()};
    const auto set = [&](const std::string& name, const std::string& value) {
      command.insert(command.end(), {"--set", name + "=" + value});
    };
    const Config config = Config::load(example);
    const bool is_imposed = config.has("targets");
    if (!is_imposed || config.table("targets").text("kind") == "response") set("duration_s", "2.0");
    if (config.has("rest_s")) set("rest_s", "0.2");
    for (const char* companion : {"held_out", "uncompensated"})
      if (config.has(companion) && !key.starts_with(companion)) set(companion, "{}");
    if (!change.empty()) set(key, change);
    finished_ = test::run_rths(command, 300);
  }
  // A test of two seconds is often not conclusive.
  [[nodiscard]] bool has_run() const {
    return std::filesystem::exists(folder_.path() / "run" / "run.h5");
  }
  [[nodiscard]] const test::Finished& finished() const { return finished_; }
  [[nodiscard]] bool has_same_results(const ShortRun& other) const {
    for (const char* file : {"run.h5", "held_out.h5", "uncompensated.h5", "numerical.h5"})
      if (!has_same_signals(other, file)) return false;
    return numbers() == other.numbers();
  }

 private:
  [[nodiscard]] std::filesystem::path at(const char* file) const {
    return folder_.path() / "run" / file;
  }
  [[nodiscard]] bool has_same_signals(const ShortRun& other, const char* file) const {
    if (!std::filesystem::exists(at(file))) return !std::filesystem::exists(other.at(file));
    if (!std::filesystem::exists(other.at(file))) return false;
    return recording::hold_same_signals(recording::Reader{at(file)},
                                        recording::Reader{other.at(file)});
  }
  // The command repeats every change, and the rest is about the program.
  [[nodiscard]] Json numbers() const {
    if (!std::filesystem::exists(at("report.json"))) return {};
    Json json = test::json_of(at("report.json"));
    json.erase("command");
    json.erase("meta");
    return json;
  }

  test::TemporaryFolder folder_;
  test::Finished finished_;
};

/// The same example, unchanged: with or without its companions.
class Unchanged {
 public:
  const ShortRun& of(const std::filesystem::path& example, const std::string& key) {
    const std::string companion = key.starts_with("held_out.")        ? "held_out"
                                  : key.starts_with("uncompensated.") ? "uncompensated"
                                                                      : "";
    const auto name = example.string() + companion;
    const auto known = runs_.find(name);
    if (known != runs_.end()) return *known->second;
    return *runs_.emplace(name, std::make_unique<ShortRun>(example, key, "")).first->second;
  }

 private:
  std::map<std::string, std::unique_ptr<ShortRun>> runs_;
};

TEST(Keys, OfEveryExampleChangeAResultOrAreRefused) {
  Unchanged unchanged;
  std::vector<std::string> ignored, unfinished;
  // Every key in a long run; otherwise a sample that takes all kinds of tables.
  const std::size_t stride = test::is_long() ? 1 : 47;
  std::size_t index = 0;
  for (const auto& example : examples()) {
    std::vector<Key> keys;
    add_keys(Config::load(example), "", keys);
    for (const auto& key : keys) {
      if (exception_of(key.name) || index++ % stride != 0) continue;
      const ShortRun& usual = unchanged.of(example, key.name);
      if (!usual.has_run()) {
        unfinished.push_back(example.string() + ": " + usual.finished().err);
        break;
      }
      for (const auto& change : key.changes) {
        const ShortRun changed{example, key.name, change};
        if (!changed.has_run()) continue;  // refused; another value may be accepted
        if (changed.has_same_results(usual))
          ignored.push_back(
              fmt::format("{}: {} = {}", example.filename().string(), key.name, change));
        break;
      }
    }
  }
  EXPECT_EQ(ignored, std::vector<std::string>{});
  EXPECT_EQ(unfinished, std::vector<std::string>{});
}

/// A key that is added to an example, and a part of the message that refuses it.
struct Refused {
  const char* example;
  std::vector<std::string> sets;
  const char* message;
};

TEST(Keys, ThatNoNodeUsesAreRefusedByNameBeforeTheStart) {
  const Refused cases[] = {
      {"srmd_platen_2d", {"machine.gain.factor=1.1"}, "machine.gain has no effect"},
      {"srmd_platen_2d", {"machine.actuator_delay.delay_s=0.01"}, "machine.actuator_delay has no"},
      {"srmd_platen_2d",
       {"machine.coulomb_friction.friction_force_N=[1.0,1.0]"},
       "machine.coulomb_friction has no effect"},
      {"srmd_platen_2d", {"machine.force_noise_N=1e5"}, "machine.force_noise_N has no effect"},
      {"srmd_platen_2d", {"machine.position_gain_per_s=[10,10]"}, "machine.position_gain_per_s"},
      {"srmd_eqsb_3d", {"solver.overrun_s=0.1"}, "solver.overrun_s has no effect"},
      {"srmd_eqsb_2d", {"plant.vertical_frequency_Hz=5"}, "plant.vertical_frequency_Hz has no"},
      {"srmd_eqsb_2d", {"network.domain=3"}, "network.domain has no effect"},
      {"opensees/one_bay_frame", {"machine.force_noise_N=1e5"}, "machine.force_noise_N has no"},
      {"opensees/one_bay_frame", {"solver.alpha=-0.1"}, "solver.alpha has no effect"},
      {"opensees/one_bay_frame", {"solver.substeps=2"}, "solver.substeps has no effect"},
  };
  for (const auto& one : cases) {
    const auto file = test::source_tree() / "examples" / (std::string{one.example} + ".toml");
    Overrides changes;
    for (const auto& set : one.sets)
      changes.emplace_back(set.substr(0, set.find('=')), set.substr(set.find('=') + 1));
    const auto error =
        test::error_of([&] { static_cast<void>(app::load_experiment(file, changes)); });
    EXPECT_NE(error.find(one.message), std::string::npos) << one.sets[0] << ": " << error;
    EXPECT_TRUE(error.starts_with("--set")) << error;
  }
}

// A machine of the user's own has no parameters here, but the diagnosis has a model of it.
TEST(Keys, OfAMachineOfTheUsersOwnAreSaidToChangeTheModelOnly) {
  const auto experiment = app::load_experiment(test::source_tree() / "examples/srmd_lprb_2d.toml",
                                               {{"node.srmd.adapter", "external"}});
  ASSERT_EQ(experiment.remarks.size(), 1U);
  EXPECT_NE(experiment.remarks[0].find("only the model in the diagnosis"), std::string::npos);
}

TEST(Keys, OfTheEarthquakeAreSaidToHaveNoEffectOnCommandedDisplacements) {
  const auto experiment = app::load_experiment(test::source_tree() / "examples/srmd_platen_2d.toml",
                                               {{"targets.kind", "response"}});
  ASSERT_EQ(experiment.remarks.size(), 1U);
  EXPECT_NE(experiment.remarks[0].find("held_out"), std::string::npos);
  EXPECT_EQ(experiment.remarks[0].find("motion"), std::string::npos);
}

}  // namespace
}  // namespace rths::launch
