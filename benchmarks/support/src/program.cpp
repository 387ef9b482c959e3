// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/program.hpp>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

using std::chrono::steady_clock;

// Starts a program with its standard output on `out`; standard input and error are /dev/null.
pid_t start(const std::vector<std::string>& command, int out) {
  std::vector<std::string> words = command;
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t pid = -1;
  const int problem = posix_spawn(&pid, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (problem != 0)
    throw Error{fmt::format("{} cannot be started: {}", command[0], std::strerror(problem))};
  return pid;
}

// Reads to the end of the stream; false if the deadline passes first.
bool read_all(int stream, steady_clock::time_point deadline, std::string& into) {
  std::array<char, 4096> chunk{};
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - steady_clock::now());
    pollfd wait{stream, POLLIN, 0};
    if (left.count() <= 0 || poll(&wait, 1, static_cast<int>(left.count())) == 0) return false;
    const ssize_t count = read(stream, chunk.data(), chunk.size());
    if (count <= 0) return true;
    into.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace

std::string output_of(const std::vector<std::string>& command, std::chrono::seconds timeout) {
  std::array<int, 2> pipe_ends{};
  if (pipe2(pipe_ends.data(), O_CLOEXEC) != 0) throw Error{"cannot create a pipe"};
  std::string out;
  bool in_time = false;
  pid_t pid = -1;
  try {
    pid = start(command, pipe_ends[1]);
    close(pipe_ends[1]);
  } catch (const Error&) {
    close(pipe_ends[0]);
    close(pipe_ends[1]);
    throw;
  }
  in_time = read_all(pipe_ends[0], steady_clock::now() + timeout, out);
  close(pipe_ends[0]);
  if (!in_time) kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
  if (!in_time)
    throw Error{fmt::format("{} was still running after {} s", command[0], timeout.count())};
  return out;
}

}  // namespace rths::bench
