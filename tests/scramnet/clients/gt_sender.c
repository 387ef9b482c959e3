/* SPDX-License-Identifier: Apache-2.0
 *
 * Another GT card: writes a word and interrupts, COUNT times. With NODE, begins when the card
 * before it on the ring has that id. gt_sender broadcast|unicast ID COUNT [NODE] */
#define _POSIX_C_SOURCE 200809L
#include <scgtapi.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

int main(int argc, char** argv) {
  scgtHandle handle;
  scgtInterrupt interrupt = {SCGT_BROADCAST_INTR, 0, 0, 0, 0};
  const struct timespec nap = {0, 1000000};
  uint32 i, count, node;
  if (argc < 4 || scgtOpen(0, &handle) != SCGT_SUCCESS) return 1;
  if (scgtSetState(&handle, SCGT_NODE_ID, 7) != SCGT_SUCCESS) return 2;
  if (strcmp(argv[1], "unicast") == 0) interrupt.type = SCGT_UNICAST_INTR;
  interrupt.id = (uint32)strtoul(argv[2], NULL, 10);
  count = (uint32)strtoul(argv[3], NULL, 10);
  node = argc > 4 ? (uint32)strtoul(argv[4], NULL, 10) : 0;
  for (i = 0; i < 20000 && argc > 4 && scgtGetState(&handle, SCGT_UPSTREAM_NODE_ID) != node; ++i)
    nanosleep(&nap, NULL);
  for (i = 1; i <= count; ++i) {
    interrupt.val = i;
    if (scgtWrite(&handle, 64, &i, 4, 0, NULL, &interrupt) != SCGT_SUCCESS) return 3;
  }
  scgtClose(&handle);
  return 0;
}
