// SPDX-License-Identifier: Apache-2.0
#include "opensees_process.hpp"

#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "rank_watch.hpp"
#include "script_runner.hpp"

namespace rths::adapters {
namespace {

constexpr std::size_t kMost = 256;      // sockets
constexpr int kDay = 24 * 3600 * 1000;  // [ms]
constexpr int kChecks = 50;             // 1 ms apart
constexpr char kKeep = 'k', kRelease = 'r';

/// A message on the control socket: a letter, and with `kKeep` a descriptor.
struct ControlMessage {
  char letter = 0;
  iovec content{&letter, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> ancillary{};
  msghdr header{};
  ControlMessage() {
    header.msg_iov = &content;
    header.msg_iovlen = 1;
    header.msg_control = ancillary.data();
    header.msg_controllen = ancillary.size();
  }
  ControlMessage(const ControlMessage&) = delete;
  ControlMessage& operator=(const ControlMessage&) = delete;
};

// All functions called by `run_keeper` run in the forked process: system calls only.
struct KeptSockets {
  std::array<pollfd, kMost + 1> entries;  ///< the first is the control socket
  std::size_t count = 1;
  bool is_orphan = false;
};

void receive(KeptSockets& kept) noexcept {
  ControlMessage message;
  const ssize_t got = recvmsg(kept.entries[0].fd, &message.header, MSG_CMSG_CLOEXEC);
  if (got < 0 && errno == EINTR) return;
  if (got > 0 && message.letter == kRelease) _exit(0);
  if (got <= 0) {
    kept.is_orphan = true;
    kept.entries[0].fd = -1;
    return;
  }
  const cmsghdr* const attached = CMSG_FIRSTHDR(&message.header);
  if (attached == nullptr || kept.count > kMost) return;
  int socket = -1;
  std::memcpy(&socket, CMSG_DATA(attached), sizeof socket);
  kept.entries[kept.count++] = {socket, POLLRDHUP, 0};
}

void close_ended(KeptSockets& kept) noexcept {
  for (std::size_t i = 1; i < kept.count;) {
    if (kept.entries[i].revents == 0) {
      ++i;
      continue;
    }
    close(kept.entries[i].fd);
    kept.entries[i] = kept.entries[--kept.count];
  }
}

[[noreturn]] void run_keeper(int control) noexcept {
  prctl(PR_SET_NAME, "rths-keeper");
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  setsid();  // detach from the terminal's interrupts
  // Close the run's files and pipes; their readers would otherwise wait for this process.
  if (control != STDIN_FILENO) dup2(control, STDIN_FILENO);
  close_range(STDIN_FILENO + 1, ~0U, 0);
  static KeptSockets kept;
  kept.entries[0] = {STDIN_FILENO, POLLIN, 0};
  while (!kept.is_orphan || kept.count > 1) {
    if (poll(kept.entries.data(), kept.count, kDay) == 0 && kept.is_orphan) break;
    close_ended(kept);
    if (kept.entries[0].revents != 0) receive(kept);
  }
  _exit(0);
}

constexpr auto kExitTime = std::chrono::milliseconds{100};  // of a process after its socket closed
constexpr auto kRanksExitTime = std::chrono::seconds{1};    // of the launcher that ends the others
constexpr auto kLongestFarewell = std::chrono::seconds{1};  // of its last message
constexpr auto kToFinish = std::chrono::seconds{1};

// The script runs in its own folder.
ProgramStart start_of(const OpenSeesScript& script, int floor_pipe) {
  ProgramStart start;
  start.command = script.command;
  start.log = script.log;
  start.name = script.command[0];
  if (script.command.size() < 2) return start;
  const auto file = std::filesystem::absolute(script.command[1]);
  start.name = file.filename().string();
  start.command[1] = file.string();
  start.folder = file.parent_path();
  run_inside(script, floor_pipe, start);
  return start;
}

}  // namespace

OpenSeesProcess::OpenSeesProcess(const OpenSeesScript& script)
    : log_{script.log.string()}, has_ranks_{script.processes > 1}, restarted_{WallClock{}.now()} {
  for (const auto& [file, content] : script.files)
    if (!(std::ofstream{file} << content).flush())
      throw Error{fmt::format("{}: cannot be written", file.string())};
  if (!script.floors.empty()) floors_.emplace(script.floors.size());
  if (script.command.empty())
    keeper_.emplace();
  else
    script_.emplace(start_of(script, floors_ ? floors_->writing_end() : -1));
  if (floors_) floors_->close_writing_end();
}

// Ranks are in sessions of their own. The launcher ends them, and waits for their end.
OpenSeesProcess::~OpenSeesProcess() {
  if (!has_ranks_ || !script_ || script_->has_ended()) return;
  script_->ask_to_end();
  script_->wait(kRanksExitTime);
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
  const std::string hanging = has_ranks_ ? hanging_ranks(process()) : "";
  throw Error{fmt::format("OpenSees {} {:g} s{}{}", problem, longest,
                          script_ ? fmt::format(" ({})", log_) : "",
                          hanging.empty() ? "" : ": " + hanging + ", expected all ranks to step")};
}

std::string OpenSeesProcess::with_exit_reason(std::string message) {
  if (script_ && script_->wait(has_ranks_ ? Duration{kRanksExitTime} : Duration{kExitTime}))
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

SocketKeeper::SocketKeeper() {
  std::array<int, 2> ends{};
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0)
    throw Error{fmt::format("the socket keeper cannot start: {}", std::strerror(errno))};
  pid_ = fork();
  if (pid_ == 0) run_keeper(ends[1]);
  close(ends[1]);
  control_ = ends[0];
  if (pid_ > 0) return;
  close(control_);
  throw Error{fmt::format("the socket keeper cannot start: {}", std::strerror(errno))};
}

SocketKeeper::~SocketKeeper() {
  close(control_);
  // Without sockets, the keeper exits now.
  wait_for_exit();
}

void SocketKeeper::wait_for_exit() {
  for (int check = 0; check < kChecks && pid_ > 0; ++check) {
    if (waitpid(pid_, nullptr, WNOHANG) != 0) pid_ = -1;
    if (pid_ > 0) std::this_thread::sleep_for(std::chrono::milliseconds{1});
  }
}

void SocketKeeper::keep(int socket) const {
  ControlMessage message;
  message.letter = kKeep;
  cmsghdr* const attached = CMSG_FIRSTHDR(&message.header);
  attached->cmsg_level = SOL_SOCKET;
  attached->cmsg_type = SCM_RIGHTS;
  attached->cmsg_len = CMSG_LEN(sizeof socket);
  std::memcpy(CMSG_DATA(attached), &socket, sizeof socket);
  static_cast<void>(sendmsg(control_, &message.header, MSG_NOSIGNAL));
}

void SocketKeeper::release() {
  static_cast<void>(send(control_, &kRelease, 1, MSG_NOSIGNAL));
  wait_for_exit();
}

}  // namespace rths::adapters
