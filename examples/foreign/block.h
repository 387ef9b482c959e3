/* SPDX-License-Identifier: Apache-2.0
 *
 * A rigid block on one isolation bearing, in plan: axes long and lat.
 *
 *     m a + F(u) = -m a_g
 *
 * u: displacement of the block relative to the ground [m]; F: shear force of the bearing, which the
 * laboratory measures [N]; a_g: acceleration of the ground [m/s2]. Central differences: the force
 * at the next displacement is needed only after that displacement was reached. Stable for time
 * steps below 2 sqrt(m / k). */
#ifndef BLOCK_H
#define BLOCK_H

#include <stdio.h>
#include <stdlib.h>

enum { AXES = 2 }; /* long, lat */

static const double BLOCK_MASS = 987656; /* on the bearing [kg] */

/* Acceleration of the ground at equal time steps. */
struct motion {
  double step; /* [s] */
  int rows;
  double* accel[AXES]; /* [m/s2] */
};

/* State at the last target, and at the next one. */
struct block {
  double displ[AXES], veloc[AXES], accel[AXES]; /* [m], [m/s], [m/s2] */
};

/* Reads the file that replaces {motion}: a line of names, then time [s], long and lat [m/s2].
 * Returns 0, or -1. */
static int read_motion(const char* file, struct motion* motion) {
  char names[200];
  double time, a[AXES];
  int room = 0;
  FILE* in = fopen(file, "r");
  motion->rows = 0;
  motion->step = 0;
  motion->accel[0] = motion->accel[1] = NULL;
  if (in == NULL || fgets(names, sizeof names, in) == NULL) return -1;
  while (fscanf(in, "%lf,%lf,%lf", &time, &a[0], &a[1]) == 3) {
    int axis;
    if (motion->rows == room) {
      room = room == 0 ? 1024 : 2 * room;
      for (axis = 0; axis < AXES; ++axis)
        motion->accel[axis] = (double*)realloc(motion->accel[axis], room * sizeof(double));
    }
    for (axis = 0; axis < AXES; ++axis) motion->accel[axis][motion->rows] = a[axis];
    if (motion->rows++ == 1) motion->step = time;
  }
  fclose(in);
  return motion->rows > 1 ? 0 : -1;
}

/* Between the samples: linear. After the last one: 0. */
static double ground_at(const struct motion* motion, int axis, double time) {
  const double* a = motion->accel[axis];
  const int row = (int)(time / motion->step);
  const double part = time / motion->step - row;
  return row + 1 < motion->rows ? a[row] + part * (a[row + 1] - a[row]) : 0;
}

/* The next target. */
static void block_predict(struct block* block, double step) {
  int axis;
  for (axis = 0; axis < AXES; ++axis)
    block->displ[axis] += step * block->veloc[axis] + step * step / 2 * block->accel[axis];
}

/* The equation of motion at that target, with the measured force. */
static void block_correct(struct block* block, const double* force, const struct motion* motion,
                          double time, double step) {
  int axis;
  for (axis = 0; axis < AXES; ++axis) {
    const double accel = -force[axis] / BLOCK_MASS - ground_at(motion, axis, time);
    block->veloc[axis] += step / 2 * (block->accel[axis] + accel);
    block->accel[axis] = accel;
  }
}

#endif
