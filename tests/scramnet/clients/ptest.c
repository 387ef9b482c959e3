/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on a neural simulator's benchmark on GT cards: the barrier is a byte per node in one
 * longword; small blocks are stored directly, large ones by DMA.
 *   ptest NODE ROUNDS */
#include <scgtapi.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>

enum { NODES = 2, FLOATS = 1024 };

/* A node that has passed this barrier may already be at the next one. */
static int has_arrived(uint32 flags, int node, uint8 value) {
  return (uint8)((flags >> 8 * node) - value) < 128;
}

static void barrier(volatile uint8* flags, int node, uint8 value) {
  unsigned turn;
  flags[node] = value;
  for (turn = 0; !has_arrived(*(volatile uint32*)flags, 1 - node, value); ++turn)
    if (turn % 64 == 63) sched_yield();
}

int main(int argc, char** argv) {
  static float out[FLOATS], in[FLOATS];
  scgtHandle handle;
  int node, round, i;
  volatile uint8* flags;
  if (argc < 3 || scgtOpen(0, &handle) != SCGT_SUCCESS) return 1;
  node = atoi(argv[1]);
  flags = scgtMapMem(&handle);
  if (flags == NULL) return 2;
  for (round = 1; round <= atoi(argv[2]); ++round) {
    const uint32 own = 4096 + (uint32)node * sizeof out;
    const uint32 other = 4096 + (uint32)(1 - node) * sizeof out;
    for (i = 0; i < FLOATS; ++i) out[i] = (float)(round * 1000 + node);
    if (scgtWrite(&handle, own, out, sizeof out, 0, NULL, NULL) != SCGT_SUCCESS) return 3;
    barrier(flags, node, (uint8)(2 * round - 1));
    if (scgtRead(&handle, other, in, sizeof in, 0, NULL) != SCGT_SUCCESS) return 4;
    for (i = 0; i < FLOATS; ++i)
      if (in[i] != (float)(round * 1000 + 1 - node)) return 5;
    if (scgtRead(&handle, other, in, 32, SCGT_RW_PIO, NULL) != SCGT_SUCCESS) return 6;
    barrier(flags, node, (uint8)(2 * round));
  }
  scgtUnmapMem(&handle);
  scgtClose(&handle);
  puts("ok");
  return 0;
}
