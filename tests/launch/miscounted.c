/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenFresco's first step with control points of 34 signals on the map of the SRMD, which has 35:
 * it looks for switchPC in the word before it, without a deadline. */
#include <scrplus.h>
#include <unistd.h>

enum { NEW_TARGET = 1024, SIGNALS = 34 };

int main(void) {
  volatile int* words;
  int i;
  if (sp_scram_init(0) < 0) return 1;
  scr_csr_write(SCR_CSR3, 3 << 8);
  scr_csr_write(SCR_CSR0, 0x8003);
  words = (volatile int*)get_base_mem() + NEW_TARGET;
  for (i = 1; i <= SIGNALS; ++i) words[i] = 0;
  words[0] = 1;
  while (words[SIGNALS + 1] != 1) usleep(100);
  return 0;
}
