// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/child_program.hpp>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <string_view>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {
namespace {

constexpr int kNotFound = 127;         // exit code, as in a shell
constexpr int kHighestPriority = -20;  // of the scheduler's normal class

// Runs in the child: only async-signal-safe calls.
[[noreturn]] void become(char* const* argv, char* const* environment, const char* folder, int log,
                         int kept_open, pid_t parent, bool is_favoured) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kNotFound);  // the parent has exited
  setpgid(0, 0);                              // the parent forwards a terminal's signals
  if (is_favoured) setpriority(PRIO_PROCESS, 0, kHighestPriority);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) std::signal(signal, SIG_DFL);
  if (chdir(folder) != 0) _exit(kNotFound);
  dup2(log, STDOUT_FILENO);
  dup2(log, STDERR_FILENO);
  if (kept_open >= 0) fcntl(kept_open, F_SETFD, 0);
  const int null = open("/dev/null", O_RDONLY);
  dup2(null, STDIN_FILENO);
  execvpe(argv[0], argv, environment);
  _exit(kNotFound);
}

// Runs in a copy of this process: only async-signal-safe calls. Ends the program's process group
// when `parent_lives`, a pipe of which the parent has the other end, is closed. The kernel does so
// too when it kills the parent.
[[noreturn]] void guard(pid_t group, int parent_lives) {
  setsid();  // signals of a terminal, and those of the parent's group, are not for it
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) std::signal(signal, SIG_IGN);
  dup2(parent_lives, STDIN_FILENO);
  close_range(STDIN_FILENO + 1, ~0U, 0);
  char byte = 0;
  while (read(STDIN_FILENO, &byte, 1) < 0 && errno == EINTR) continue;
  kill(-group, SIGKILL);
  _exit(0);
}

// Skips the line "…Terminating" that OpenSees prints at each exit.
std::string last_line_of(const std::filesystem::path& file, const std::string& telling) {
  std::ifstream in{file};
  std::string line, last;
  while (std::getline(in, line))
    if (line.find_first_not_of(" \t\r") != std::string::npos && !line.ends_with("Terminating") &&
        line.starts_with(telling))
      last = line;
  return last;
}

// Null-terminated pointers to the texts, as exec takes them.
std::vector<char*> pointers_to(std::vector<std::string>& texts) {
  std::vector<char*> pointers;
  for (auto& text : texts) pointers.push_back(text.data());
  pointers.push_back(nullptr);
  return pointers;
}

// The variables of this process, with the given ones added or replaced.
std::vector<std::string> environment_of(const ProgramStart& start) {
  std::vector<std::string> all;
  for (const auto& [name, value] : start.environment)
    all.push_back(fmt::format("{}={}", name, value));
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string_view text{*variable};
    const auto name = text.substr(0, text.find('='));
    if (std::none_of(start.environment.begin(), start.environment.end(),
                     [&](const auto& given) { return given.first == name; }))
      all.emplace_back(text);
  }
  return all;
}

}  // namespace

ChildProgram::ChildProgram(const ProgramStart& start)
    : name_{start.name}, log_{start.log}, telling_{start.telling} {
  const int file = open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (file < 0) throw Error{fmt::format("{}: {}", log_.string(), std::strerror(errno))};
  std::vector<std::string> words = start.command;
  // It runs in another folder.
  if (words.at(0).find('/') != std::string::npos)
    words[0] = std::filesystem::absolute(words[0]).string();
  const auto argv = pointers_to(words);
  auto variables = environment_of(start);
  const auto environment = pointers_to(variables);
  const std::string folder = std::filesystem::absolute(start.folder).string();
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0)
    become(argv.data(), environment.data(), folder.c_str(), file, start.kept_open, parent,
           start.is_favoured);
  const int error = errno;
  close(file);
  if (pid_ > 0) start_guard();
  if (pid_ < 0) throw Error{fmt::format("{} cannot be started: {}", name_, std::strerror(error))};
}

// The program ends with its parent by PR_SET_PDEATHSIG; processes that it has started do not.
void ChildProgram::start_guard() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
  guard_ = fork();
  if (guard_ == 0) {
    close(ends[1]);
    guard(pid_, ends[0]);
  }
  close(ends[0]);
  lifeline_ = ends[1];
}

void ChildProgram::end_guard() noexcept {
  if (guard_ > 0) {
    kill(guard_, SIGKILL);
    waitpid(guard_, nullptr, 0);
  }
  if (lifeline_ >= 0) close(lifeline_);
}

void ChildProgram::ask_to_end() const noexcept {
  if (!has_ended_) kill(-pid_, SIGTERM);
}

ChildProgram::~ChildProgram() {
  end_guard();
  if (has_ended()) return;
  kill(-pid_, SIGKILL);  // its process group: also processes that a wrapper has started
  kill(pid_, SIGKILL);
  waitpid(pid_, &status_, 0);
}

bool ChildProgram::has_ended() {
  if (!has_ended_) has_ended_ = waitpid(pid_, &status_, WNOHANG) == pid_;
  return has_ended_;
}

bool ChildProgram::wait(Duration longest) {
  const WallClock clock;
  const TimePoint deadline = clock.now() + longest;
  while (!has_ended() && clock.now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds{5});
  return has_ended_;
}

std::optional<std::string> ChildProgram::failure() const {
  if (!has_ended_) return fmt::format("{} does not exit", name_);
  if (WIFEXITED(status_) && WEXITSTATUS(status_) == 0) return std::nullopt;
  const std::string how =
      WIFSIGNALED(status_) ? fmt::format("was killed by signal {}", WTERMSIG(status_))
      : WEXITSTATUS(status_) == kNotFound ? std::string{"could not be started"}
                                          : fmt::format("ended with {}", WEXITSTATUS(status_));
  const std::string line = last_line_of(log_, telling_);
  return fmt::format("{} {}{} ({})", name_, how, line.empty() ? "" : ": " + line, log_.string());
}

}  // namespace rths::adapters
