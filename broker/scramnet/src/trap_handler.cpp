// SPDX-License-Identifier: Apache-2.0
//
// Signal handlers of traps. They run with all signals blocked.
#include <cerrno>
#include <csignal>

#include "program_signals.hpp"
#include "trapped_window.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#include <sys/uio.h>
#include <ucontext.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

#include <rths/card/bits.hpp>
#include <rths/card/registers.hpp>

namespace rths::scramnet {
namespace {

constexpr greg_t kTrapFlag = 0x100;
constexpr greg_t kWriteFault = 0x2;  // of the error code
constexpr std::size_t kLongestStore = 64;
constexpr std::uint64_t kAvxState = 0x4;  // bit of the extended state
constexpr std::array<int, 16> kGeneral{REG_RAX, REG_RCX, REG_RDX, REG_RBX, REG_RSP, REG_RBP,
                                       REG_RSI, REG_RDI, REG_R8,  REG_R9,  REG_R10, REG_R11,
                                       REG_R12, REG_R13, REG_R14, REG_R15};

CpuState state_of(const mcontext_t& context) {
  CpuState cpu;
  for (std::size_t i = 0; i < kGeneral.size(); ++i)
    cpu.general[i] = static_cast<std::uint64_t>(context.gregs[kGeneral[i]]);
  cpu.flags = static_cast<std::uint64_t>(context.gregs[REG_EFL]);
  cpu.next = static_cast<std::uint64_t>(context.gregs[REG_RIP]);
  return cpu;
}

void set_state(const CpuState& cpu, mcontext_t& context) {
  for (std::size_t i = 0; i < kGeneral.size(); ++i)
    context.gregs[kGeneral[i]] = static_cast<greg_t>(cpu.general[i]);
  context.gregs[REG_EFL] = static_cast<greg_t>(cpu.flags);
  context.gregs[REG_RIP] = static_cast<greg_t>(cpu.next);
}

/// The instruction's bytes. Those of the next page are read by the kernel, since it may not be
/// there.
struct CodeAtTrap {
  std::array<std::uint8_t, kLongestInstruction> bytes{};
  std::size_t length = 0;

  explicit CodeAtTrap(std::uint64_t address) {
    const std::size_t here = std::min(kLongestInstruction, kTrapPage - address % kTrapPage);
    // Addresses are those of the program that was trapped.
    std::memcpy(bytes.data(), reinterpret_cast<const void*>(address), here);  // NOLINT
    length = here;
    if (here == kLongestInstruction) return;
    const iovec to{bytes.data() + here, kLongestInstruction - here};
    const iovec from{reinterpret_cast<void*>(address + here),  // NOLINT
                     kLongestInstruction - here};
    const ssize_t more = process_vm_readv(getpid(), &to, 1, &from, 1, 0);
    if (more > 0) length += static_cast<std::size_t>(more);
  }
};

std::uint32_t ymm_begin = 0;  // of the upper halves in the extended state [B]; 0: no AVX

// Bytes of a vector register, as the kernel has saved it.
bool read_vector(const mcontext_t& context, const StoreInstruction& store, std::uint8_t* to) {
  if (context.fpregs == nullptr) return false;
  const auto* const area = reinterpret_cast<const std::uint8_t*>(context.fpregs);
  std::array<std::uint8_t, 32> whole{};
  std::memcpy(whole.data(), &context.fpregs->_xmm[store.source], 16);
  if (store.vector_begin + store.width > 16) {
    constexpr std::size_t kSoftwareBytes = 464, kHeader = 512;
    std::uint32_t magic = 0;
    std::memcpy(&magic, area + kSoftwareBytes, sizeof magic);
    if (magic != FP_XSTATE_MAGIC1 || ymm_begin == 0) return false;
    std::uint64_t present = 0;  // others have their initial value, zero
    std::memcpy(&present, area + kHeader, sizeof present);
    if ((present & kAvxState) != 0)
      std::memcpy(whole.data() + 16, area + ymm_begin + std::size_t{16} * store.source, 16);
  }
  std::memcpy(to, whole.data() + store.vector_begin, store.width);
  return true;
}

// Elements of a string instruction up to the end of the faulting page, 64 bytes at a time. Whole
// longwords are stored as such.
bool make_string(StoreInstruction store, std::uintptr_t page_end, CpuState& cpu) {
  const std::uint64_t instruction = cpu.next;
  bool made = false;
  do {
    const std::uint64_t most = ascends(cpu) ? kLongestStore / store.width : 1;
    const std::uint64_t elements = std::min(elements_left(store, cpu), most);
    const std::uint64_t length = elements * store.width;
    const auto at = trapped_window.find(store.address, length);
    if (!at) break;
    std::array<std::uint8_t, kLongestStore> value{};
    for (std::uint64_t i = 0; i < length; ++i)
      value[i] = static_cast<std::uint8_t>(store.operand >> 8 * (i % store.width));
    if (store.kind == StoreKind::Copy)
      std::memcpy(value.data(), trapped_window.readable(store.operand, length), length);
    trapped_window.store(*at, {value.data(), length});
    made = true;
    advance(store, elements, cpu);
    store.address += length;
    if (store.kind == StoreKind::Copy) store.operand += length;
  } while (cpu.next == instruction && ascends(cpu) && store.address < page_end);
  return made;
}

bool make_store(const StoreInstruction& store, std::uintptr_t fault, const mcontext_t& context,
                CpuState& cpu) {
  if (fault < store.address || fault >= store.address + store.width) return false;
  if (store.kind == StoreKind::Fill || store.kind == StoreKind::Copy)
    return make_string(store, fault / kTrapPage * kTrapPage + kTrapPage, cpu);
  const auto at = trapped_window.find(store.address, store.width);
  if (!at) return false;
  if (store.reads_memory()) {
    ReadModifyWrite result;
    const std::uint64_t before = trapped_window.modify(*at, store, cpu, result);
    finish(store, before, result, cpu);
    return true;
  }
  std::array<std::uint8_t, kLongestStore> value{};
  if (store.kind == StoreKind::Vector) {
    if (!read_vector(context, store, value.data())) return false;
  } else {
    std::memcpy(value.data(), &store.operand, store.width);
  }
  trapped_window.store(*at, {value.data(), store.width});
  finish(store, 0, {}, cpu);
  return true;
}

/// An instruction of this thread that is executed with the page open.
struct Step {
  bool active = false;
  std::uint64_t at = 0;  ///< offset in the window of the longwords that are compared
  std::uint32_t count = 0;
  std::optional<std::uint32_t> first;  ///< entry
  std::array<std::uint32_t, kLongestTrap> before{};
  std::array<std::uint64_t, 2> pages{};  ///< that are open
  sigset_t mask{};
};
// Without the model, the first use in a thread could allocate.
thread_local Step step __attribute__((tls_model("initial-exec")));

void begin_step(std::uint64_t at, ucontext_t& context) {
  step.active = true;
  if (trapped_window.is_hidden(at)) trapped_window.reveal(at);
  step.at = at / 4 * 4;
  step.count = static_cast<std::uint32_t>(
      std::min<std::uint64_t>(kLongestTrap, (trapped_window.bytes.load() - step.at) / 4));
  step.first = trapped_window.announce_words(step.at, step.count);
  const auto* const words = reinterpret_cast<const Word*>(trapped_window.memory.load() + step.at);
  for (std::uint32_t i = 0; i < step.count; ++i) step.before[i] = words[i].load();
  step.pages = {at, at};
  step.mask = context.uc_sigmask;
  sigfillset(&context.uc_sigmask);
  sigdelset(&context.uc_sigmask, SIGTRAP);
  sigdelset(&context.uc_sigmask, SIGSEGV);
  context.uc_mcontext.gregs[REG_EFL] |= kTrapFlag;
  trapped_window.open_page(at);
}

// The page is open for all threads meanwhile, so a difference may be another thread's.
void end_step(ucontext_t& context) {
  context.uc_mcontext.gregs[REG_EFL] &= ~kTrapFlag;
  context.uc_sigmask = step.mask;
  for (const std::uint64_t page : step.pages) trapped_window.close_page(page);
  step.active = false;
  if (!step.first) return;
  auto* const words = reinterpret_cast<Word*>(trapped_window.memory.load() + step.at);
  const bool withheld = trapped_window.withholds();
  TrapQueue& queue = trapped_window.card.load()->carried.traps;
  for (std::uint32_t i = 0; i < step.count; ++i) {
    const std::uint32_t now = words[i].load();
    if (withheld) words[i].store(step.before[i]);
    const std::uint32_t form = now == step.before[i] ? 0 : 4 | (withheld ? 0 : kTrapInMemory);
    publish(queue, *step.first + i, form, now);
  }
}

// @returns false if it is neither a store to a closed page nor a load from a hidden one
bool take_fault(const siginfo_t& info, ucontext_t& context) {
  const auto fault = reinterpret_cast<std::uintptr_t>(info.si_addr);
  if (info.si_code != SEGV_ACCERR) return false;
  const auto at = trapped_window.find(fault, 1);
  if (!at) return false;
  if ((context.uc_mcontext.gregs[REG_ERR] & kWriteFault) == 0) {
    trapped_window.reveal(*at);
    return true;
  }
  if (trapped_window.shows_acr.load()) return true;  // since a moment ago: tries again
  if (step.active) {                                 // the instruction stores to two pages
    step.pages[1] = *at;
    trapped_window.open_page(*at);
    return true;
  }
  CpuState cpu = state_of(context.uc_mcontext);
  const CodeAtTrap code{cpu.next};
  const auto store = decode_store({code.bytes.data(), code.length}, cpu);
  if (store && make_store(*store, fault, context.uc_mcontext, cpu)) {
    set_state(cpu, context.uc_mcontext);
    return true;
  }
  begin_step(*at, context);
  return true;
}

void on_fault(int signal, siginfo_t* info, void* context) {
  const int before = errno;
  auto& state = *static_cast<ucontext_t*>(context);
  if (!take_fault(*info, state)) {
    if (step.active) end_step(state);
    errno = before;
    return pass_on(signal, info, context);
  }
  errno = before;
}

void on_step(int signal, siginfo_t* info, void* context) {
  const int before = errno;
  if (!step.active) return pass_on(signal, info, context);
  end_step(*static_cast<ucontext_t*>(context));
  errno = before;
}

// Place of the upper halves of YMM registers in the extended state.
std::uint32_t find_ymm() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  constexpr unsigned kExtendedState = 0xD, kAvx = 2;
  return __get_cpuid_count(kExtendedState, kAvx, &a, &b, &c, &d) != 0 && a != 0 ? b : 0;
}

}  // namespace

void handle_traps() noexcept {
  ymm_begin = find_ymm();
  handle_faults(on_fault, on_step);
}

}  // namespace rths::scramnet

#else

namespace rths::scramnet {
void handle_traps() noexcept {}
}  // namespace rths::scramnet

#endif
