/* SPDX-License-Identifier: Apache-2.0
 *
 * A C program for SCRAMNet+ cards: waits for numbers in one word, writes their sum to another. It
 * runs unchanged on a software ring. */
#include <sched.h>
#include <scrplus.h>
#include <stdio.h>

enum { NUMBER = 0, ANSWER = 1, SUM = 2, LAST = 10 }; /* words of the ring */

int main(void) {
  unsigned sum = 0, expected;
  SCR_LONG_PTR ring;
  if (sp_scram_init(0) < 0) return 1;
  scr_csr_write(SCR_CSR3, 20 << 8); /* our node id */
  scr_csr_write(SCR_CSR0, 0x8003);  /* on the ring: insert, transmit, receive */
  ring = get_base_mem();
  for (expected = 1; expected <= LAST; ++expected) {
    while (ring[NUMBER] != expected) sched_yield();
    sum += ring[NUMBER];
    ring[SUM] = sum;         /* data first, */
    ring[ANSWER] = expected; /* then the flag */
  }
  printf("vendor's side: summed %u numbers\n", expected - 1);
  return 0;
}
