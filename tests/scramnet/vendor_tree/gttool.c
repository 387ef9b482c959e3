/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the vendor's tools for GT cards: the installed header first, then the tree's own. */
#ifdef TREE_FIRST
#include <gtucore.h>
#endif
#include <scgtapi.h>
#include <stdio.h>

#include "usys.h"

int main(void) {
  scgtHandle handle;
  scgtDeviceInfo info;
  usysMsTimeType timer = {0, 0};
  uint32 word = 5 + timer.startTimeSecs;
  if (scgtOpen(0, &handle) != SCGT_SUCCESS) return 1;
  if (scgtGetDeviceInfo(&handle, &info) != SCGT_SUCCESS || info.popMemSize == 0) return 2;
  if (scgtWrite(&handle, 64, &word, 4, 0, NULL, NULL) != SCGT_SUCCESS) return 3;
  word = 0;
  if (scgtRead(&handle, 64, &word, 4, 0, NULL) != SCGT_SUCCESS || word != 5) return 4;
  scgtClose(&handle);
  puts("ok");
  return 0;
}
