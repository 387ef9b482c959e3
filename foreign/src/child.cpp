// SPDX-License-Identifier: Apache-2.0
#include "child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/interrupted.hpp>

namespace rths::foreign {
namespace {

constexpr std::streamoff kMostShown = 600;  // of the messages of a program [B]

constexpr int kNotStarted = 127, kThrew = 126;

// In the child: what a run may do. Only calls that a signal handler may make.
void confine(const char* folder, int messages) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int number : kEndingSignals) std::signal(number, SIG_DFL);
  const rlimit size{kMostTextBytes, kMostTextBytes};
  setrlimit(RLIMIT_FSIZE, &size);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(messages, STDOUT_FILENO) < 0 ||
      dup2(messages, STDERR_FILENO) < 0 || chdir(folder) != 0)
    _exit(kNotStarted);
}

// In the child, between fork and exec: only calls that a signal handler may make.
[[noreturn]] void become(char* const* arguments) {
  execv(arguments[0], arguments);
  const char* reason = std::strerror(errno);
  static_cast<void>(!write(STDERR_FILENO, reason, std::strlen(reason)));
  _exit(kNotStarted);
}

[[noreturn]] void work_and_exit(const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {
    // Its text takes the place of all other messages.
    static_cast<void>(!ftruncate(STDERR_FILENO, 0));
    lseek(STDERR_FILENO, 0, SEEK_SET);
    static_cast<void>(!write(STDERR_FILENO, error.what(), std::strlen(error.what())));
    _exit(kThrew);
  }
  _exit(0);
}

/// A process and those that it starts. None is left when this object ends.
class ProcessGroup {
 public:
  /// @param main  of the process; does not return
  ProcessGroup(const std::function<void()>& main, const std::filesystem::path& folder)
      : folder_{folder.string()} {
    const std::string file = (folder / kMessages).string();
    const int messages = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (messages < 0) throw Error{file + ": cannot be written"};
    pid_ = fork();
    if (pid_ == 0) {
      confine(folder_.c_str(), messages);
      main();
    }
    close(messages);
    if (pid_ < 0) throw Error{"there is no process for a run"};
    setpgid(pid_, pid_);  // here, too: before the first look at it
    watch_ = static_cast<int>(syscall(SYS_pidfd_open, pid_, 0));
  }
  ~ProcessGroup() {
    static_cast<void>(end());
    if (watch_ >= 0) close(watch_);
  }
  ProcessGroup(const ProcessGroup&) = delete;
  ProcessGroup& operator=(const ProcessGroup&) = delete;

  /// Waits until the process has ended or some milliseconds have passed.
  [[nodiscard]] bool has_ended_within(int milliseconds) const {
    pollfd watched{watch_, POLLIN, 0};
    static_cast<void>(poll(&watched, watch_ >= 0 ? 1 : 0, milliseconds));
    siginfo_t ended{};
    return waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOHANG | WNOWAIT) != 0 ||
           ended.si_pid == pid_;
  }
  /// Ends what still runs. @returns the status, as from waitpid
  int end() {
    if (is_reaped_) return status_;
    kill(-pid_, SIGKILL);
    while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    is_reaped_ = true;
    return status_;
  }

 private:
  std::string folder_;
  pid_t pid_ = -1;
  int watch_ = -1;
  int status_ = 0;
  bool is_reaped_ = false;
};

std::string end_of(const std::filesystem::path& file) {
  std::ifstream stream{file, std::ios::binary | std::ios::ate};
  if (!stream) return "";
  const std::streamoff size = stream.tellg();
  stream.seekg(std::max<std::streamoff>(0, size - kMostShown));
  std::string text{std::istreambuf_iterator<char>{stream}, {}};
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  return text;
}

std::string trouble_of(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("was ended by signal {} ({})", WTERMSIG(status),
                       strsignal(WTERMSIG(status)));
  return WEXITSTATUS(status) == 0 ? ""
                                  : fmt::format("ended with exit code {}", WEXITSTATUS(status));
}

ChildEnding watch(const std::function<void()>& main, const std::filesystem::path& folder,
                  double deadline) {
  const WallClock clock;
  const TimePoint begin = clock.now();
  ProcessGroup group{main, folder};
  bool is_late = false;
  while (!is_late) {
    const double left = deadline - to_seconds(clock.now() - begin);
    const int wait = std::clamp(static_cast<int>(1000 * left), 1, kLookMilliseconds);
    if (group.has_ended_within(wait)) break;
    stop_if_interrupted();
    is_late = to_seconds(clock.now() - begin) >= deadline;
  }
  return ending_of(group.end(), is_late ? std::optional{deadline} : std::nullopt, folder);
}

}  // namespace

std::string told(const std::string& title, const ChildEnding& ending) {
  return fmt::format("{}: {}{}{}", title, ending.trouble,
                     ending.messages.empty() ? "" : "; it wrote: ", ending.messages);
}

ChildEnding ending_of(int status, std::optional<double> deadline,
                      const std::filesystem::path& folder) {
  std::string messages = end_of(folder / kMessages);
  if (!deadline && WIFEXITED(status) && WEXITSTATUS(status) == kThrew) return {messages, ""};
  return {deadline ? fmt::format("did not end within {:g} s (deadline_s)", *deadline)
                   : trouble_of(status),
          std::move(messages)};
}

ChildEnding run_child(const std::vector<std::string>& command, const std::filesystem::path& folder,
                      double deadline) {
  std::vector<char*> arguments;
  for (const auto& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  return watch([&] { become(arguments.data()); }, folder, deadline);
}

ChildEnding run_forked(const std::function<void()>& work, const std::filesystem::path& folder,
                       double deadline) {
  return watch([&] { work_and_exit(work); }, folder, deadline);
}

SharedNumbers::SharedNumbers(std::size_t count)
    : bytes_{std::max<std::size_t>(1, count) * sizeof(double)} {
  void* const memory =
      mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw Error{"there is no memory for the results of a run"};
  data_ = static_cast<double*>(memory);
}

SharedNumbers::~SharedNumbers() { munmap(data_, bytes_); }

TemporaryRun::TemporaryRun() {
  std::string name = (temporary_folder() / "rths_run_XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw Error{name + ": the folder cannot be made"};
  path_ = name;
}

TemporaryRun::~TemporaryRun() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void TemporaryRun::write(const std::string& name, const std::string& text) const {
  std::ofstream file{path_ / name, std::ios::binary};
  file << text;
  file.close();
  if (!file) throw Error{(path_ / name).string() + ": cannot be written"};
}

}  // namespace rths::foreign
