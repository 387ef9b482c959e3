// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <climits>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <system_error>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/interrupted.hpp>

namespace rths::app {

/// A folder that is removed with everything in it, also by a signal that ends the process. One at
/// a time.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& purpose) {
    const Blocked signals;
    std::string name = (temporary_folder() / ("rths-" + purpose + "-XXXXXX")).string();
    if (name.size() >= named().size() || mkdtemp(name.data()) == nullptr)
      throw Error{name + ": the folder cannot be created"};
    path_ = name;
    name.copy(named().data(), name.size());
    named()[name.size()] = '\0';
    struct sigaction action {};
    action.sa_handler = remove_and_end;
    for (std::size_t i = 0; i < std::size(kEndingSignals); ++i)
      sigaction(kEndingSignals[i], &action, &previous_[i]);
  }
  ~TemporaryFolder() {
    for (std::size_t i = 0; i < std::size(kEndingSignals); ++i)
      sigaction(kEndingSignals[i], &previous_[i], nullptr);
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  // Delays the signals while the object lives.
  class Blocked {
   public:
    Blocked() {
      sigset_t signals;
      sigemptyset(&signals);
      for (const int signal : kEndingSignals) sigaddset(&signals, signal);
      pthread_sigmask(SIG_BLOCK, &signals, &before_);
    }
    ~Blocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    Blocked(const Blocked&) = delete;
    Blocked& operator=(const Blocked&) = delete;

   private:
    sigset_t before_{};
  };

  static std::array<char, PATH_MAX>& named() {
    static std::array<char, PATH_MAX> path{};
    return path;
  }
  // A handler may not allocate, so another program removes the folder. Other threads may still
  // write into it.
  static void remove_and_end(int signal) {
    constexpr int kAttempts = 10;
    for (int i = 0; i < kAttempts && access(named().data(), F_OK) == 0; ++i) {
      const pid_t child = _Fork();
      if (child == 0) {
        execl("/bin/rm", "rm", "-rf", "--", named().data(), nullptr);  // NOLINT: variadic
        _exit(1);
      }
      if (child > 0) waitpid(child, nullptr, 0);
    }
    struct sigaction action {};
    action.sa_handler = SIG_DFL;
    sigaction(signal, &action, nullptr);
    raise(signal);
  }

  std::filesystem::path path_;
  struct sigaction previous_[std::size(kEndingSignals)] = {};
};

}  // namespace rths::app
