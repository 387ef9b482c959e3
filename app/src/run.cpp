// SPDX-License-Identifier: Apache-2.0
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/message.hpp>
#include <rths/session/run.hpp>

#include "command.hpp"
#include "figures.hpp"
#include "shown_progress.hpp"

namespace rths::app {
namespace {

struct RunArguments {
  session::RunSettings settings;
  std::string clock = "wall";
  std::vector<std::string> sets;  ///< key=value
  bool json = false;
  bool views = false;
};

struct NodeArguments {
  std::string experiment, node, ring, recording;
  Changes changes;
  std::vector<std::string> sets;  ///< key=value
};

struct ReportArguments {
  std::string folder, beside;
  FiguresArguments figures;
};

std::string text_of(const report::ReportOutcome& written) {
  return fmt::format("report    {}\nnumbers   {}\n{}", written.page.string(),
                     written.numbers.string(), written.summary);
}

/// Results on standard output, as lines or as one JSON document; messages go to standard error.
class Output {
 public:
  explicit Output(bool json) : json_{json} {}

  // Before the long steps that follow.
  void test(const session::RunResult& result) const {
    const auto missing = result.outcome.rows_missing;
    if (!result.folder.empty())
      line("recording {}{}\n",
           result.recording.empty() ? result.no_recording : result.recording.string(),
           missing > 0 ? fmt::format(", {} rows missing", missing) : "");
    if (!result.outcome.completed)
      write_message(fmt::format("rths: the run ended early: {}\n", result.ending()));
  }

  void all(const session::RunResult& result) const {
    if (result.outcome.completed)
      conclusion(result);
    else
      end(result);
    if (json_) fmt::print("{}", session::json_of(result));
  }

 private:
  template <class... Values>
  void line(const char* format, const Values&... values) const {
    if (!json_) fmt::print(fmt::runtime(format), values...);
  }

  void end(const session::RunResult& result) const {
    for (const auto& condition : result.broken)
      write_message(fmt::format("rths: before it: {}\n", condition.text()));
    if (result.report) line("report    {}\n", result.report->page.string());
    if (!result.no_report.empty())
      write_message(fmt::format("rths: no report: {}\n", result.no_report));
  }

  void conclusion(const session::RunResult& result) const {
    if (const auto& files = result.diagnosis) {
      line("diagnosis {}\n{}\n", files->page.string(), result.verdict);
      for (const auto& file : {files->experiment, files->fragment})
        if (file) line("improved  {}\n", file->string());
    }
    if (!result.no_diagnosis.empty())
      write_message(fmt::format("rths: no diagnosis: {}\n", result.no_diagnosis));
    if (result.report) line("{}", text_of(*result.report));
    for (const auto& what : result.not_made) write_message(fmt::format("rths: {}\n", what));
  }

  bool json_;
};

/// The page of a run: `rths view` in a process of its own, until the run has ended. Its address
/// goes to standard error.
class PageOfRun {
 public:
  /// @throws Error if the process cannot be started
  explicit PageOfRun(const RunArguments& run) {
    std::vector<std::string> words = words_for(run);
    std::vector<char*> arguments;
    for (auto& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    pid_ = fork();
    if (pid_ < 0) throw Error{"the page of the run cannot be started: no process is free"};
    if (pid_ > 0) return;
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    setpgid(0, 0);  // a Ctrl-C is for the run: the page shows how it ends
    dup2(STDERR_FILENO, STDOUT_FILENO);
    execv("/proc/self/exe", arguments.data());
    _exit(kFailure);
  }
  ~PageOfRun() {
    constexpr Duration kLongestEnd = std::chrono::seconds{3};
    std::fflush(stdout);  // the results, before the page has ended
    kill(pid_, SIGTERM);
    WallClock clock;
    const TimePoint latest = clock.now() + kLongestEnd;
    while (waitpid(pid_, nullptr, WNOHANG) == 0) {
      if (clock.now() > latest) kill(pid_, SIGKILL);
      clock.sleep_until(clock.now() + std::chrono::milliseconds{10});
    }
  }
  PageOfRun(const PageOfRun&) = delete;
  PageOfRun& operator=(const PageOfRun&) = delete;

 private:
  static std::vector<std::string> words_for(const RunArguments& run) {
    const auto& settings = run.settings;
    std::vector<std::string> words{"rths", "view", "--experiment", settings.experiment.string()};
    if (!settings.ring.empty()) words.push_back(settings.ring);
    for (const auto& set : run.sets) words.insert(words.end(), {"--set", set});
    if (!settings.out.empty()) {
      const auto folder = std::filesystem::absolute(settings.out).parent_path();
      words.insert(words.end(), {"--runs", folder.string()});
    }
    return words;
  }
  pid_t pid_ = -1;
};

int run(const RunArguments& arguments) {
  std::optional<PageOfRun> page;
  ShownProgress progress;
  // The check finds mistakes before the page does, and keeps the modes of a large plant for it.
  if (arguments.views) progress.functions().checked = [&] { page.emplace(arguments); };
  const Output output{arguments.json};
  std::optional<session::RunResult> test;
  progress.functions().recorded = [&](const session::RunResult& result) {
    progress.end();
    output.test(result);
    test = result;
  };
  try {
    test = session::run(arguments.settings, progress.functions());
  } catch (...) {
    if (test && arguments.json) fmt::print("{}", session::json_of(*test));
    throw;
  }
  progress.end();
  output.all(*test);
  if (!test->outcome.completed && !test->outcome.interrupted) return kFailure;
  return test->is_conclusive() ? kOk : kConditionNotMet;
}

int node(const NodeArguments& arguments) {
  const auto experiment = load_experiment(arguments.experiment, arguments.changes);
  return launch::run_node(experiment, arguments.node, arguments.ring, arguments.recording,
                          version());
}

int report(const ReportArguments& arguments) {
  arguments.figures.check();
  const auto written = session::report(arguments.folder, arguments.beside);
  fmt::print("{}", text_of(written));
  std::fflush(stdout);
  fmt::print("{}", arguments.figures.write(written.page));
  return written.conclusive ? kOk : kConditionNotMet;
}

void complete(RunArguments& given) {
  auto& settings = given.settings;
  if (given.views && given.clock == "virtual")
    throw CLI::ValidationError{"--view", "found --clock virtual, whose ring nobody else sees"};
  if (given.clock == "virtual") settings.clock = launch::ClockKind::Virtual;
  settings.repeats_late = given.clock == "auto";
  settings.changes = split_changes(given.sets);
  settings.version = version();
}

}  // namespace

void add_run(CommandLine& line) {
  auto [command, a] =
      line.add("run", "Run an experiment and write its recording and report", run, complete);
  command->add_option("experiment", a.settings.experiment, "Experiment file")->required();
  command
      ->add_option("--clock", a.clock,
                   "wall: real time, one process per node; virtual: deterministic, no waiting; "
                   "auto: real time, repeated in virtual time if the host was too late")
      ->check(CLI::IsMember({"wall", "virtual", "auto"}));
  auto* out = command->add_option("--out", a.settings.out,
                                  "Folder for the results [a new one: out/<name>/<UTC time>]");
  command
      ->add_flag("--force", a.settings.replaces, "Replace the results of an earlier run in --out")
      ->needs(out);
  command->add_option("--ring", a.settings.ring, "Name of the ring [the experiment's]");
  auto* host = command->add_option("--host", a.settings.host,
                                   "Run only the nodes of this host, together with the other hosts "
                                   "of the experiment");
  command
      ->add_option("--interface", a.settings.interface,
                   "Network interface or address, with --host [the experiment's]")
      ->needs(host);
  repeatable(command->add_option(
      "--set", a.sets,
      "Override a key of the experiment: key=value, such as map=sts or motion.scale=0.5"));
  repeatable(
      command
          ->add_option("--improve", a.settings.improvements,
                       "improved.toml of a diagnosis, added to the improvements of the model")
          ->check(CLI::ExistingFile));
  command->add_flag("!--no-diagnosis", a.settings.diagnoses,
                    "Do not diagnose the recording at the end");
  command->add_flag("--view", a.views, "Serve a page that shows the test live, as rths view");
  command->add_flag("--json", a.json, "One JSON document instead of lines");
}

void add_node(CommandLine& line) {
  auto [command, a] =
      line.add("node", "Run one node; for the launcher", node,
               [](NodeArguments& given) { given.changes = split_changes(given.sets); });
  command->group("");
  command->add_option("experiment", a.experiment)->required();
  command->add_option("--node", a.node)->required();
  command->add_option("--ring", a.ring)->required();
  command->add_option("--recording", a.recording)->required();
  repeatable(command->add_option("--set", a.sets));
}

void add_report(CommandLine& line) {
  auto [command, a] = line.add("report", "Rewrite the report of a run", report);
  command->add_option("folder", a.folder, "Folder of the run")->required();
  command->add_option("--beside", a.beside,
                      "Folder of another run, to show its response and spectra, too");
  add_figures(*command, a.figures);
}

}  // namespace rths::app
