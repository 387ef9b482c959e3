// SPDX-License-Identifier: Apache-2.0
#include "look_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <thread>

#include <rths/core/error.hpp>

namespace rths::session {
namespace {

constexpr int kLowest = 19;  // of the nice values
constexpr auto kFarewell = std::chrono::seconds{2};
constexpr auto kNap = std::chrono::milliseconds{10};

// Of the disk (Linux: ioprio_set(2), which the C library does not wrap).
void read_when_idle() noexcept {
  constexpr int kProcess = 1, kIdleClass = 3, kClassShift = 13;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  static_cast<void>(syscall(SYS_ioprio_set, kProcess, 0, kIdleClass << kClassShift));
}

void run_when_idle() {
  setpriority(PRIO_PROCESS, 0, kLowest);
  const sched_param none{};
  sched_setscheduler(0, SCHED_IDLE, &none);
  read_when_idle();
  std::ofstream{"/proc/self/oom_score_adj"} << 1000;  // the largest
}

bool write_all(int to, const std::string& text) {
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t count = write(to, text.data() + written, text.size() - written);
    if (count <= 0) return false;
    written += static_cast<std::size_t>(count);
  }
  return true;
}

// A group of its own: signals of the terminal are for the parent, which passes them on.
[[noreturn]] void run_as_child(pid_t parent, int to, Priority priority,
                               const std::function<std::string()>& work) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, static_cast<unsigned long>(SIGTERM));
  if (getppid() != parent) _exit(1);
  int code = 1;
  try {
    if (priority == Priority::Idle) run_when_idle();
    const std::string result = work();
    code = write_all(to, result) ? 0 : 1;
  } catch (...) {  // NOLINT(bugprone-empty-catch): the parent sees that there is no result
  }
  _exit(code);
}

}  // namespace

LookProcess::LookProcess(Priority priority, const std::function<std::string()>& work) {
  std::array<int, 2> ends{};
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw Error{"no pipe for a child process"};
  std::fflush(nullptr);
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ == 0) {
    close(ends[0]);
    run_as_child(parent, ends[1], priority, work);
  }
  close(ends[1]);
  output_ = ends[0];
  if (pid_ > 0) return;
  close(output_);
  throw Error{"no child process for the diagnosis"};
}

LookProcess::~LookProcess() {
  close(output_);
  // To end at once it needs a processor; an unprivileged process may be refused that.
  const sched_param none{};
  sched_setscheduler(pid_, SCHED_OTHER, &none);
  setpriority(PRIO_PROCESS, static_cast<id_t>(pid_), 0);
  kill(pid_, SIGTERM);
  for (const auto until = std::chrono::steady_clock::now() + kFarewell;
       waitpid(pid_, nullptr, WNOHANG) == 0; std::this_thread::sleep_for(kNap))
    if (std::chrono::steady_clock::now() > until) {
      kill(-pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
      return;
    }
}

std::optional<std::string> LookProcess::read_result() {
  std::array<char, 4096> chunk{};
  for (;;) {
    pollfd readable{output_, POLLIN, 0};
    if (poll(&readable, 1, 0) <= 0) return std::nullopt;
    const ssize_t count = read(output_, chunk.data(), chunk.size());
    if (count <= 0) return text_;
    text_.append(chunk.data(), static_cast<std::size_t>(count));
  }
}

}  // namespace rths::session
