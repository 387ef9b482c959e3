// SPDX-License-Identifier: Apache-2.0
#include "opensees_process.hpp"

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr auto kToDie = std::chrono::milliseconds{100};  // of a process whose socket is gone
constexpr auto kOnTheWay = std::chrono::seconds{1};      // of what it said last
constexpr auto kToFinish = std::chrono::seconds{1};

}  // namespace

OpenSeesProcess::OpenSeesProcess(const OpenSeesScript& script)
    : log_{script.log.string()}, heard_{WallClock{}.now()} {
  for (const auto& [file, content] : script.files)
    if (!(std::ofstream{file} << content).flush())
      throw Error{fmt::format("{}: cannot be written", file.string())};
  if (script.command.empty())
    keeper_.emplace();
  else
    script_.emplace(script.command, script.log);
}

void OpenSeesProcess::keep(int socket) const {
  if (keeper_) keeper_->keep(socket);
}

void OpenSeesProcess::require_running() {
  if (!script_ || !script_->has_ended()) return;
  if (const auto trouble = script_->trouble()) throw Error{*trouble};
  if (!ended_) ended_ = WallClock{}.now();
  if (WallClock{}.now() > *ended_ + kOnTheWay)
    throw Error{"OpenSees has ended, and its elements have not"};
}

bool OpenSeesProcess::has_finished(double longest) {
  return !script_ || script_->has_ended() || silence() > from_seconds(longest);
}

Duration OpenSeesProcess::patience(double longest, const char* otherwise) {
  require_running();
  const Duration left = heard_ + from_seconds(longest) - WallClock{}.now();
  if (left > Duration{0}) return ended_ ? std::min<Duration>(left, kToDie) : left;
  throw Error{fmt::format("OpenSees {} {:g} s{}", otherwise, longest,
                          script_ ? fmt::format(" ({})", log_) : "")};
}

std::string OpenSeesProcess::explained(std::string message) {
  if (script_ && script_->wait(kToDie))
    if (const auto trouble = script_->trouble(); trouble && *trouble != message)
      message += "; " + *trouble;
  return message;
}

std::optional<std::string> OpenSeesProcess::finish() {
  if (keeper_) keeper_->release();
  if (!script_) return std::nullopt;
  script_->wait(kToFinish);
  return script_->trouble();
}

}  // namespace rths::adapters
