// SPDX-License-Identifier: Apache-2.0
//
// Interrupts of the vendor's calls of this process on a replicated ring.
#include <csignal>

#include <atomic>

#include "replicated_card.hpp"

namespace rths::test {
namespace {

std::atomic<int> signals{0};
void count_signal(int) { ++signals; }

constexpr std::int64_t address_of(std::uint32_t longword) { return std::int64_t{4} * longword; }

TEST_F(ReplicatedCard, ArmsOnAnyWriteOfCsr1) {
  set_csr(SCR_CSR1, 0);
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_IARM, CSR1_IARM);
}

// The card's own messages interrupt it, so that they show the outgoing bit.
TEST_F(ReplicatedCard, FollowsTheRuleOfTheOutgoingInterruptBit) {
  std::uint32_t value = 0;
  for (int bits = 0; bits < 8; ++bits) {
    const bool tie = (bits & 1) != 0, otf = (bits & 2) != 0, nie = (bits & 4) != 0;
    scr_acr_write(kWord, static_cast<unsigned char>(ACR_RIE | (tie ? ACR_TIE : 0)));
    set_csr(SCR_CSR2, 0xC640);
    set_csr(SCR_CSR0, 0x8023 | (otf ? CSR0_OTF : 0) | (nie ? CSR0_NIE : 0));
    store(++value);
    ASSERT_TRUE(arrives(value));
    settle();
    EXPECT_EQ(interrupt(), nie && (otf || tie) ? address_of(kWord) : -1) << bits;
    EXPECT_EQ(interrupt(), -1) << bits;
  }
}

TEST_F(ReplicatedCard, FollowsTheRuleOfAcceptance) {
  std::uint32_t value = 0;
  add_to_csr(SCR_CSR8, 0x400);
  for (int bits = 0; bits < 8; ++bits) {
    const bool rie = (bits & 1) != 0, orf = (bits & 2) != 0, imme = (bits & 4) != 0;
    scr_acr_write(kOther, static_cast<unsigned char>(rie ? ACR_RIE : 0));
    set_csr(SCR_CSR0, 0x8003 | (orf ? CSR0_ORF : 0) | (imme ? CSR0_MME : 0));
    write(kOther, ++value);
    ASSERT_TRUE(comes(kOther, value));
    settle();
    EXPECT_EQ(interrupt(), imme && (orf || rie) ? address_of(kOther) : -1) << bits;
  }
}

TEST_F(ReplicatedCard, IsInterruptedByItsOwnStoresWithBothBitsOnly) {
  std::uint32_t value = 0;
  for (int bits = 0; bits < 4; ++bits) {
    set_csr(SCR_CSR2, 0xC040 | bits << 9);
    set_csr(SCR_CSR0, 0x8363);
    store(++value);
    ASSERT_TRUE(arrives(value));
    settle();
    EXPECT_EQ(interrupt(), bits == 3 ? address_of(kWord) : -1) << bits;
  }
}

TEST_F(ReplicatedCard, GivesTheAddressesOfInterruptsInOrderOfArrival) {
  take_all_interrupts();
  const std::uint32_t words[] = {kOther + 9, kOther, kOther + 100, kOther};
  std::uint32_t value = 0;
  for (const std::uint32_t word : words) write(word, ++value);
  ASSERT_TRUE(soon([] { return queued() == 4; }));
  for (const std::uint32_t word : words) EXPECT_EQ(interrupt(), address_of(word));
  unsigned untouched = 5;
  EXPECT_EQ(scr_read_int_fifo(&untouched), 0);
  EXPECT_EQ(untouched, 5U);
}

// CSR5 shows that a message was a repetition; its address has no mark of it.
TEST_F(ReplicatedCard, GivesTheAddressesOfRepeatedMessages) {
  replicated::Action fault;
  fault.kind = replicated::Action::Kind::BitErrorRate;
  fault.rate = 2e-3;
  scr_acr_write(kWord, ACR_RIE | ACR_TIE);
  set_csr(SCR_CSR2, 0x4640);
  set_csr(SCR_CSR0, 0x812B);
  replicated::request_fault(name(), fault);
  int marked = 0, taken = 0;
  const bool are_repeated = soon([&, value = 0U]() mutable {
    store(++value);
    settle();
    for (; (csr(SCR_CSR5) & CSR5_IFE) != 0; ++taken) {
      marked += (csr(SCR_CSR5) & CSR5_RB) != 0 ? 1 : 0;
      EXPECT_EQ(interrupt(), address_of(kWord));
    }
    return marked >= 3;
  });
  fault.rate = 0;
  replicated::request_fault(name(), fault);
  settle();
  EXPECT_TRUE(are_repeated) << marked << " of " << taken;
}

TEST_F(ReplicatedCard, FillsItsInterruptFifoAndKeepsTheOldestEntries) {
  take_all_interrupts();
  std::uint32_t written = 0;
  const auto write_until = [&](std::uint32_t count) {
    for (; written < count; ++written) write(kOther + written % kOthers, written + 1);
  };
  write_until(1023);
  ASSERT_TRUE(soon([] { return queued() == 1023; }));
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_INTFF, 0);
  write_until(1100);
  ASSERT_TRUE(comes(kOther + 1099 % kOthers, 1100));
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_INTFF, CSR1_INTFF);
  settle();
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_INTFF, CSR1_INTFF);  // still full
  for (std::uint32_t i = 0; i < 1023; ++i) ASSERT_EQ(interrupt(), address_of(kOther + i % kOthers));
  EXPECT_EQ(interrupt(), address_of(kOther + 1099 % kOthers));
  EXPECT_EQ(interrupt(), -1);
}

TEST_F(ReplicatedCard, IsInterruptedOncePerArming) {
  const std::uint32_t before = card_of("machine").host_interrupts;
  take_all_interrupts();
  for (std::uint32_t i = 1; i <= 3; ++i) write(kOther, i);
  ASSERT_TRUE(soon([] { return queued() == 3; }));
  EXPECT_EQ(card_of("machine").host_interrupts, before + 1);
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_IARM, 0);
  set_csr(SCR_CSR1, 0);  // entries are left
  EXPECT_EQ(card_of("machine").host_interrupts, before + 2);
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_IARM, 0);
  unsigned delivered = 0;
  EXPECT_EQ(ioctl(scr_csr_fd, WAIT_INTERRUPT, &delivered), 0);  // came before the call
  EXPECT_GE(delivered, 2U);
}

TEST_F(ReplicatedCard, LosesNoInterruptBetweenTheEmptyFifoAndArming) {
  take_all_interrupts();
  write(kOther, 1);
  ASSERT_TRUE(soon([] { return queued() == 1; }));
  EXPECT_EQ(interrupt(), address_of(kOther));
  EXPECT_EQ(interrupt(), -1);
  write(kOther, 2);  // comes before the host arms
  ASSERT_TRUE(soon([] { return queued() == 1; }));
  const std::uint32_t before = card_of("machine").host_interrupts;
  set_csr(SCR_CSR1, 0);
  EXPECT_EQ(card_of("machine").host_interrupts, before + 1);
}

TEST_F(ReplicatedCard, HasTheDataOfAnInterruptBeforeItsEntry) {
  take_all_interrupts();
  for (std::uint32_t i = 1; i <= 50; ++i) {
    write(kOther, i);
    ASSERT_TRUE(soon([] { return interrupt() >= 0; }));
    EXPECT_EQ(load(kOther), i);
  }
}

TEST_F(ReplicatedCard, SignalsOnlyARegisteredProcess) {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = count_signal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGUSR1, &action, &before);
  signals = 0;
  take_all_interrupts();
  write(kOther, 1);
  ASSERT_TRUE(soon([] { return queued() == 1; }));
  settle();
  EXPECT_EQ(signals, 0);

  EXPECT_EQ(ioctl(scr_csr_fd, INTSIG, SET_SIG), 0);
  set_csr(SCR_CSR1, 0);
  EXPECT_TRUE(soon([] { return signals == 1; }));
  EXPECT_EQ(ioctl(scr_csr_fd, INTSIG, CLR_SIG), 0);
  set_csr(SCR_CSR1, 0);
  settle();
  EXPECT_EQ(signals, 1);
  sigaction(SIGUSR1, &before, nullptr);
}

TEST_F(ReplicatedCard, ShowsAnEmptyFifoAtAnErrorInterrupt) {
  replicated::Action fault;
  fault.kind = replicated::Action::Kind::BitErrorRate;
  fault.rate = 1;
  set_csr(SCR_CSR9, CSR9_BM);
  set_csr(SCR_CSR0, 0x808B);
  settle();
  static_cast<void>(csr(SCR_CSR1));
  set_csr(SCR_CSR1, 0);
  const std::uint32_t before = card_of("machine").host_interrupts;
  replicated::request_fault(name(), fault);
  write(kOther, 4711);
  EXPECT_TRUE(soon([=] { return card_of("machine").host_interrupts == before + 1; }));
  fault.rate = 0;
  replicated::request_fault(name(), fault);
  EXPECT_EQ(csr(SCR_CSR5) & CSR5_IFE, 0);
  EXPECT_EQ(csr(SCR_CSR1) & CSR1_BM, CSR1_BM);
  EXPECT_NE(load(kOther), 4711U);
}

}  // namespace
}  // namespace rths::test
