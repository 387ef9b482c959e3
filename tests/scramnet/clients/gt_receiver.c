/* SPDX-License-Identifier: Apache-2.0
 *
 * Receives COUNT interrupts of gt_sender and checks that none is lost, and that each comes after
 * its data. gt_receiver broadcast|unicast ID COUNT */
#include <scgtapi.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char** argv) {
  scgtHandle handle;
  scgtIntrHandle cursor = (scgtIntrHandle)-1;
  scgtInterrupt got[64];
  uint32 i, id, count, returned = 0, received = 0, data = 0;
  if (argc < 4 || scgtOpen(0, &handle) != SCGT_SUCCESS) return 1;
  id = (uint32)strtoul(argv[2], NULL, 10);
  count = (uint32)strtoul(argv[3], NULL, 10);
  if (scgtGetInterrupt(&handle, &cursor, got, 64, 0, &returned) != SCGT_TIMEOUT) return 2;
  if (strcmp(argv[1], "unicast") == 0)
    scgtSetState(&handle, SCGT_UNICAST_INT_MASK, 1);
  else
    scgtSetState(&handle, SCGT_BROADCAST_INT_MASK, 1U << id);
  scgtSetState(&handle, SCGT_NODE_ID, id); /* tells the sender to begin */
  while (received < count) {
    if (scgtGetInterrupt(&handle, &cursor, got, 64, 20000, &returned) != SCGT_SUCCESS) return 3;
    if (scgtRead(&handle, 64, &data, 4, 0, NULL) != SCGT_SUCCESS) return 4;
    for (i = 0; i < returned; ++i)
      if (got[i].val != ++received || got[i].sourceNodeID != 7) return 5;
    if (data < received) return 6;
  }
  printf("%u interrupts\n", received);
  scgtClose(&handle);
  return 0;
}
