// SPDX-License-Identifier: Apache-2.0
#include "opensees_process.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr auto kExitTime = std::chrono::milliseconds{100};  // of a process after its socket closed
constexpr auto kLongestFarewell = std::chrono::seconds{1};  // of its last message
constexpr auto kToFinish = std::chrono::seconds{1};

// The script runs in its own folder.
ProgramStart start_of(const OpenSeesScript& script) {
  ProgramStart start;
  start.command = script.command;
  start.log = script.log;
  start.name = script.command[0];
  if (script.command.size() < 2) return start;
  const auto file = std::filesystem::absolute(script.command[1]);
  start.name = file.filename().string();
  start.command[1] = file.string();
  start.folder = file.parent_path();
  return start;
}

}  // namespace

OpenSeesProcess::OpenSeesProcess(const OpenSeesScript& script)
    : log_{script.log.string()}, restarted_{WallClock{}.now()} {
  for (const auto& [file, content] : script.files)
    if (!(std::ofstream{file} << content).flush())
      throw Error{fmt::format("{}: cannot be written", file.string())};
  if (script.command.empty())
    keeper_.emplace();
  else
    script_.emplace(start_of(script));
}

void OpenSeesProcess::keep(int socket) const {
  if (keeper_) keeper_->keep(socket);
}

void OpenSeesProcess::require_running() {
  if (!script_ || !script_->has_ended()) return;
  if (const auto failure = script_->failure()) throw Error{*failure};
  if (!ended_) ended_ = WallClock{}.now();
  if (WallClock{}.now() > *ended_ + kLongestFarewell)
    throw Error{"OpenSees exited before its elements disconnected"};
}

bool OpenSeesProcess::has_finished(double longest) {
  return !script_ || script_->has_ended() || silence() > from_seconds(longest);
}

Duration OpenSeesProcess::time_left(double longest, const char* problem) {
  require_running();
  const Duration left = restarted_ + from_seconds(longest) - WallClock{}.now();
  if (left > Duration{0}) return ended_ ? std::min<Duration>(left, kExitTime) : left;
  throw Error{fmt::format("OpenSees {} {:g} s{}", problem, longest,
                          script_ ? fmt::format(" ({})", log_) : "")};
}

std::string OpenSeesProcess::with_exit_reason(std::string message) {
  if (script_ && script_->wait(kExitTime))
    if (const auto failure = script_->failure(); failure && *failure != message)
      message += "; " + *failure;
  return message;
}

std::optional<std::string> OpenSeesProcess::finish() {
  if (keeper_) keeper_->release();
  if (!script_) return std::nullopt;
  script_->wait(kToFinish);
  return script_->failure();
}

}  // namespace rths::adapters
