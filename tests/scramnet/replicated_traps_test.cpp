// SPDX-License-Identifier: Apache-2.0
//
// Stores of this process through its pointer, on pages that are trapped: each has its effect, with
// its order, value, width and number.
#include <csetjmp>
#include <csignal>
#include <cstring>
#include <thread>

#include <sys/wait.h>

#include <rths/broker/follow.hpp>

#include "replicated_card.hpp"

namespace rths::test {
namespace {

#if defined(__x86_64__)

/// The page is trapped. The watcher queues an interrupt for each message.
class ReplicatedTraps : public ReplicatedCard {
 protected:
  void SetUp() override {
    if (!trapped()) GTEST_SKIP() << "SKIPPED: traps are off";
    ReplicatedCard::SetUp();
    scr_acr_write(kWord, ACR_TIE);
    set_csr(SCR_CSR0, 0x8103);
    as_node("watcher", {"csr8=c00", "csr0=f000", "csr0=806b"});
  }
  void TearDown() override {
    if (!trapped()) return;
    scr_mclr_mm(ACR);
    set_csr(SCR_CSR2, 0xC040);
    set_csr(SCR_CSR0, 0x8003);
    settle();
  }
  static bool trapped() {
    const char* const value = std::getenv("RTHS_SCRAMNET_TRAPS");
    return value == nullptr || std::string{value} != "0";
  }
  static volatile std::uint32_t* words() { return get_base_mem(); }
  static char* bytes(std::uint32_t longword) {
    return reinterpret_cast<char*>(const_cast<std::uint32_t*>(get_base_mem() + longword));
  }
  /// Messages that the watcher's card has queued as interrupts.
  static std::uint32_t arrived() { return card_of("watcher").interrupt_fifo; }
  static bool arrives_exactly(std::uint32_t count) {
    const bool enough = soon([=] { return arrived() >= count; });
    settle();
    return enough && arrived() == count;
  }
};

TEST_F(ReplicatedTraps, SendEachStoreOfTheSameValue) {
  for (int i = 0; i < 1000; ++i) store(7);
  EXPECT_TRUE(arrives_exactly(1000)) << arrived();
  EXPECT_EQ(seen(), 7U);
  EXPECT_EQ(load(kWord), 7U);
}

TEST_F(ReplicatedTraps, SendEachOfManyValuesInTheirOrder) {
  std::vector<std::uint32_t> sent, found;
  auto follower = controllers_ring->follow("machine");
  for (std::uint32_t i = 0; i < 500; ++i) {
    sent.push_back(i % 3 * 1000 + i);  // words of both directions
    words()[kWord + (i % 2 == 0 ? i % 7 : 7 - i % 7)] = sent.back();
  }
  ASSERT_TRUE(arrives_exactly(500)) << arrived();
  broker::Write next;
  while (follower.next(next) == broker::Followed::Write) found.push_back(next.value);
  EXPECT_EQ(found, sent);
}

TEST_F(ReplicatedTraps, SendDataOfAnOpenPageBeforeTheirFlag) {
  scr_acr_write(kWord, 0);
  scr_acr_write(kWord, ACR_TIE);
  for (std::uint32_t i = 1; i < 200; ++i) {
    store(i, kWord + 1);
    store(i);
    ASSERT_TRUE(arrives(i));
    ASSERT_EQ(seen(kWord + 1), i);
  }
}

TEST_F(ReplicatedTraps, SendBytesAndHalvesWithTheirLongword) {
  store(0x1122'3344);
  bytes(kWord)[1] = static_cast<char>(0xAB);
  reinterpret_cast<volatile std::uint16_t*>(bytes(kWord))[1] = 0xCDEF;
  EXPECT_TRUE(arrives_exactly(3));
  EXPECT_EQ(seen(), 0xCDEF'AB44U);
  *reinterpret_cast<volatile std::uint64_t*>(bytes(kWord)) = 0x1122'3344'5566'7788;
  EXPECT_TRUE(arrives_exactly(5));
  EXPECT_EQ(seen(), 0x5566'7788U);
  EXPECT_EQ(seen(kWord + 1), 0x1122'3344U);
}

TEST_F(ReplicatedTraps, SendWhatInstructionsMakeOfAWord) {
  auto* const word = const_cast<std::uint32_t*>(get_base_mem() + kWord);
  store(5);
  asm volatile("addl $3, (%0)" : : "r"(word) : "memory", "cc");
  asm volatile("notl (%0)" : : "r"(word) : "memory");
  std::uint32_t value = 100;
  asm volatile("lock xaddl %0, (%1)" : "+r"(value) : "r"(word) : "memory", "cc");
  EXPECT_EQ(value, ~8U);
  EXPECT_EQ(load(kWord), 100 + ~8U);
  std::atomic_ref{*word}.exchange(1);
  EXPECT_TRUE(arrives_exactly(5)) << arrived();
  EXPECT_TRUE(arrives(1));
}

struct Record {
  std::uint32_t words[37];
};

TEST_F(ReplicatedTraps, SendMemsetMemcpyAndStructures) {
  Record record{};
  for (std::uint32_t i = 0; i < 37; ++i) record.words[i] = i * 0x0101'0101 + 9;
  *reinterpret_cast<Record*>(bytes(kWord)) = record;
  EXPECT_TRUE(arrives(record.words[36], kWord + 36));
  for (std::uint32_t i = 0; i < 37; ++i) EXPECT_EQ(seen(kWord + i), record.words[i]);
  std::memcpy(bytes(kWord + 1) + 1, &record, 101);
  for (std::uint32_t i = 0; i < 26; ++i) EXPECT_TRUE(arrives(load(kWord + i), kWord + i));
  std::memset(bytes(kWord), 0x5A, 119 * 4);
  EXPECT_TRUE(arrives(0x5A5A'5A5A, kWord + 118));
  for (std::uint32_t i = 0; i < 119; ++i) EXPECT_EQ(seen(kWord + i), 0x5A5A'5A5AU);
  EXPECT_EQ(std::memcmp(bytes(kWord), bytes(kWord + 1), 118 * 4), 0);
}

TEST_F(ReplicatedTraps, SendStringInstructionsAsLongwords) {
  void* to = bytes(kWord);
  std::size_t count = 40;
  asm volatile("rep stosb" : "+D"(to), "+c"(count) : "a"(0x33) : "memory");
  EXPECT_EQ(to, bytes(kWord + 10));
  EXPECT_EQ(count, 0U);
  EXPECT_TRUE(arrives_exactly(10)) << arrived();
  EXPECT_TRUE(arrives(0x3333'3333, kWord + 9));
}

// SETcc is not decoded: the page is open for one instruction.
TEST_F(ReplicatedTraps, SendTheStoresOfInstructionsThatTheyDoNotKnow) {
  for (std::uint32_t i = 0; i < 50; ++i) {
    store(0);
    asm volatile("test %%eax, %%eax; setz (%0)" : : "r"(bytes(kWord)), "a"(0) : "memory", "cc");
  }
  EXPECT_TRUE(arrives_exactly(100)) << arrived();
  EXPECT_EQ(seen(), 1U);
  store(6);
  EXPECT_TRUE(arrives_exactly(101));
}

TEST_F(ReplicatedTraps, SendEachStoreOfTwoThreads) {
  const auto store_often = [](std::uint32_t word) {
    for (std::uint32_t i = 1; i <= 250; ++i) {
      store(i, word);
      store(i, kWord);
    }
  };
  scr_acr_write(kWord + 1, ACR_TIE);
  scr_acr_write(kWord + 2, ACR_TIE);
  std::thread other{[&] { store_often(kWord + 1); }};
  store_often(kWord + 2);
  other.join();
  EXPECT_TRUE(arrives_exactly(1000)) << arrived();
  EXPECT_EQ(seen(kWord + 1), 250U);
  EXPECT_EQ(seen(kWord + 2), 250U);
  EXPECT_EQ(seen(), load(kWord));
}

TEST_F(ReplicatedTraps, SendEachAdditionOfTwoThreads) {
  auto* const word = const_cast<std::uint32_t*>(get_base_mem() + kWord);
  const auto add_often = [=] {
    for (int i = 0; i < 400; ++i) std::atomic_ref{*word}.fetch_add(1);
  };
  std::thread other{add_often};
  add_often();
  other.join();
  EXPECT_EQ(load(kWord), 800U);
  EXPECT_TRUE(arrives_exactly(800)) << arrived();
}

TEST_F(ReplicatedTraps, SendHalvesOfAHiproWordOnceBothAreWritten) {
  scr_acr_write(kWord, ACR_TIE | ACR_HIPRO);
  set_csr(SCR_CSR2, 0xC040 | CSR2_HIPRO);
  auto* const halves = reinterpret_cast<volatile std::uint16_t*>(bytes(kWord));
  for (std::uint16_t i = 1; i <= 20; ++i) {
    halves[0] = i;
    settle();
    ASSERT_EQ(arrived(), i - 1U);
    halves[1] = i;
    ASSERT_TRUE(arrives_exactly(i));
    ASSERT_EQ(seen(), i * 0x1'0001U);
  }
}

TEST_F(ReplicatedTraps, ChangeTheOwnMemoryLastInWriteMeLast) {
  scr_wml_mm(NTW_WRT_HST);
  for (std::uint32_t i = 1; i <= 20; ++i) {
    store(i);
    ASSERT_EQ(load(kWord), i) << "a load waits until the message is back";
    ASSERT_EQ(seen(), i);  // the controller is before the machine on the way back
  }
  store(5, kWord + 9);
  EXPECT_TRUE(comes(kWord + 9, 5));
  EXPECT_TRUE(arrives(5, kWord + 9));
}

TEST_F(ReplicatedTraps, KeepTheOwnMemoryOnABrokenRingInWriteMeLast) {
  store(3);
  ASSERT_TRUE(arrives(3));
  scr_wml_mm(NTW_WRT_HST);
  replicated::Action fault;
  fault.kind = replicated::Action::Kind::CutFibre;
  fault.node = kControllerAt;
  replicated::request_fault(name(), fault);
  store(4);
  settle();
  usleep(5000);
  EXPECT_EQ(load(kWord), 3U);
  fault.kind = replicated::Action::Kind::RepairFibre;
  replicated::request_fault(name(), fault);
  store(5);
  EXPECT_TRUE(comes(kWord, 5));
}

TEST_F(ReplicatedTraps, WithholdStoresFromTheOwnMemoryWithHostWritesOff) {
  store(3);
  store(0, kWord + 1);
  ASSERT_TRUE(arrives(0, kWord + 1));
  set_csr(SCR_CSR2, 0xC040 | CSR2_DHMW);
  store(4);
  asm volatile("test %%eax, %%eax; setz (%0)" : : "r"(bytes(kWord + 1)), "a"(0) : "memory", "cc");
  EXPECT_TRUE(arrives(4));
  EXPECT_TRUE(arrives(1, kWord + 1));
  EXPECT_EQ(load(kWord), 3U);
  EXPECT_EQ(load(kWord + 1), 0U);
}

TEST_F(ReplicatedTraps, SendBlockCallsOnce) {
  std::uint32_t block[20];
  for (std::uint32_t i = 0; i < 20; ++i) block[i] = 70 + i;
  EXPECT_EQ(scr_dma_write(block, 4 * kWord, sizeof block), 0);
  EXPECT_EQ(WriteSCRLong(kWord, 70), 1);
  EXPECT_EQ(WriteSCRByte(4 * kWord, 71), 1);
  EXPECT_TRUE(arrives_exactly(22)) << arrived();
  EXPECT_TRUE(arrives(89, kWord + 19));
  EXPECT_EQ(seen(), 71U);
}

TEST_F(ReplicatedTraps, EndWithTheReasonForThem) {
  ASSERT_EQ(sp_set_vp(VP_SET, kOwnPage), static_cast<int>(kOwnPage));
  store(3);
  scr_acr_write(kWord, 0);
  store(3);  // the present value: found by no scan
  store(4);
  EXPECT_TRUE(arrives(4, kOwnPage * kPage + kWord));
  EXPECT_TRUE(arrives_exactly(2)) << arrived();
  EXPECT_EQ(sp_set_vp(VP_RESET, 0), 0);
}

TEST_F(ReplicatedTraps, StayOnAPageWithWordsOfOthers) {
  scr_acr_write(kWord, 0);
  store(3);
  store(3);
  EXPECT_TRUE(arrives_exactly(2)) << arrived();
}

TEST_F(ReplicatedTraps, SendStoresIntoWordsOfOthers) {
  store(5, kOther);      // a word of the controller
  store(6, kPage - 20);  // a word without an owner
  EXPECT_TRUE(arrives_exactly(2)) << arrived();
  EXPECT_EQ(seen(kOther), 5U);
  EXPECT_EQ(seen(kPage - 20), 6U);
  write(kOther, 7);
  EXPECT_TRUE(comes(kOther, 7));
}

TEST_F(ReplicatedTraps, LetACallReadIntoThePageFail) {
  int ends[2];
  ASSERT_EQ(pipe(ends), 0);
  ASSERT_EQ(::write(ends[1], "abcd", 4), 4);
  EXPECT_EQ(read(ends[0], bytes(kWord), 4), -1);
  EXPECT_EQ(errno, EFAULT);
  close(ends[0]);
  close(ends[1]);
}

/// Runs in a child, which ends by a signal or with an exit status.
template <class Act>
int status_of_child(Act act) {
  const pid_t child = fork();
  if (child == 0) {
    act();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return status;
}

volatile int* const nowhere = reinterpret_cast<volatile int*>(16);

#ifdef RTHS_SANITIZED
constexpr bool kCrashesAreReported = true;  // by the sanitizer's own handler
#else
constexpr bool kCrashesAreReported = false;
#endif

TEST_F(ReplicatedTraps, LeaveACrashACrash) {
  if (kCrashesAreReported) GTEST_SKIP() << "SKIPPED: the sanitizer handles crashes";
  const int status = status_of_child([] { *nowhere = 1; });
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(WTERMSIG(status), SIGSEGV);
  const int sent = status_of_child([] { raise(SIGSEGV); });
  ASSERT_TRUE(WIFSIGNALED(sent));
  EXPECT_EQ(WTERMSIG(sent), SIGSEGV);
}

TEST_F(ReplicatedTraps, ServeAChildProcess) {
  EXPECT_EQ(status_of_child([] { store(9); }), 0);
  EXPECT_TRUE(arrives_exactly(1)) << arrived();
  EXPECT_EQ(seen(), 9U);
}

sigjmp_buf before_fault;
void return_from_fault(int) { siglongjmp(before_fault, 1); }
void end_in_order(int, siginfo_t* info, void*) {
  _exit(info->si_addr == const_cast<int*>(nowhere) ? 42 : 43);
}

TEST_F(ReplicatedTraps, LeaveTheProgramItsOwnHandler) {
  if (kCrashesAreReported) GTEST_SKIP() << "SKIPPED: the sanitizer handles crashes";
  struct sigaction own {};
  struct sigaction before {};
  own.sa_sigaction = end_in_order;
  own.sa_flags = SA_SIGINFO;
  const int status = status_of_child([&] {
    if (sigaction(SIGSEGV, &own, &before) != 0 || before.sa_handler != SIG_DFL) _exit(1);
    store(9);
    *nowhere = 1;
  });
  EXPECT_EQ(WEXITSTATUS(status), 42);
  EXPECT_TRUE(arrives(9));
  const int jumped = status_of_child([] {
    std::signal(SIGSEGV, return_from_fault);
    for (int i = 0; i < 3; ++i)
      if (sigsetjmp(before_fault, 1) == 0) *nowhere = 1;
    store(10);
    _exit(7);
  });
  EXPECT_EQ(WEXITSTATUS(jumped), 7);
  EXPECT_TRUE(arrives(10));
}

TEST_F(ReplicatedTraps, WorkInAHandlerAndAThreadThatBlockAllSignals) {
  struct sigaction own {};
  struct sigaction before {};
  own.sa_handler = [](int) { store(11); };
  sigfillset(&own.sa_mask);
  sigaction(SIGUSR2, &own, &before);
  raise(SIGUSR2);
  sigaction(SIGUSR2, &before, nullptr);
  EXPECT_TRUE(arrives(11));
  sigset_t all, old;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &old);
  store(12);
  pthread_sigmask(SIG_SETMASK, &old, nullptr);
  EXPECT_TRUE(arrives(12));
}

#endif

}  // namespace
}  // namespace rths::test
