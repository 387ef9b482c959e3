/* SPDX-License-Identifier: Apache-2.0
 *
 * The controller's side of the handshake: reads each target once, answers with twice its values,
 * and checks that no flag arrives twice, late or before its data. */
#include <sched.h>
#include <scramnet/scrplus.h>
#include <stdio.h>

enum { SIGNALS = 4, BYTE_OFFSET = 4096 };

static void wait_while(volatile int* flag, int value) {
  unsigned turn;
  for (turn = 0; *flag == value; ++turn)
    if (turn % 64 == 63) sched_yield();
}

int main(void) {
  int expected, i;
  volatile int *new_target, *switch_pc, *at_target;
  volatile float *command, *feedback;
  if (sp_scram_init(0) < 0) return 1;
  scr_csr_write(SCR_CSR2, 0xC040);
  scr_csr_write(SCR_CSR0, 0x8003);
  new_target = (volatile int*)(get_base_mem() + BYTE_OFFSET / 4);
  command = (volatile float*)(new_target + 1);
  switch_pc = new_target + SIGNALS + 1;
  at_target = new_target + SIGNALS + 2;
  feedback = (volatile float*)(new_target + SIGNALS + 3);
  *at_target = 1;
  for (expected = 1;; ++expected) {
    wait_while(new_target, 0);
    if (*new_target < 0) break;
    if (*new_target != 1) return 2;
    for (i = 0; i < SIGNALS; ++i)
      if (command[i] != (float)(expected + i))
        return 3; /* a flag before its data, or a lost flag */
    *at_target = 0;
    *switch_pc = 1;
    wait_while(new_target, 1);
    if (*new_target != 0) return 4;
    *switch_pc = 0;
    for (i = 0; i < SIGNALS; ++i) feedback[i] = 2 * command[i];
    *at_target = 1;
  }
  *at_target = -1;
  printf("%d steps\n", expected - 1);
  return 0;
}
