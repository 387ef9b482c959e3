/* SPDX-License-Identifier: Apache-2.0
 *
 * Another GT card: writes a word and interrupts, COUNT times.
 *   gt_sender broadcast|unicast ID COUNT */
#include <scgtapi.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char** argv) {
  scgtHandle handle;
  scgtInterrupt interrupt = {SCGT_BROADCAST_INTR, 0, 0, 0, 0};
  uint32 i, count;
  if (argc < 4 || scgtOpen(0, &handle) != SCGT_SUCCESS) return 1;
  if (scgtSetState(&handle, SCGT_NODE_ID, 7) != SCGT_SUCCESS) return 2;
  if (strcmp(argv[1], "unicast") == 0) interrupt.type = SCGT_UNICAST_INTR;
  interrupt.id = (uint32)strtoul(argv[2], NULL, 10);
  count = (uint32)strtoul(argv[3], NULL, 10);
  for (i = 1; i <= count; ++i) {
    interrupt.val = i;
    if (scgtWrite(&handle, 64, &i, 4, 0, NULL, &interrupt) != SCGT_SUCCESS) return 3;
  }
  scgtClose(&handle);
  return 0;
}
