// SPDX-License-Identifier: Apache-2.0
//
// Vendor's calls: registers.
#include <cstdio>

#include "plus_state.hpp"

#include <scrplus.h>

#include <rths/card/bits.hpp>

using namespace rths::scramnet;

namespace {

constexpr unsigned short kNothingThere = 0xFFFF;  // bus value if no card answers

// Calls that change a mode do nothing while the card's registers are not mapped.
void change(int csr, unsigned set, unsigned clear) {
  if (Board* card = card_with_registers()) card->change_csr(csr, set, clear);
}

void transmit_interrupts(bool off, int argument) {
  if (off) return change(SCR_CSR0, 0, CSR0_OTF | CSR0_NIE);
  const unsigned all = (argument & INTALL) != 0 ? CSR0_OTF : 0U;
  change(SCR_CSR0, 0x8103U | all, CSR0_OTF);
}

void receive_interrupts(bool off, int argument) {
  if (off) {
    change(SCR_CSR0, 0, CSR0_ORF | CSR0_MME | CSR0_HIE);
    return change(SCR_CSR2, 0, CSR2_ISEN);
  }
  const unsigned all = (argument & INTALL) != 0 ? CSR0_ORF : 0U;
  if ((argument & INTOWN) != 0) change(SCR_CSR2, CSR2_WOS | CSR2_ISEN, 0);
  change(SCR_CSR0, 0x802BU | all, CSR0_ORF);
}

}  // namespace

extern "C" {

unsigned short scr_csr_read(int csr) {
  Board* card = card_with_registers();
  return card == nullptr ? kNothingThere : static_cast<unsigned short>(card->read_csr(csr));
}

void scr_csr_write(int csr, unsigned short value) {
  if (Board* card = card_with_registers()) card->write_csr(csr, value);
}

void scr_rw_mm(struct rw_scr* request) {
  const int csr = static_cast<unsigned char>(request->csr_reg);
  if (csr > SCR_CSR5) {
    std::fprintf(stderr, "scramnet: scr_rw_mm: register %d cannot be accessed\n", csr);
    return;
  }
  if (request->rw_flag == REG_RD) {
    request->csr_arg = scr_csr_read(csr);
  } else if (csr > SCR_CSR2) {
    std::fprintf(stderr, "scramnet: scr_rw_mm: register %d is read-only\n", csr);
  } else if (request->rw_flag == REG_MDFY) {
    Board* card = card_with_registers();
    const unsigned before = card == nullptr ? 0 : card->registers().peek(csr);
    scr_csr_write(csr, static_cast<unsigned short>(before | request->csr_arg));
  } else {
    scr_csr_write(csr, request->csr_arg);
  }
}

void scr_id_mm(void* id, void* count) {
  const unsigned short csr3 = scr_csr_read(SCR_CSR3);
  *static_cast<unsigned char*>(id) = static_cast<unsigned char>(csr3 >> 8);
  *static_cast<unsigned char*>(count) = static_cast<unsigned char>(csr3 & 0xFF);
}

// Also works while the card's registers are not mapped; does not map them.
void scr_reset_mm(void) {
  BoardError error{};
  Board* card = take_board(error);
  if (card == nullptr) return;
  card->write_csr(SCR_CSR0, 0x7000);
  card->write_csr(SCR_CSR0, 0);
  card->write_csr(SCR_CSR2, 0);
  card->clear_acr();
}

void scr_dfltr_mm(int filter) { change(SCR_CSR0, static_cast<unsigned>(filter), FLT_ALL); }

void scr_lnk_mm(int command) {
  constexpr unsigned kOnRing = CSR0_INSRT | CSR0_TXEN | CSR0_RXEN;
  if (command == RST_LNK) return change(SCR_CSR0, 0, kOnRing);
  if (command != SCR_LNK) return;
  change(SCR_CSR0, kOnRing, 0);
  change(SCR_CSR2, CSR2_DFOLB, CSR2_EWLB);
}

void scr_wml_mm(int command) {
  if (command == RST_NWH) change(SCR_CSR2, 0, CSR2_DHMW | CSR2_WOS);
  if (command == NTW_WRT_HST) change(SCR_CSR2, CSR2_DHMW | CSR2_WOS, 0);
}

int scr_fswin_mm(void) { return (scr_csr_read(SCR_CSR1) & CSR1_FOBN) == 0 ? 1 : 0; }

void scr_error_mm(FILE* to, unsigned short csr1) {
  static constexpr struct {
    unsigned bit;
    const char* text;
  } kErrors[] = {{CSR1_TXFF, "transmit FIFO is full"},
                 {CSR1_RTFF, "transceiver FIFO is full"},
                 {CSR1_INTFF, "interrupt FIFO is full"},
                 {CSR1_PV, "protocol violation"},
                 {CSR1_CD, "no carrier"},
                 {CSR1_BM, "bad message"},
                 {CSR1_RXO, "receiver overflow"},
                 {CSR1_TXRTY, "message repeated after an error"},
                 {CSR1_TXRTO, "message repeated after a time-out"}};
  for (const auto& error : kErrors)
    if ((csr1 & error.bit) != 0) std::fprintf(to, "%s\n", error.text);
}

// RST_INT takes precedence over SET_INT.
void scr_int_mm(int command, int argument) {
  const bool off = (argument & RST_INT) != 0;
  if (!off && (argument & SET_INT) == 0) return;
  if (command == TX_INT) transmit_interrupts(off, argument);
  if (command == RX_INT) receive_interrupts(off, argument);
  if (command == INT_ERR) change(SCR_CSR0, off ? 0U : CSR0_IOE | CSR0_HIE, off ? CSR0_IOE : 0U);
}
}
