// SPDX-License-Identifier: Apache-2.0
#include <rths/session/live.hpp>

#include <poll.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/launch/running_test.hpp>
#include <rths/recording/recording.hpp>

#include "look.hpp"
#include "look_process.hpp"

namespace rths::session {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;

constexpr auto kLongestLook = std::chrono::minutes{10};
constexpr auto kLongestEnd = std::chrono::seconds{30};         // of a run: its nodes come to rest
constexpr auto kLongestWait = std::chrono::milliseconds{200};  // until a signal is noticed

/// A process of this host, also after its number has become that of another one.
class WatchedProcess {
 public:
  explicit WatchedProcess(int pid) {
    // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
    descriptor_ = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
    if (descriptor_ < 0 && errno != ESRCH)
      throw Error{fmt::format("process {} cannot be watched: {}", pid, std::strerror(errno))};
  }
  ~WatchedProcess() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  WatchedProcess(const WatchedProcess&) = delete;
  WatchedProcess& operator=(const WatchedProcess&) = delete;

  /// Readable when it has ended; -1 if it had before.
  [[nodiscard]] int descriptor() const { return descriptor_; }
  [[nodiscard]] bool has_ended() const {
    pollfd ended{descriptor_, POLLIN, 0};
    return descriptor_ < 0 || poll(&ended, 1, 0) > 0;
  }

 private:
  int descriptor_ = -1;
};

// Waits until one of the descriptors is readable, at most a moment, and not beyond the deadline.
void wait_a_moment(std::array<int, 2> descriptors, steady_clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now());
  const auto wait = std::clamp(left, std::chrono::milliseconds{0}, kLongestWait);
  std::array<pollfd, 2> readable{pollfd{descriptors[0], POLLIN, 0}, {descriptors[1], POLLIN, 0}};
  poll(readable.data(), readable.size(), static_cast<int>(wait.count()));
  stop_if_interrupted();
}

// The file behind a name; another number if it is replaced.
ino_t number_of_file(const fs::path& file) {
  struct stat named {};
  return stat(file.c_str(), &named) == 0 ? named.st_ino : 0;
}

fs::path folder_for(const LiveSettings& settings) {
  return settings.how.out.empty() ? fs::path{"out/diagnosis"} / settings.ring : settings.how.out;
}

class LiveDiagnosis {
 public:
  LiveDiagnosis(const LiveSettings& settings, const std::function<void(const std::string&)>& tell)
      : settings_{settings},
        tell_{tell},
        running_{launch::find_running_test(settings.ring)},
        recorder_{running_.recorder},
        launcher_{running_.launcher},
        file_{number_of_file(running_.recording)},
        test_{live_test_of(running_.recording)},
        folder_{folder_for(settings)},
        locked_{folder_, {running_.recording}} {}

  void run() {
    if (test_.rate < kSlowRate)
      tell_(
          fmt::format("the rate of the test is {:g}, expected at least {:g}: a verdict may come "
                      "when the specimen has been tested already",
                      test_.rate, kSlowRate));
    for (auto due = steady_clock::now(); wait_until(due);
         due = std::max(due + interval(), steady_clock::now()))
      if (const auto look = look_while_it_runs()) tell_of(*look);
    await_end();
    end(look(TestState::Ended));
  }

 private:
  [[nodiscard]] steady_clock::duration interval() const {
    return std::chrono::duration_cast<steady_clock::duration>(
        std::chrono::duration<double>{settings_.interval});
  }

  // @returns false if the test has ended before
  bool wait_until(steady_clock::time_point due) const {
    while (!recorder_.has_ended()) {
      if (steady_clock::now() >= due) return true;
      wait_a_moment({recorder_.descriptor(), -1}, due);
    }
    return false;
  }

  // Nothing if the test ends meanwhile: the last look has more data.
  std::optional<Look> look_while_it_runs() {
    auto found = look(TestState::Running);
    if (found && found->kind == Look::Kind::Verdict) last_ = found->time;
    return found;
  }

  std::optional<Look> look(TestState state) const {
    LookProcess child{state == TestState::Running ? Priority::Idle : Priority::Usual, [&] {
                        return look_at(test_, folder_, settings_.how, state, last_).to_text();
                      }};
    const auto deadline = steady_clock::now() + kLongestLook;
    const int end = state == TestState::Running ? recorder_.descriptor() : -1;
    for (;;) {
      if (const auto text = child.read_result()) return Look::from_text(*text);
      if (state == TestState::Running && recorder_.has_ended()) return std::nullopt;
      if (steady_clock::now() >= deadline)
        return Look{Look::Kind::Failed, last_.value_or(0),
                    fmt::format("the look took longer than {} min", kLongestLook.count())};
      wait_a_moment({child.output(), end}, deadline);
    }
  }

  // The launcher adds the ending to a copy, which replaces the recording.
  void await_end() const {
    const auto deadline = steady_clock::now() + kLongestEnd;
    while (!launcher_.has_ended() && number_of_file(test_.recording) == file_ &&
           steady_clock::now() < deadline)
      wait_a_moment({launcher_.descriptor(), -1}, deadline);
    if (!fs::exists(test_.recording) || recording::is_being_written(test_.recording))
      throw Error{
          fmt::format("{}: was removed, or is written again since the test has ended; "
                      "there is no last look",
                      test_.recording.string())};
  }

  [[nodiscard]] std::string ending() const {
    const auto meta = recording::Reader{test_.recording}.meta();
    const auto ending = meta.find("ending");
    return ending == meta.end() ? "its launcher has left no ending" : ending->second;
  }

  [[nodiscard]] std::string place_of(const Look& look) const {
    return test_.duration > 0 ? fmt::format("at {:.2f} s of {:g} s", look.time, test_.duration)
                              : fmt::format("at {:.2f} s", look.time);
  }

  void tell_of(const Look& look) {
    if (look.kind == Look::Kind::Paused && std::exchange(is_paused_, true)) return;
    is_paused_ = look.kind == Look::Kind::Paused;
    constexpr std::array<const char*, 4> kHeads{"", "too early: ", "", "no verdict: "};
    tell_(fmt::format("{}: {}{}", place_of(look), kHeads.at(static_cast<std::size_t>(look.kind)),
                      look.text));
  }

  void end(const std::optional<Look>& look) const {
    if (const int other = launch::launcher_on(settings_.ring);
        other != 0 && other != running_.launcher)
      tell_(fmt::format("ring '{}' has another test now, of process {}: diagnose it anew",
                        settings_.ring, other));
    const std::string place = fmt::format("the test has ended ({}), {}", ending(), place_of(*look));
    if (look->kind != Look::Kind::Verdict)
      throw Error{fmt::format("{}; its last look has no verdict: {}", place, look->text)};
    tell_(fmt::format("{}: {}", place, look->text));
  }

  const LiveSettings& settings_;
  const std::function<void(const std::string&)>& tell_;
  launch::RunningTest running_;
  WatchedProcess recorder_, launcher_;
  ino_t file_;  ///< of the recording while it is written
  LiveTest test_;
  fs::path folder_;
  VerdictFolder locked_;
  std::optional<double> last_;  ///< model time of the last verdict [s]
  bool is_paused_ = false;
};

}  // namespace

void diagnose_live(const LiveSettings& settings,
                   const std::function<void(const std::string&)>& tell) {
  const Interruptible interruptible;
  LiveDiagnosis{settings, tell}.run();
}

}  // namespace rths::session
