// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <fstream>
#include <vector>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/config.hpp>
#include <rths/core/message.hpp>
#include <rths/testkit/test_file.hpp>

#include "command.hpp"

namespace rths::app {
namespace {

struct TestArguments {
  std::string file, kept = "out/failed_tests";
};

constexpr std::size_t kShownLines = 12;  // of each log

volatile std::sig_atomic_t is_interrupted = 0;

void print_log(const std::filesystem::path& file) {
  std::ifstream in{file};
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) {
    if (lines.size() == kShownLines) lines.erase(lines.begin());
    lines.push_back(line);
  }
  if (lines.empty()) return;
  write_message(fmt::format("--- the last lines of {}\n", file.filename().string()));
  for (const auto& line : lines) write_message(fmt::format("    {}\n", line));
}

/// Logs of a test; removed unless it failed.
class Folder {
 public:
  Folder(const std::string& kept, const std::string& name)
      : path_{testkit::make_test_folder(kept, name)} {}
  ~Folder() {
    if (!is_kept_) testkit::remove_test_folder(path_);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  void keep() { is_kept_ = true; }

 private:
  std::filesystem::path path_;
  bool is_kept_ = false;
};

int test(const TestArguments& arguments) {
  const auto test = testkit::read_test(Config::load(arguments.file));
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    std::signal(signal, [](int) { is_interrupted = 1; });
  Folder folder{std::filesystem::absolute(arguments.kept), test.name};
  const WallClock clock;
  const TimePoint begun = clock.now();
  const auto result =
      testkit::run_test(test, folder.path(), std::filesystem::read_symlink("/proc/self/exe"),
                        [] { return is_interrupted != 0; });
  if (result.failure.empty()) {
    fmt::print("{}: passed ({:.2f} s)\n", test.name, to_seconds(clock.now() - begun));
    return kOk;
  }
  folder.keep();
  write_message(fmt::format("rths: {}: {}\n", test.name, result.failure));
  for (const auto& program : result.programs) print_log(folder.path() / (program + ".log"));
  write_message(fmt::format("logs and recording: {}\n", folder.path().string()));
  return kConditionNotMet;
}

}  // namespace

void add_test(CommandLine& line) {
  auto [command, a] = line.add(
      "test", "Run a test: programs on a ring of their own, faults, expectations of signals", test);
  command->add_option("file", a.file, "Test file")->required()->check(CLI::ExistingFile);
  command->add_option("--keep", a.kept, "Folder for logs and recordings of failed tests")
      ->capture_default_str();
}

}  // namespace rths::app
