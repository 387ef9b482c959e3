// SPDX-License-Identifier: Apache-2.0
//
// The kernel sends SIGBUS to a process that touches a page which its object no longer has. The
// handler finds the mapping of the page. It uses system calls only, since it may interrupt any
// code.
#include <rths/broker/detail/lost_memory.hpp>

#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>

#include <rths/broker/detail/layout.hpp>
#include <rths/broker/ring.hpp>

namespace rths::broker {
namespace {

struct Guarded {
  std::atomic<std::uintptr_t> begin{0};  ///< 0: free
  std::atomic<std::uintptr_t> end{0};
  std::atomic<std::atomic<bool>*> lost{nullptr};
};

constexpr std::size_t kMostGuarded = 512;  // further mappings are not guarded
constexpr std::uintptr_t kTaken = 1;
std::array<Guarded, kMostGuarded> guarded;
std::atomic<OnLostMemory> policy{OnLostMemory::Exit};

std::uintptr_t number_of(const std::byte* address) {
  return reinterpret_cast<std::uintptr_t>(address);
}

Guarded* find(std::uintptr_t address) noexcept {
  for (Guarded& range : guarded) {
    const std::uintptr_t begin = range.begin.load();
    if (begin > kTaken && begin <= address && address < range.end.load()) return &range;
  }
  return nullptr;
}

// Leaves SIGBUS to the kernel: the process ends when it repeats the access.
void give_up() noexcept { std::signal(SIGBUS, SIG_DFL); }

[[noreturn]] void end_process() noexcept {
  constexpr char kMessage[] =
      "rths: memory of the ring was lost: its shared-memory object was truncated\n";
  static_cast<void>(!write(STDERR_FILENO, kMessage, sizeof kMessage - 1));
  _exit(2);
}

bool replace_page(void* address) noexcept {
  const auto in_page = reinterpret_cast<std::uintptr_t>(address) % kPageBytes;
  void* page = static_cast<std::byte*>(address) - in_page;
  return mmap(page, kPageBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1,
              0) != MAP_FAILED;
}

void handle(int, siginfo_t* info, void*) noexcept {
  const int saved = errno;
  const auto number = reinterpret_cast<std::uintptr_t>(info->si_addr);
  Guarded* range = info->si_code == BUS_ADRERR ? find(number) : nullptr;
  if (range == nullptr) return give_up();
  if (policy.load() == OnLostMemory::Exit) end_process();
  // Before the page is there: a thread that reads its zeros finds the mark set.
  range->lost.load()->store(true);
  if (!replace_page(info->si_addr)) give_up();
  errno = saved;
}

}  // namespace

void guard(std::byte* address, std::uint64_t bytes, std::atomic<bool>& lost) noexcept {
  for (Guarded& range : guarded) {
    std::uintptr_t free = 0;
    if (!range.begin.compare_exchange_strong(free, kTaken)) continue;
    range.lost.store(&lost);
    range.end.store(number_of(address) + bytes);
    range.begin.store(number_of(address));
    return;
  }
}

void unguard(std::byte* address) noexcept {
  for (Guarded& range : guarded)
    if (range.begin.load() == number_of(address)) range.begin.store(0);
}

void on_lost_memory(OnLostMemory reaction) {
  policy.store(reaction);
  struct sigaction action {};
  action.sa_sigaction = handle;
  action.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &action, nullptr);
}

}  // namespace rths::broker
