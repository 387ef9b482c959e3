// SPDX-License-Identifier: Apache-2.0
#include "child_process.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>

extern char** environ;  // NOLINT: POSIX declares no header for it

namespace rths::launch {
namespace {

struct Pipe {
  int read_end = -1, write_end = -1;
};

// Both ends close on exec, so that no other child keeps a pipe open.
Pipe open_pipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw Error{fmt::format("cannot create a pipe to a process: {}", std::strerror(errno))};
  return {ends[0], ends[1]};
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& arguments) {
  std::signal(SIGPIPE, SIG_IGN);
  const Pipe to_child = open_pipe();
  const Pipe from_child = open_pipe();
  posix_spawn_file_actions_t actions{};
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, to_child.read_end, STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, from_child.write_end, STDOUT_FILENO);
  std::vector<char*> argv;
  std::string command = "/proc/self/exe";
  std::string name = "rths";
  argv.push_back(name.data());
  std::vector<std::string> copies = arguments;
  for (auto& argument : copies) argv.push_back(argument.data());
  argv.push_back(nullptr);
  const int problem = posix_spawn(&pid_, command.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(to_child.read_end);
  close(from_child.write_end);
  input_ = to_child.write_end;
  output_ = from_child.read_end;
  fcntl(output_, F_SETFL, O_NONBLOCK);
  fcntl(input_, F_SETFL, O_NONBLOCK);  // a stopped child must not stop this process
  if (problem != 0) {
    ended_ = true;
    throw Error{fmt::format("cannot start a process: {}", std::strerror(problem))};
  }
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_{std::exchange(other.pid_, -1)},
      input_{std::exchange(other.input_, -1)},
      output_{std::exchange(other.output_, -1)},
      ended_{std::exchange(other.ended_, true)},
      status_{other.status_},
      received_{std::move(other.received_)} {}

ChildProcess::~ChildProcess() {
  if (!ended_) {
    kill(pid_, SIGKILL);
    collect();
  }
  if (input_ >= 0) close(input_);
  if (output_ >= 0) close(output_);
}

void ChildProcess::collect() noexcept {
  while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  ended_ = true;
}

std::string ChildProcess::ending() const {
  if (WIFSIGNALED(status_)) return fmt::format("was killed by signal {}", WTERMSIG(status_));
  return fmt::format("exited with {}", WEXITSTATUS(status_));
}

bool ChildProcess::succeeded() const { return WIFEXITED(status_) && WEXITSTATUS(status_) == 0; }

void ChildProcess::send_line(const std::string& line) noexcept {
  if (ended_) return;
  const std::string text = line + "\n";
  // A pipe takes a short line whole or not at all. Reading detects a broken pipe.
  static_cast<void>(!write(input_, text.data(), text.size()));
}

std::optional<std::string> ChildProcess::read_line() {
  std::array<char, 4096> chunk{};
  while (!ended_) {
    const ssize_t count = read(output_, chunk.data(), chunk.size());
    if (count > 0) {
      received_.append(chunk.data(), static_cast<std::size_t>(count));
    } else if (count == 0) {
      collect();
    } else if (errno != EINTR) {
      break;
    }
  }
  const auto end = received_.find('\n');
  if (end == std::string::npos) return std::nullopt;
  std::string line = received_.substr(0, end);
  received_.erase(0, end + 1);
  return line;
}

}  // namespace rths::launch
