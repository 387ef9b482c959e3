// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/partner.hpp>

#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <string>

#include <fmt/format.h>

namespace rths::bench {
namespace {

constexpr auto kLongestMessageWait =
    std::chrono::seconds{10};  // a message takes a few microseconds

void pin_to(int cpu) {
  cpu_set_t one;
  CPU_ZERO(&one);
  CPU_SET(cpu, &one);
  if (sched_setaffinity(0, sizeof one, &one) != 0)
    throw Error{fmt::format("processor {} cannot be used: {}", cpu, std::strerror(errno))};
}

}  // namespace

Pinned::Pinned(int cpu) : before_(sizeof(cpu_set_t)) {
  sched_getaffinity(0, before_.size(), reinterpret_cast<cpu_set_t*>(before_.data()));
  pin_to(cpu);
}

Pinned::~Pinned() {
  sched_setaffinity(0, before_.size(), reinterpret_cast<cpu_set_t*>(before_.data()));
}

SharedPages::SharedPages(std::size_t bytes)
    : bytes_{bytes},
      address_{mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0)} {
  if (address_ == MAP_FAILED)
    throw Error{fmt::format("{} bytes of shared memory: {}", bytes, std::strerror(errno))};
}

SharedPages::~SharedPages() { munmap(address_, bytes_); }

Partner::Partner(int cpu, const std::function<void()>& work) {
  const pid_t parent = getpid();
  pid_ = fork();
  if (pid_ < 0) throw Error{fmt::format("cannot start a second process: {}", std::strerror(errno))};
  if (pid_ > 0) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // The parent may have died before the prctl call.
  if (getppid() != parent) _exit(1);
  work_and_end(cpu, work);
}

// Ends without running the inherited destructors and flushing the inherited buffers.
void Partner::work_and_end(int cpu, const std::function<void()>& work) noexcept {
  try {
    pin_to(cpu);
    work();
  } catch (const std::exception& error) {
    std::snprintf(error_->text, sizeof error_->text, "%s", error.what());
    _exit(1);
  }
  _exit(0);
}

Partner::~Partner() {
  if (pid_ <= 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Partner::fail() const {
  const std::string reason = error_->text;
  throw Error{"the other side of the measurement ended" + (reason.empty() ? "" : ": " + reason)};
}

void Partner::expect_alive() {
  if (waitpid(pid_, nullptr, WNOHANG) == 0) return;
  pid_ = -1;
  fail();
}

void Partner::join() {
  int status = 0;
  waitpid(pid_, &status, 0);
  pid_ = -1;
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) fail();
}

SpinLimit::SpinLimit(Partner* partner) : partner_{partner} {}

void SpinLimit::check() {
  if (partner_ != nullptr) partner_->expect_alive();
  const auto now = std::chrono::steady_clock::now();
  if (rounds_ == kRoundsPerCheck) first_check_ = now;
  if (now - first_check_ > kLongestMessageWait) throw Error{"a message did not arrive"};
}

}  // namespace rths::bench
