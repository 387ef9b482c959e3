/* SPDX-License-Identifier: Apache-2.0
 *
 * Counts interrupts of one word, which another card writes at a fixed period.
 *   ticks write COUNT PERIOD_US    stores 1, 2, … COUNT into word 0, then COUNT into word 1
 *   ticks wait|signal              prints the number of interrupts of word 0 until that of word 1
 */
#define _POSIX_C_SOURCE 200809L
#include <scrplus.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TICK, END, READY = 1024 };

static int write_ticks(unsigned count, long period_us) {
  struct timespec due;
  unsigned i;
  scr_acr_write(TICK, ACR_TIE);
  scr_acr_write(END, ACR_TIE);
  scr_csr_write(SCR_CSR0, 0x8103);
  while (get_base_mem()[READY] == 0) {
  }
  clock_gettime(CLOCK_MONOTONIC, &due);
  for (i = 1; i <= count; ++i) {
    due.tv_nsec += period_us * 1000;
    due.tv_sec += due.tv_nsec / 1000000000;
    due.tv_nsec %= 1000000000;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, NULL);
    get_base_mem()[TICK] = i;
  }
  get_base_mem()[END] = count;
  return 0;
}

static int count_ticks(int by_signal) {
  unsigned address = 0, count = 0, delivered = 0;
  int number = 0;
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGUSR1);
  sigprocmask(SIG_BLOCK, &set, NULL);
  scr_acr_write(TICK, ACR_RIE);
  scr_acr_write(END, ACR_RIE);
  if (by_signal && ioctl(scr_csr_fd, INTSIG, SET_SIG) != 0) return 2;
  scr_csr_write(SCR_CSR0, 0x812B);
  scr_csr_write(SCR_CSR1, 0);
  get_base_mem()[READY] = 1;
  for (;;) {
    while (scr_read_int_fifo(&address) == 1) {
      if (address == 4 * TICK) ++count;
      if (address == 4 * END) {
        printf("%u\n", count);
        return 0;
      }
    }
    scr_csr_write(SCR_CSR1, 0);
    if (by_signal ? sigwait(&set, &number) != 0
                  : ioctl(scr_csr_fd, WAIT_INTERRUPT, &delivered) != 0)
      return 3;
  }
}

int main(int argc, char** argv) {
  if (argc < 2 || sp_scram_init(0) < 0) return 1;
  scr_reset_mm();
  scr_csr_write(SCR_CSR2, 0xC040); /* a card with CSR2 = 0 loops its messages back */
  if (strcmp(argv[1], "write") != 0) return count_ticks(strcmp(argv[1], "signal") == 0);
  return argc < 4 ? 1
                  : write_ticks((unsigned)strtoul(argv[2], NULL, 10), strtol(argv[3], NULL, 10));
}
