/* SPDX-License-Identifier: Apache-2.0
 *
 * Another card: writes 1, 2, 3, … into consecutive words with TIE in its ACR.
 *   peer FIRST COUNT PERIOD_US */
#define _POSIX_C_SOURCE 200809L
#include <scrplus.h>
#include <stdlib.h>
#include <time.h>

int main(int argc, char** argv) {
  if (argc < 4 || sp_scram_init(0) < 0) return 1;
  unsigned long first = strtoul(argv[1], NULL, 10), count = strtoul(argv[2], NULL, 10);
  struct timespec period = {0, strtol(argv[3], NULL, 10) * 1000};
  unsigned long i;
  scr_reset_mm();
  for (i = 0; i < count; ++i) scr_acr_write(first + i, ACR_TIE);
  scr_csr_write(SCR_CSR0, 0x8103);
  for (i = 0; i < count; ++i) {
    get_base_mem()[first + i] = (unsigned)(i + 1);
    if (period.tv_nsec != 0) nanosleep(&period, NULL);
  }
  return 0;
}
