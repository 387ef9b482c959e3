// SPDX-License-Identifier: Apache-2.0
#include <optional>
#include <string>

#include <fmt/format.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/core/message.hpp>
#include <rths/session/run.hpp>

#include "commands.hpp"
#include "shown_progress.hpp"

namespace rths::app {
namespace {

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

}  // namespace

int run(const RunArguments& arguments) {
  ShownProgress progress;
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

int report(const std::string& folder, const std::string& beside) {
  const auto written = session::report(folder, beside);
  fmt::print("{}", text_of(written));
  return written.conclusive ? kOk : kConditionNotMet;
}

void check_sizes(const experiment::Experiment& experiment) {
  for (const auto& remark : session::remarks_on(experiment))
    write_message(fmt::format("rths: {}\n", remark));
}

std::string version() { return RTHS_VERSION; }

}  // namespace rths::app
