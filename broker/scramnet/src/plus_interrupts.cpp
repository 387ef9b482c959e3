// SPDX-License-Identifier: Apache-2.0
//
// Vendor's calls: auxiliary control RAM, interrupt FIFO, and ioctl on the card's descriptors.
#include <poll.h>
#include <sys/prctl.h>

#include <cerrno>
#include <csignal>
#include <cstring>

#include "plus_state.hpp"

#include <scrplus.h>

#include <rths/card/fifo.hpp>
#include <rths/card/interrupts.hpp>

using namespace rths::scramnet;

namespace {

constexpr unsigned char kNoAcr = 0xFF;

int fail_with(int error) {
  errno = error;
  return -1;
}

/// Makes this thread's sleeps exact during its lifetime, instead of up to 50 µs late.
class ExactSleep {
 public:
  ExactSleep() : before_{prctl(PR_GET_TIMERSLACK)} { prctl(PR_SET_TIMERSLACK, 1000UL); }
  ~ExactSleep() { prctl(PR_SET_TIMERSLACK, static_cast<unsigned long>(before_)); }
  ExactSleep(const ExactSleep&) = delete;
  ExactSleep& operator=(const ExactSleep&) = delete;

 private:
  int before_;
};

// Scans, then sleeps for a period with the caller's signal mask, so that no signal is missed
// between scan and sleep. Waits without a deadline, as the vendor's call does.
int wait_for_interrupt(Board& card, unsigned* count) {
  const ExactSleep exact;
  sigset_t all;
  sigset_t callers;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &callers);
  int result = 0;
  for (;;) {
    card.scanner().scan();
    if (const unsigned delivered = card.take_interrupts(); delivered != 0) {
      if (count != nullptr) *count = delivered;
      break;
    }
    const timespec period{0, Scanner::kPeriodNs};
    if (ppoll(nullptr, 0, &period, &callers) < 0) {
      result = fail_with(EINTR);
      break;
    }
  }
  pthread_sigmask(SIG_SETMASK, &callers, nullptr);
  return result;
}

int signal_registration(Board& card, int argument) {
  if (argument == CLR_SIG)
    remove_registration(card.plus(), card.session().self());
  else if (!add_registration(card.plus(), card.session().self(), card.session().members()))
    return fail_with(EBUSY);
  card.update_thread();
  return 0;
}

}  // namespace

extern "C" {

void scr_acr_mm(int command) {
  if (Board* card = card_with_registers())
    card->change_csr(SCR_CSR0, command == MAP ? CSR0_IME : 0U, CSR0_IME);
}

unsigned char scr_acr_read(unsigned long longword) {
  Board* card = card_with_memory();
  if (card == nullptr || longword >= card->window_bytes() / 4) return kNoAcr;
  return static_cast<unsigned char>(card->acr()[longword].load() & ACR_MASK);
}

void scr_acr_write(unsigned long longword, unsigned char value) {
  Board* card = card_with_memory();
  if (card == nullptr || longword >= card->window_bytes() / 4) return;
  card->write_acr(static_cast<std::uint32_t>(longword), value);
}

int scr_read_int_fifo(void* byte_address) {
  Board* card = card_with_registers();
  if (card == nullptr) return 0;
  card->scanner().scan();
  const auto address = pop(card->plus().fifo);
  if (!address) return 0;
  const std::uint32_t value = *address & ~3U;  // the lower bits are marks
  std::memcpy(byte_address, &value, sizeof value);
  return 1;
}

void scr_fifo_mm(int command, struct rd_fifo* fifo) {
  Board* card = card_with_registers();
  if (card == nullptr) return;
  if (command == RST_FIFO) {
    card->change_csr(SCR_CSR0, CSR0_RTRF | CSR0_RIF | CSR0_RSMF, 0);
    card->change_csr(SCR_CSR0, 0, CSR0_RTRF | CSR0_RIF | CSR0_RSMF);
  }
  if (command != RD_FIFO) return;
  const unsigned csr5 = card->read_csr(SCR_CSR5);
  fifo->mt_flag = (csr5 & CSR5_IFE) != 0 ? 0 : 1;
  if (fifo->mt_flag == 0) {
    fifo->ntr_fifo[0] = static_cast<unsigned short>(csr5 & ~static_cast<unsigned>(CSR5_IFE));
    fifo->ntr_fifo[1] = static_cast<unsigned short>(card->read_csr(SCR_CSR4));
    return;
  }
  const unsigned csr1 = fifo->ntr_addr = card->read_csr(SCR_CSR1);
  char* const flags[] = {&fifo->smff, &fifo->smfne, &fifo->smfhf, &fifo->rtff, &fifo->iff,
                         &fifo->smfs, &fifo->cd,    &fifo->bb,    &fifo->rxo};
  for (unsigned bit = 0; bit < 9; ++bit) *flags[bit] = (csr1 >> bit & 1) != 0 ? 1 : 0;
}
}

namespace rths::scramnet {

int control_card(unsigned long command, void* argument) noexcept {
  Board* card = board();
  if (card == nullptr) return fail_with(ENODEV);
  const int value = static_cast<int>(reinterpret_cast<std::intptr_t>(argument));
  switch (command) {
    case INTSIG:
      return signal_registration(*card, value);
    case FLUSHSIG:
      remove_all_registrations(card->plus());
      card->update_thread();
      return 0;
    case WAIT_INTERRUPT:
      return wait_for_interrupt(*card, static_cast<unsigned*>(argument));
    case SCR_LNK:
      return scr_lnk_mm(value), 0;
    case TX_INT:
    case RX_INT:
    case INT_ERR:
      return scr_int_mm(static_cast<int>(command), value), 0;
    case NTW_WRT_HST:
      return scr_wml_mm(value), 0;
    case DATA_FLT:
      return scr_dfltr_mm(value), 0;
    case RW_CSR:
      return scr_rw_mm(static_cast<struct rw_scr*>(argument)), 0;
    case RST_FIFO:
    case RD_FIFO:
      return scr_fifo_mm(static_cast<int>(command), static_cast<struct rd_fifo*>(argument)), 0;
    case AUX_RAM_LNK:
      return scr_acr_mm(value), 0;
    case BYTE_SWP:
      return 0;
    default:
      return fail_with(EINVAL);
  }
}

}  // namespace rths::scramnet
