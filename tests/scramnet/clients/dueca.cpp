// SPDX-License-Identifier: Apache-2.0
//
// Modelled on DUECA's accessor: each node interrupts the others by storing into its own control
// word, and passes a number around the ring.
//   dueca NODE NODES ROUNDS wait|signal
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#define CONFIG_EXTERN extern
extern "C" {
#include <scramnet/scrplus.h>
extern int scr_csr_fd;
extern int scr_registers_mapped;
extern int scr_memory_mapped;
void scr_acr_write(unsigned long, unsigned char);
int scr_int_set(int mode);
}

int scr_int_set(int mode) { return ioctl(scr_csr_fd, INTSIG, mode); }

namespace {

bool set_up(unsigned node, unsigned nodes) {
  if (sp_scram_init(0) < 0 || scr_registers_mapped == 0 || scr_memory_mapped == 0) return false;
  scr_reset_mm();
  scr_mclr_mm(ACR);
  for (unsigned i = 0; i < nodes; ++i) scr_acr_write(i, i == node ? ACR_TIE : ACR_RIE);
  sp_net_to(16);
  scr_csr_write(SCR_CSR0, 0xF000);
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR2, 0x4040);
  static_cast<void>(scr_csr_read(SCR_CSR1));
  if ((scr_csr_read(SCR_CSR1) & 0x40) != 0) return false;
  scr_csr_write(SCR_CSR0, 0xF000);
  scr_csr_write(SCR_CSR0, 0x812b);
  scr_csr_write(SCR_CSR1, 0);
  return (scr_csr_read(SCR_CSR1) & 0x4000) != 0;
}

bool sleep_until_interrupt(bool by_signal) {
  scr_csr_write(SCR_CSR1, 0);
  if (!by_signal) {
    unsigned count = 0;
    return ioctl(scr_csr_fd, WAIT_INTERRUPT, &count) == 0;
  }
  sigset_t set;
  int signal = 0;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR1);
  return sigwait(&set, &signal) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) return 9;
  const unsigned node = static_cast<unsigned>(std::atoi(argv[1]));
  const unsigned nodes = static_cast<unsigned>(std::atoi(argv[2]));
  const unsigned rounds = static_cast<unsigned>(std::atoi(argv[3]));
  const bool by_signal = std::strcmp(argv[4], "signal") == 0;
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR1);
  sigprocmask(SIG_BLOCK, &set, nullptr);
  if (!set_up(node, nodes)) return 1;
  if (by_signal && scr_int_set(SET_SIG) != 0) return 2;
  volatile uint32_t* words = get_base_mem();
  volatile uint32_t* ready = words + 1024;
  ready[node] = 1;
  for (unsigned i = 0; i < nodes; ++i)
    while (ready[i] == 0) {
    }
  const unsigned before = (node + nodes - 1) % nodes;
  if (node == 0) words[0] = 1;
  for (unsigned round = 1; round <= rounds;) {
    uint32_t address = 0;
    if (scr_read_int_fifo(&address) == 0) {
      if ((scr_csr_read(SCR_CSR1) & ~0x4000U) != 0) return 3;
      if (!sleep_until_interrupt(by_signal)) return 4;
      continue;
    }
    if (address >> 2 != before) continue;  // from another node: ignored
    if (words[before] != round) return 5;
    words[node] = node == 0 ? round + 1 : round;
    ++round;
  }
  scr_int_set(CLR_SIG);
  if (scr_mem_mm(UNMAP) != 0 || scr_reg_mm(UNMAP) != 0) return 6;
  std::puts("ok");
  return 0;
}
