// SPDX-License-Identifier: Apache-2.0
#include "launcher_link.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include <rths/core/message.hpp>
#include <rths/core/text.hpp>

namespace rths::launch {
namespace {

constexpr double kMicro = 1e-6;
constexpr std::size_t kStepsPerLine = 500;

// The launcher is an ordinary process, which the host may run later than the nodes.
constexpr Duration kLongestLauncherSilence = std::chrono::seconds{1};
constexpr Duration kLongestSetup = std::chrono::seconds{1};  // without a launcher

}  // namespace

// Several lines can arrive at once: buffered lines come first, before the end of the pipe.
std::optional<std::string> LauncherLink::receive_line(Duration longest) {
  if (auto line = take_line()) return line;
  if (vanished_) {  // polling a closed pipe returns at once
    std::this_thread::sleep_for(longest);
    return std::nullopt;
  }
  pollfd descriptor{STDIN_FILENO, POLLIN, 0};
  const auto milliseconds = std::chrono::duration_cast<std::chrono::milliseconds>(longest).count();
  if (poll(&descriptor, 1, static_cast<int>(milliseconds)) <= 0) return std::nullopt;
  std::array<char, 512> chunk{};
  const ssize_t count = read(STDIN_FILENO, chunk.data(), chunk.size());
  vanished_ = count <= 0;
  if (!vanished_) received_.append(chunk.data(), static_cast<std::size_t>(count));
  return take_line();
}

std::optional<std::string> LauncherLink::find_trouble(TimePoint now) {
  if (vanished_) return "the launcher vanished";
  if (silence_.look(now, lines_) > kLongestLauncherSilence) return "the launcher is silent";
  return std::nullopt;
}

void LauncherLink::send_line(const std::string& line) {
  fmt::print("{}\n", line);
  std::fflush(stdout);
}

std::optional<std::string> LauncherLink::take_line() {
  for (;;) {
    const auto end = received_.find('\n');
    if (end == std::string::npos) return std::nullopt;
    std::string line = received_.substr(0, end);
    received_.erase(0, end + 1);
    ++lines_;
    if (line != kAlive) return line;
  }
}

std::optional<TimePoint> LauncherLink::wait_for_go() {
  const WallClock clock;
  for (;;) {
    const auto line = receive_line(kLookPeriod);
    if (line && line->rfind("go ", 0) == 0) return TimePoint{std::stoll(line->substr(3))};
    if (line || find_trouble(clock.now())) return std::nullopt;
  }
}

void SetupGuard::run(LauncherLink& launcher, const std::string& node) {
  const WallClock clock;
  TimePoint last_contact = clock.now();
  while (!done_.load(std::memory_order_relaxed)) {
    static_cast<void>(launcher.receive_line(kLookPeriod));
    const auto trouble = launcher.find_trouble(clock.now());
    if (!trouble) last_contact = clock.now();
    if (clock.now() - last_contact < kLongestSetup) continue;
    write_message(fmt::format("{}: {} before the start\n", node, trouble.value_or("")));
    std::_Exit(2);
  }
}

void send_times(const adapters::StepTimes& times) {
  const std::size_t steps = std::min(times.late.size(), times.duration.size());
  std::string line;
  for (std::size_t i = 0; i < steps; ++i) {
    line += fmt::format("{} {} ", std::lround(times.late[i] / kMicro),
                        std::lround(times.duration[i] / kMicro));
    if ((i + 1) % kStepsPerLine != 0 && i + 1 != steps) continue;
    LauncherLink::send_line(kTimesLine + line);
    line.clear();
  }
}

void read_times(const std::string& text, adapters::StepTimes& times) {
  const auto words = cells_of(text, ' ');
  for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
    const auto late = number_of(words[i]), duration = number_of(words[i + 1]);
    if (!late || !duration) return;
    times.late.push_back(static_cast<float>(*late * kMicro));
    times.duration.push_back(static_cast<float>(*duration * kMicro));
  }
}

}  // namespace rths::launch
