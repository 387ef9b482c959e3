/* SPDX-License-Identifier: Apache-2.0
 *
 * Plays the machine of examples/python/two_signals.ringmap.toml through the vendor's API alone: a
 * spring of 1 kN/mm. */
#include <sched.h>
#include <scrplus.h>
#include <string.h>

enum { DISPLACEMENT, FORCE }; /* words of the ring */

int main(void) {
  SCR_LONG_PTR ring;
  if (sp_scram_init(0) < 0) return 1;
  scr_csr_write(SCR_CSR3, 2 << 8); /* the node id */
  scr_csr_write(SCR_CSR0, 0x8003); /* insert, transmit, receive */
  ring = get_base_mem();
  for (;;) {
    const unsigned word = ring[DISPLACEMENT];
    if (ring[FORCE] != word) ring[FORCE] = word; /* 1 kN for 1 mm: the same bits */
    sched_yield();
  }
}
