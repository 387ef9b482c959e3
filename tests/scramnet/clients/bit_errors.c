/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the vendor's test of the bit error rate: in write-me-last, each packet is stored,
 * goes around the ring, is loaded and compared. Arguments: the number of packets; "pointer" to
 * store and load through the pointer, "blocks" for block calls. */
#include <sched.h>
#include <scrplus.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { WORDS = 256, OFFSET = 0x4000 };

int main(int argc, char** argv) {
  const unsigned int packets = argc > 1 ? (unsigned int)atoi(argv[1]) : 100;
  const int by_pointer = argc > 2 && strcmp(argv[2], "pointer") == 0;
  static unsigned int sent[2][WORDS], received[WORDS];
  unsigned int packet, random = 1, wrong = 0, old = 0;
  volatile unsigned int* memory;
  int i;
  if (sp_scram_init(0) < 0) return 1;
  sp_stm_mm(Long_mode);
  scr_csr_write(SCR_CSR2, 0xd040 | 0x0300);
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR10, (unsigned short)(scr_csr_read(SCR_CSR10) | 0x11));
  scr_csr_write(SCR_CSR8, (unsigned short)(scr_csr_read(SCR_CSR8) & 0xf800));
  scr_csr_write(SCR_CSR9, 0x01a8);
  scr_csr_write(SCR_CSR13, 0);
  scr_csr_write(SCR_CSR3, (unsigned short)(253 << 8));
  memory = (volatile unsigned int*)get_base_mem() + OFFSET / 4;
  for (packet = 1; packet <= packets; ++packet) {
    unsigned int* now = sent[packet % 2];
    const unsigned int* before = sent[(packet + 1) % 2];
    now[0] = packet;
    now[1] = ~packet;
    now[2] = WORDS;
    for (i = 3; i < WORDS; ++i) now[i] = random = random * 1664525u + 1013904223u;
    memset(received, 0, sizeof received);
    if (by_pointer)
      for (i = 0; i < WORDS; ++i) memory[i] = now[i];
    else
      scr_dma_write(now, OFFSET, sizeof received);
    sched_yield();
    if (by_pointer)
      for (i = 0; i < WORDS; ++i) received[i] = memory[i];
    else
      scr_dma_read(received, OFFSET, sizeof received);
    for (i = 0; i < WORDS; ++i) {
      if (received[i] == now[i]) continue;
      if (received[i] == before[i])
        ++old;
      else
        ++wrong;
    }
  }
  printf("%u packets, %u words wrong, %u words old, %u link errors\n", packets, wrong, old,
         scr_csr_read(SCR_CSR13));
  return wrong != 0 || old != 0 || scr_csr_read(SCR_CSR13) != 0;
}
