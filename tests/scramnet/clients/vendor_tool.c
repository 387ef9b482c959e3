/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the vendor's throughput and memory tools: burst mode, bits of CSR10, counters, copies
 * by the card's DMA. */
#include <scrplus.h>
#include <stdio.h>
#include <stdlib.h>

int main(void) {
  enum { LENGTH = 65536 };
  unsigned char *out = malloc(LENGTH), *in = malloc(LENGTH);
  int i, wrong = 0;
  if (sp_scram_init(0) < 0) return 1;
  scr_csr_write(SCR_CSR2, 0xd040);
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR10, (unsigned short)(scr_csr_read(SCR_CSR10) | 0x11));
  scr_csr_write(SCR_CSR3, 21 << 8);
  scr_csr_write(SCR_CSR9, 0x01a8);
  if ((8 << sp_plus_flag) != 16 || (scr_csr_read(SCR_CSR10) & 0x11) != 0x11) return 2;
  if (scr_csr_read(SCR_CSR3) >> 8 != 21 || (scr_csr_read(SCR_CSR3) & 0xff) < 1) return 3;
  if (sp_mem_size() < LENGTH || scr_csr_read(SCR_CSR13) != 0) return 4;
  for (i = 0; i < LENGTH; ++i) out[i] = (unsigned char)(i * 7);
  if (scr_dma_write(out, 4096, LENGTH) != 0 || scr_dma_read(in, 4096, LENGTH) != 0) return 5;
  for (i = 0; i < LENGTH; ++i) wrong += in[i] != out[i];
  scr_csr_write(SCR_CSR2, 0xd040 | 0x300);
  scr_csr_write(SCR_CSR2, 0xd040);
  free(out);
  free(in);
  if (wrong != 0) return 6;
  puts("ok");
  return 0;
}
