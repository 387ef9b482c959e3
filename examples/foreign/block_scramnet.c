/* SPDX-License-Identifier: Apache-2.0
 *
 * The block of block.h as the solver on the ring of the SRMD, by the vendor's API for SCRAMNet+
 * cards alone: node opf. srmd_map.h is generated: rths map gen srmd --lang c block_scramnet MOTION
 * STEP_S DURATION_S */
#include <scrplus.h>
#include <time.h>

#include "block.h"
#include "srmd_map.h"

enum { DEADLINE_S = 5 }; /* for each flag of the handshake */

static volatile int* flag(int word) { return (volatile int*)get_base_mem() + word; }
static volatile float* value(int word) { return (volatile float*)get_base_mem() + word; }

static double seconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec + 1e-9 * now.tv_nsec;
}

static void nap(long microseconds) {
  const struct timespec time = {0, 1000 * microseconds};
  nanosleep(&time, NULL);
}

static void wait_for(int word, int expected, const char* name) {
  const double deadline = seconds() + DEADLINE_S;
  while (*flag(word) != expected) {
    if (seconds() > deadline) {
      fprintf(stderr, "%s is not %d after %d s\n", name, expected, DEADLINE_S);
      exit(3);
    }
    nap(50);
  }
}

/* Data first, then the flag. The target is reached when switchPC has risen and fallen and atTarget
 * is up again. */
static void move_to(const struct block* block, double time) {
  *value(SRMD_OPF_LONG_DISPL_TARGET) = block->displ[0] / SRMD_OPF_LONG_DISPL_TARGET_SCALE;
  *value(SRMD_OPF_LAT_DISPL_TARGET) = block->displ[1] / SRMD_OPF_LAT_DISPL_TARGET_SCALE;
  *value(SRMD_OPF_LONG_VELOC_TARGET) = block->veloc[0] / SRMD_OPF_LONG_VELOC_TARGET_SCALE;
  *value(SRMD_OPF_LAT_VELOC_TARGET) = block->veloc[1] / SRMD_OPF_LAT_VELOC_TARGET_SCALE;
  *value(SRMD_OPF_1_TIME_TARGET) = time;
  *flag(SRMD_OPF_NEWTARGET) = 1;
  wait_for(SRMD_DAQ_SWITCHPC, 1, "switchPC");
  *flag(SRMD_OPF_NEWTARGET) = 0;
  wait_for(SRMD_DAQ_SWITCHPC, 0, "switchPC");
  wait_for(SRMD_DAQ_ATTARGET, 1, "atTarget");
}

static void read_force(double* force) {
  force[0] = *value(SRMD_DAQ_LONG_FORCE_FBK) * SRMD_DAQ_LONG_FORCE_FBK_SCALE;
  force[1] = *value(SRMD_DAQ_LAT_FORCE_FBK) * SRMD_DAQ_LAT_FORCE_FBK_SCALE;
}

int main(int argc, char** argv) {
  struct motion motion;
  struct block block = {{0, 0}, {0, 0}, {0, 0}};
  double step, force[AXES];
  int i, steps;
  if (argc != 4) return 4;
  if (read_motion(argv[1], &motion) != 0) {
    fprintf(stderr, "%s is not a motion\n", argv[1]);
    return 2;
  }
  step = atof(argv[2]);
  steps = (int)(atof(argv[3]) / step + 0.5);
  if (sp_scram_init(0) < 0) return 1;
  scr_csr_write(SCR_CSR3, SRMD_NODE_OPF << 8);
  scr_csr_write(SCR_CSR0, 0x8003); /* on the ring: insert, transmit, receive */
  wait_for(SRMD_DAQ_ATTARGET, 1, "atTarget");
  for (i = 1; i <= steps; ++i) {
    block_predict(&block, step);
    move_to(&block, i * step);
    read_force(force);
    block_correct(&block, force, &motion, i * step, step);
  }
  *flag(SRMD_OPF_NEWTARGET) = -1; /* the end of the test */
  nap(20000);                     /* until every node has read it */
  printf("%d steps; the block is at %.1f mm, %.1f mm\n", steps, 1e3 * block.displ[0],
         1e3 * block.displ[1]);
  return 0;
}
