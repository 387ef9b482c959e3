// SPDX-License-Identifier: Apache-2.0
//
// A test file as programs on a ring, or as a run of an experiment.
#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>

#include <rths/adapters/child_program.hpp>
#include <rths/recording/recording.hpp>
#include <rths/testkit/test_file.hpp>

namespace rths::testkit {
namespace {

constexpr Duration kRunLook = std::chrono::milliseconds{20};  // at the programs
constexpr double kStopGrace = 10;                             // of an experiment [s]
constexpr Duration kLongestComparison = std::chrono::seconds{120};
constexpr const char* kCompareLog = "rths_compare.log";

/// An expectation of a signal, fed with its values in the order of time.
class Check {
 public:
  Check(const Expectation& expectation, SignalRing& ring) : expectation_{expectation}, ring_{ring} {
    condition_ = expectation.condition.of(ring, expectation.signal);
  }

  [[nodiscard]] const std::string& signal() const { return expectation_.signal; }
  [[nodiscard]] double begin() const { return expectation_.from; }
  [[nodiscard]] double end() const { return expectation_.from + expectation_.span; }
  [[nodiscard]] bool is_over() const { return is_over_; }
  [[nodiscard]] bool has_begun(double time) const { return time >= begin(); }

  /// @throws NotMet
  void take(double time, double value) {
    if (is_over_ || !has_begun(time) || time > end()) return;
    last_ = value;
    if (!condition_.is_met(value)) return;
    is_over_ = true;
    if (expectation_.is_never)
      throw NotMet{fmt::format("{}: expected never {}, found {} at {:.3f} s", signal(),
                               condition_.text(), quantity(ring_, signal(), value), time)};
  }
  /// @throws NotMet
  void expire() {
    is_over_ = true;
    if (expectation_.is_never) return;
    throw NotMet{fmt::format("{}: expected {} from {:g} to {:g} s, last value {}", signal(),
                             condition_.text(), begin(), end(),
                             last_ ? quantity(ring_, signal(), *last_) : "none")};
  }

 private:
  const Expectation& expectation_;
  SignalRing& ring_;
  Condition condition_{0};
  std::optional<double> last_;
  bool is_over_ = false;
};

std::vector<Check> checks_of(const TestFile& test, SignalRing& ring) {
  std::vector<Check> checks;
  for (const auto& expectation : test.expectations)
    if (!expectation.signal.empty()) checks.emplace_back(expectation, ring);
  return checks;
}

void begin_fault(Laboratory& laboratory, const PlannedFault& fault) {
  if (fault.kind == "kill") laboratory.kill(fault.program);
  if (fault.kind == "freeze") laboratory.freeze(fault.program);
  if (fault.kind == "delay") laboratory.delay(fault.node, fault.delay);
  if (fault.kind == "flip") laboratory.flip(fault.signal, fault.bit);
  if (fault.kind == "drop" && fault.signal.empty()) laboratory.drop(fault.node);
  if (fault.kind == "drop" && !fault.signal.empty()) laboratory.drop_signal(fault.signal);
}

/// The programs of a test, its faults and its expectations, from the begin on.
class TestCourse {
 public:
  TestCourse(const TestFile& test, Laboratory& laboratory)
      : test_{test}, laboratory_{laboratory}, checks_{checks_of(test, *laboratory.ring())} {
    for (const auto& fault : test.faults) {
      events_.emplace(fault.at, [&] { begin_fault(laboratory_, fault); });
      if (fault.lasting) events_.emplace(fault.at + *fault.lasting, [&] { end_fault(fault); });
    }
    for (auto& check : checks_)
      events_.emplace(check.begin(), [&] {
        check.take(std::max(now(), check.begin()), laboratory_.read(check.signal()));
      });
    for (const auto& expectation : test.expectations)
      if (!expectation.program.empty()) ends_.push_back(&expectation);
  }

  /// @throws NotMet
  void run(const std::function<bool()>& is_interrupted) {
    for (const auto& program : test_.programs) laboratory_.start(program);
    follow();
    begun_ = clock_.now();
    while (!is_over()) {
      if (is_interrupted()) throw NotMet{"interrupted"};
      advance();
    }
    laboratory_.check_programs();
    laboratory_.check_owners();
  }

 private:
  [[nodiscard]] double now() const { return to_seconds(clock_.now() - begun_); }
  [[nodiscard]] bool is_over() const {
    return ends_.empty() &&
           std::all_of(checks_.begin(), checks_.end(), [](const auto& c) { return c.is_over(); });
  }
  void follow() {
    std::vector<std::string> signals;
    for (const auto& check : checks_)
      if (std::find(signals.begin(), signals.end(), check.signal()) == signals.end())
        signals.push_back(check.signal());
    if (!signals.empty()) follower_ = laboratory_.ring()->follow(signals);
  }
  // Until the next event, the end of an expectation, or a look at the programs.
  void advance() {
    while (!events_.empty() && events_.begin()->first <= now()) {
      const auto action = events_.begin()->second;
      events_.erase(events_.begin());
      action();
    }
    for (auto& check : checks_)
      if (!check.is_over() && now() > check.end()) check.expire();
    check_ends();
    laboratory_.check_programs();
    wait(next());
  }
  [[nodiscard]] TimePoint next() const {
    double next = now() + to_seconds(kRunLook);
    if (!events_.empty()) next = std::min(next, events_.begin()->first);
    for (const auto& check : checks_)
      if (!check.is_over()) next = std::min(next, check.end());
    return begun_ + from_seconds(next);
  }
  void wait(TimePoint latest) {
    if (!follower_) return clock_.sleep_until(latest);
    broker::Write write;
    const Status status = follower_->wait(latest, write);
    if (status == Status::LimitExceeded)
      throw NotMet{"writes were lost: the test was more than a journal behind"};
    if (status != Status::Ok) return;
    const double time = now();
    for (const auto& [signal, value] : follower_->change_of(write).values)
      for (auto& check : checks_)
        if (check.signal() == signal) check.take(time, value);
  }
  void check_ends() {
    std::erase_if(ends_, [&](const Expectation* expectation) {
      if (now() < expectation->from) return false;
      const double left = expectation->from + expectation->span - now();
      if (laboratory_.has_ended(expectation->program)) return true;
      if (left < 0)
        throw NotMet{fmt::format("program '{}' did not end from {:g} to {:g} s",
                                 expectation->program, expectation->from,
                                 expectation->from + expectation->span)};
      return false;
    });
  }
  void end_fault(const PlannedFault& fault) {
    if (fault.kind == "freeze") return laboratory_.thaw(fault.program);
    laboratory_.restore(fault.node);
  }

  const TestFile& test_;
  Laboratory& laboratory_;
  std::vector<Check> checks_;
  std::vector<const Expectation*> ends_;
  std::multimap<double, std::function<void()>> events_;
  std::unique_ptr<SignalFollower> follower_;
  TimePoint begun_{0};
  mutable WallClock clock_;
};

// The rows of a recording instead of writes.
void check_recording(const TestFile& test, const std::filesystem::path& file) {
  const recording::Reader recorded{file};
  const auto ring = std::make_shared<SignalRing>(broker::Ring::in_process(recorded.map()));
  const auto& time = recorded.time();
  for (auto& check : checks_of(test, *ring)) {
    const auto values = recorded.signal(check.signal());
    for (std::size_t i = 0; i < values.size() && !check.is_over(); ++i)
      check.take(time[i], values[i]);
    if (!check.is_over()) check.expire();
  }
}

// How far the recording of the test is from a baseline, by `rths compare`.
void compare_with(const Baseline& baseline, const std::filesystem::path& recording,
                  const std::filesystem::path& folder, const std::filesystem::path& command) {
  if (!std::filesystem::exists(baseline.file))
    throw NotMet{fmt::format(
        "baseline {}: does not exist; if the recording of this test is right, make it: cp {} {}",
        baseline.file.string(), recording.string(), baseline.file.string())};
  adapters::ProgramStart start;
  start.name = "rths compare";
  start.command = {command.string(), "compare", baseline.file.string(), recording.string()};
  for (const auto& [option, value] :
       {std::pair{"--abs", baseline.absolute}, std::pair{"--rel", baseline.relative},
        std::pair{"--time-s", baseline.time}})
    start.command.insert(start.command.end(), {option, fmt::format("{}", value)});
  if (!baseline.aligned.empty())
    start.command.insert(start.command.end(), {"--align", baseline.aligned});
  if (!baseline.signals.empty()) start.command.emplace_back("--signals");
  for (const auto& pattern : baseline.signals) start.command.push_back(pattern);
  start.log = folder / kCompareLog;
  start.is_favoured = false;
  adapters::ChildProgram compare{start};
  if (!compare.wait(kLongestComparison))
    throw NotMet{fmt::format("the comparison with baseline {} did not end within {:g} s",
                             baseline.file.string(), to_seconds(kLongestComparison))};
  if (const auto failure = compare.failure())
    throw NotMet{fmt::format("baseline {}: {}", baseline.file.string(), *failure)};
}

void run_experiment(const TestFile& test, const std::filesystem::path& folder,
                    const std::filesystem::path& command,
                    const std::function<bool()>& is_interrupted) {
  adapters::ProgramStart start;
  start.name = "rths run";
  start.command = {command.string(),
                   "run",
                   test.experiment.string(),
                   "--clock",
                   test.clock,
                   "--out",
                   (folder / "run").string(),
                   "--ring",
                   folder.filename().string(),
                   "--no-diagnosis"};
  for (const auto& change : test.changes)
    start.command.insert(start.command.end(), {"--set", change});
  start.log = folder / "rths_run.log";
  start.is_favoured = false;
  adapters::ChildProgram run{start};
  const WallClock clock;
  const TimePoint latest = clock.now() + from_seconds(test.deadline);
  while (!run.wait(kRunLook) && clock.now() < latest && !is_interrupted()) continue;
  if (!run.has_ended()) {
    run.ask_to_end();
    run.wait(from_seconds(kStopGrace));
    throw NotMet{is_interrupted()
                     ? std::string{"interrupted"}
                     : fmt::format("the experiment did not end within {:g} s", test.deadline)};
  }
  const auto recording = folder / "run" / "run.h5";
  const auto failure = run.failure();
  const bool is_inconclusive = failure && failure->starts_with("rths run ended with 1");
  if ((failure && !is_inconclusive) || !std::filesystem::exists(recording))
    throw NotMet{failure.value_or("the experiment has no recorder")};
  check_recording(test, recording);
  for (const auto& baseline : test.baselines) compare_with(baseline, recording, folder, command);
}

}  // namespace

TestResult run_test(const TestFile& test, const std::filesystem::path& folder,
                    const std::filesystem::path& command,
                    const std::function<bool()>& is_interrupted) {
  TestResult result;
  if (!test.experiment.empty()) {
    result.programs = {"rths_run", "rths_compare"};
    try {
      run_experiment(test, folder, command, is_interrupted);
    } catch (const NotMet& failure) {
      result.failure = failure.what();
    }
    return result;
  }
  Laboratory laboratory{folder, test.map, test.deadline};
  for (const auto& program : test.programs) result.programs.push_back(program.name);
  try {
    const WallClock clock;
    const TimePoint latest = clock.now() + from_seconds(test.deadline);
    TestCourse{test, laboratory}.run([&] {
      if (clock.now() > latest)
        throw NotMet{fmt::format("the test did not end within {:g} s", test.deadline)};
      return is_interrupted();
    });
  } catch (const NotMet& failure) {
    result.failure = failure.what();
    laboratory.keep();
  }
  return result;
}

}  // namespace rths::testkit
