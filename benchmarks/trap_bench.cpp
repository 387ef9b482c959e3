// SPDX-License-Identifier: Apache-2.0
//
// The cost of trapping a store through a pointer, for docs/cards.md: a store into a page that may
// only be read raises SIGSEGV. Its handler opens the page and lets the processor execute one
// instruction, after which SIGTRAP's handler reads the word and closes the page again; or it makes
// the store itself, through another mapping. x86-64 only.
#include <sys/mman.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>

namespace {

constexpr std::size_t kPage = 4096;
constexpr int kBatches = 200, kStores = 50;
constexpr greg_t kTrapFlag = 0x100;
constexpr greg_t kStoreLength = 2;  // of `mov %ecx, (%rax)` [B]

using Handler = void (*)(int, siginfo_t*, void*);

std::byte* window = nullptr;  ///< for the program
std::byte* second = nullptr;  ///< the same page for the handlers
std::uintptr_t stored_at = 0;
sigset_t before;
volatile std::uint32_t taken = 0, stores = 0;

std::uint32_t& word_at(std::uintptr_t address) {
  return *reinterpret_cast<std::uint32_t*>(second +
                                           (address - reinterpret_cast<std::uintptr_t>(window)));
}

void open_for_one_instruction(int, siginfo_t* info, void* context) {
  auto& state = *static_cast<ucontext_t*>(context);
  stored_at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  mprotect(window, kPage, PROT_READ | PROT_WRITE);
  before = state.uc_sigmask;
  sigfillset(&state.uc_sigmask);
  sigdelset(&state.uc_sigmask, SIGTRAP);
  state.uc_mcontext.gregs[REG_EFL] |= kTrapFlag;
}

void take_and_close(int, siginfo_t*, void* context) {
  auto& state = *static_cast<ucontext_t*>(context);
  state.uc_mcontext.gregs[REG_EFL] &= ~kTrapFlag;
  state.uc_sigmask = before;
  mprotect(window, kPage, PROT_READ);
  taken = std::atomic_ref{word_at(stored_at)}.load();
  stores = stores + 1;
}

void make_the_store(int, siginfo_t* info, void* context) {
  auto& registers = static_cast<ucontext_t*>(context)->uc_mcontext.gregs;
  taken = static_cast<std::uint32_t>(registers[REG_RCX]);
  std::atomic_ref{word_at(reinterpret_cast<std::uintptr_t>(info->si_addr))}.store(taken);
  registers[REG_RIP] += kStoreLength;
  stores = stores + 1;
}

void handle(int signal, Handler handler) {
  struct sigaction action {};
  action.sa_flags = SA_SIGINFO;
  action.sa_sigaction = handler;
  sigfillset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

double seconds_of_thread() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Computing time of a store [µs], median of the batches.
double time_of_a_store() {
  std::array<double, kBatches> batches{};
  for (auto& batch : batches) {
    const double begin = seconds_of_thread();
    for (int i = 0; i < kStores; ++i)
      asm volatile("movl %%ecx, (%%rax)" : : "c"(i), "a"(window + 64) : "memory");
    batch = (seconds_of_thread() - begin) / kStores * 1e6;
  }
  std::sort(batches.begin(), batches.end());
  return batches[kBatches / 2];
}

}  // namespace

int main() {
  const int file = memfd_create("trap_bench", 0);
  if (file < 0 || ftruncate(file, kPage) != 0) return 2;
  const auto map = [&](int access) {
    return static_cast<std::byte*>(mmap(nullptr, kPage, access, MAP_SHARED, file, 0));
  };
  window = map(PROT_READ);
  second = map(PROT_READ | PROT_WRITE);
  if (window == MAP_FAILED || second == MAP_FAILED) return 2;

  handle(SIGSEGV, open_for_one_instruction);
  handle(SIGTRAP, take_and_close);
  const double stepped = time_of_a_store();
  handle(SIGSEGV, make_the_store);
  const double made = time_of_a_store();
  if (stores != 2 * kBatches * kStores || taken != kStores - 1) return 1;  // each store was taken
  std::printf("{\"single_step_us\": %.3f, \"made_by_handler_us\": %.3f}\n", stepped, made);
  return 0;
}
