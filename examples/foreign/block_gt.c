/* SPDX-License-Identifier: Apache-2.0
 *
 * The block of block.h along one axis, as the solver on the ring of the FlexTest controller at UCB,
 * by the vendor's API for SCRAMNet GT cards alone: node opf. flextest_ucb_map.h is generated: rths
 * map gen flextest_ucb --lang c block_gt MOTION STEP_S DURATION_S */
#include <scgtapi.h>
#include <time.h>

#include "block.h"
#include "flextest_ucb_map.h"

enum { DEADLINE_S = 5 }; /* for each flag of the handshake */

static volatile uint32* ring;

static volatile int* flag(int word) { return (volatile int*)ring + word; }
static volatile float* value(int word) { return (volatile float*)ring + word; }

static void nap(long microseconds) {
  const struct timespec time = {0, 1000 * microseconds};
  nanosleep(&time, NULL);
}

static void wait_for(int word, int expected, const char* name) {
  const time_t deadline = time(NULL) + DEADLINE_S;
  while (*flag(word) != expected) {
    if (time(NULL) > deadline) {
      fprintf(stderr, "%s is not %d after %d s\n", name, expected, DEADLINE_S);
      exit(3);
    }
    nap(50);
  }
}

/* The displacement of the target, then the flag. */
static void move_to(double displ) {
  *value(FLEXTEST_UCB_OPF_DISPL_TARGET) = displ / FLEXTEST_UCB_OPF_DISPL_TARGET_SCALE;
  *flag(FLEXTEST_UCB_OPF_NEWTARGET) = FLEXTEST_UCB_OPF_NEWTARGET_NEW;
  wait_for(FLEXTEST_UCB_DAQ_SWITCHPC, FLEXTEST_UCB_DAQ_SWITCHPC_CONSUMED, "switchPC");
  *flag(FLEXTEST_UCB_OPF_NEWTARGET) = FLEXTEST_UCB_OPF_NEWTARGET_IDLE;
  wait_for(FLEXTEST_UCB_DAQ_SWITCHPC, FLEXTEST_UCB_DAQ_SWITCHPC_READY, "switchPC");
  wait_for(FLEXTEST_UCB_DAQ_ATTARGET, FLEXTEST_UCB_DAQ_ATTARGET_AT_TARGET, "atTarget");
}

int main(int argc, char** argv) {
  scgtHandle card;
  struct motion motion;
  struct block block = {{0, 0}, {0, 0}, {0, 0}};
  double step, force[AXES] = {0, 0};
  struct timespec next;
  int i, steps;
  if (argc != 4) return 4;
  if (read_motion(argv[1], &motion) != 0) {
    fprintf(stderr, "%s is not a motion\n", argv[1]);
    return 2;
  }
  step = atof(argv[2]);
  steps = (int)(atof(argv[3]) / step + 0.5);
  if (scgtOpen(0, &card) != SCGT_SUCCESS) return 1;
  ring = (volatile uint32*)scgtMapMem(&card);
  if (ring == NULL) return 1;
  wait_for(FLEXTEST_UCB_DAQ_ATTARGET, FLEXTEST_UCB_DAQ_ATTARGET_AT_TARGET, "atTarget");
  clock_gettime(CLOCK_MONOTONIC, &next);
  for (i = 1; i <= steps; ++i) {
    block_predict(&block, step);
    move_to(block.displ[0]);
    force[0] = *value(FLEXTEST_UCB_DAQ_FORCE_FBK) * FLEXTEST_UCB_DAQ_FORCE_FBK_SCALE;
    block_correct(&block, force, &motion, i * step, step);
    /* This laboratory's controller is ideal and answers at once: the solver keeps real time. */
    next.tv_nsec += (long)(1e9 * step);
    next.tv_sec += next.tv_nsec / 1000000000;
    next.tv_nsec %= 1000000000;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
  }
  *flag(FLEXTEST_UCB_OPF_NEWTARGET) = FLEXTEST_UCB_OPF_NEWTARGET_STOP;
  nap(20000); /* until every node has read it */
  scgtClose(&card);
  printf("%d steps; the block is at %.1f mm\n", steps, 1e3 * block.displ[0]);
  return 0;
}
