// SPDX-License-Identifier: Apache-2.0
//
// Interrupts need a second card: another process that stores into words with TIE in its ACR.
#include <csignal>
#include <cstring>

#include "vendor_ring.hpp"

#include <scrplus.h>

namespace {

using rths::test::Running;

class Interrupts : public rths::test::VendorRing {
 protected:
  void SetUp() override {
    ASSERT_EQ(sp_scram_init(0), 0);
    scr_reset_mm();
    for (unsigned i = 0; i < 1200; ++i) get_base_mem()[i] = 0;
    scr_csr_write(SCR_CSR0, 0xF000);
  }
  void TearDown() override { ioctl(scr_csr_fd, FLUSHSIG); }

  void listen() {
    for (unsigned i = 0; i < 1200; ++i) scr_acr_write(i, ACR_RIE);
    scr_csr_write(SCR_CSR0, 0x812B);
    scr_csr_write(SCR_CSR1, 0);
  }
  /// Another card writes `count` words from `first` on, `period_us` apart.
  static void peer_writes(unsigned first, unsigned count, unsigned period_us = 0) {
    const auto done = Running{client("peer", {std::to_string(first), std::to_string(count),
                                              std::to_string(period_us)})}
                          .wait();
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }
};

TEST_F(Interrupts, GiveTheAddressesOfWordsThatOthersWrote) {
  listen();
  peer_writes(100, 3);

  std::uint64_t address = 0xABCD'0000'0000;
  std::memset(&address, 0, 4);
  for (unsigned i = 0; i < 3; ++i) {
    EXPECT_EQ(scr_read_int_fifo(&address), 1);
    EXPECT_EQ(address, 0xABCD'0000'0000 | (100 + i) * 4) << "only 32 bits are written";
    EXPECT_EQ(get_base_mem()[100 + i], i + 1);
  }
  EXPECT_EQ(scr_read_int_fifo(&address), 0);
  EXPECT_EQ(address, 0xABCD'0000'0000 | 102 * 4);
}

TEST_F(Interrupts, AreReadThroughCsr5ThenCsr4) {
  listen();
  peer_writes(300, 1);
  EXPECT_EQ(scr_csr_read(SCR_CSR5), CSR5_IFE);
  EXPECT_EQ(scr_csr_read(SCR_CSR4), 300 * 4);
  EXPECT_EQ(scr_csr_read(SCR_CSR5), 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR4), 0);
}

TEST_F(Interrupts, AreReadThroughTheFifoCall) {
  listen();
  peer_writes(300, 1);
  struct rd_fifo fifo = {};
  scr_fifo_mm(RD_FIFO, &fifo);
  EXPECT_EQ(fifo.mt_flag, 0);
  EXPECT_EQ(fifo.ntr_fifo[0], 0);
  EXPECT_EQ(fifo.ntr_fifo[1], 300 * 4);
  scr_fifo_mm(RD_FIFO, &fifo);
  EXPECT_EQ(fifo.mt_flag, 1);
  peer_writes(301, 1);
  static_cast<void>(scr_csr_read(SCR_CSR5));
  scr_fifo_mm(RST_FIFO, nullptr);
  EXPECT_EQ(scr_csr_read(SCR_CSR5), 0);
}

TEST_F(Interrupts, NeedReceiveAndTransmitInterruptEnable) {
  scr_csr_write(SCR_CSR0, 0x812B);
  scr_acr_write(50, ACR_RIE);
  scr_acr_write(51, ACR_TIE);
  peer_writes(50, 2);  // 51 has no RIE here
  unsigned address = 0;
  EXPECT_EQ(scr_read_int_fifo(&address), 1);
  EXPECT_EQ(address, 200U);
  EXPECT_EQ(scr_read_int_fifo(&address), 0);

  get_base_mem()[50] = 99;  // our own store
  scr_acr_write(50, ACR_RIE | ACR_TIE);
  get_base_mem()[60] = 1;  // no card has RIE or TIE there
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & 0x1FFF, 0);
}

TEST_F(Interrupts, OfOwnStoresMustBeEnabled) {
  for (const unsigned own : {0U, 0x600U}) {
    scr_csr_write(SCR_CSR2, static_cast<unsigned short>(0x4040 | own));
    scr_acr_write(2000, ACR_RIE | ACR_TIE);
    scr_csr_write(SCR_CSR0, 0x812B);
    get_base_mem()[2000] = get_base_mem()[2000] + 1;
    unsigned address = 0;
    EXPECT_EQ(scr_read_int_fifo(&address), own != 0 ? 1 : 0);
  }
}

TEST_F(Interrupts, FillTheFifoAndKeepTheOldestEntries) {
  listen();
  peer_writes(0, 1100);
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & CSR1_INTFF, CSR1_INTFF);
  unsigned address = 0;
  unsigned count = 0;
  while (scr_read_int_fifo(&address) == 1) {
    if (count < 1023) {
      EXPECT_EQ(address, count * 4);
    }
    ++count;
  }
  EXPECT_EQ(count, 1024U);
  EXPECT_EQ(address, 1099U * 4);
}

TEST_F(Interrupts, DisarmWhenDeliveredAndFireWhenRearmedWithEntriesLeft) {
  listen();
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & CSR1_IARM, CSR1_IARM);
  peer_writes(10, 2);
  unsigned count = 0;
  EXPECT_EQ(ioctl(scr_csr_fd, WAIT_INTERRUPT, &count), 0);
  EXPECT_GE(count, 1U);
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & CSR1_IARM, 0);
  unsigned address = 0;
  EXPECT_EQ(scr_read_int_fifo(&address), 1);
  scr_csr_write(SCR_CSR1, 0);  // one entry is left
  EXPECT_EQ(ioctl(scr_csr_fd, WAIT_INTERRUPT, &count), 0);
  EXPECT_EQ(scr_read_int_fifo(&address), 1);
  scr_csr_write(SCR_CSR1, 0);
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & CSR1_IARM, CSR1_IARM);
}

TEST_F(Interrupts, AllowSignalsToEndTheWait) {
  listen();
  struct sigaction action = {};
  struct sigaction before = {};
  action.sa_handler = [](int) {};
  sigaction(SIGALRM, &action, &before);
  ualarm(20'000, 0);
  EXPECT_EQ(ioctl(scr_csr_fd, WAIT_INTERRUPT, nullptr), -1);
  EXPECT_EQ(errno, EINTR);
  sigaction(SIGALRM, &before, nullptr);
}

TEST_F(Interrupts, SignalOnlyRegisteredProcesses) {
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &only, nullptr);
  const timespec timeout{5, 0};
  const timespec none{0, 0};
  ASSERT_EQ(ioctl(scr_csr_fd, INTSIG, SET_SIG), 0);
  listen();

  peer_writes(10, 1);
  EXPECT_EQ(sigtimedwait(&only, nullptr, &timeout), SIGUSR1);

  ASSERT_EQ(ioctl(scr_csr_fd, INTSIG, CLR_SIG), 0);
  unsigned address = 0;
  while (scr_read_int_fifo(&address) == 1) {
  }
  scr_csr_write(SCR_CSR1, 0);
  peer_writes(20, 1);
  EXPECT_EQ(scr_read_int_fifo(&address), 1);
  EXPECT_EQ(sigtimedwait(&only, nullptr, &none), -1);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
}

}  // namespace
