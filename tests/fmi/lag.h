/* SPDX-License-Identifier: Apache-2.0
 *
 * A first-order lag as an FMU, from which each definition makes one that breaks one rule. It
 * checks that its functions are called in the order of the standard. */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define LATER 100 /* step */
#define TOKEN "{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}"

enum { U = 1, Y, TAU, GAIN, ENABLED, COUNT, SINGLE, ANGLE, TEMPERATURE, LEVEL };
enum { INSTANTIATED, INITIALIZATION, STEPPING, TERMINATED };

typedef struct {
  double u, y; /* [mm] */
  double tau;  /* [s] */
  double gain;
  int enabled, count, level;
  int state;
  double time; /* [s] */
  void* environment;
  void (*log)(void* self, int status, const char* message);
  int logs;
  void* callback;
} Lag;

static void lag_reset(Lag* lag) {
  lag->tau = 0.01;
  lag->gain = 1;
  lag->enabled = 1;
}

static void lag_log(Lag* lag, const char* message) {
  if (lag->logs) lag->log(lag, 0, message);
}

/* True if a call is in order: `allowed` has a bit for each state. */
static int lag_is_in(Lag* lag, int allowed, const char* call) {
  if (allowed >> lag->state & 1) return 1;
  lag->log(lag, 3, call);
  return 0;
}

/* 0: ok, 2: discard, 3: error, 4: fatal */
static int lag_step(Lag* lag, double time, double step) {
  if (fabs(time - lag->time) > 1e-12) {
    lag->log(lag, 3, "the step begins elsewhere than the last one ended");
    return 3;
  }
  if (lag->enabled) lag->y += (lag->gain * lag->u - lag->y) * step / (step + lag->tau);
#ifdef KEEPS_ITS_STATE
  static double kept;
  lag->y = kept = 0.5 * kept + lag->u;
#endif
  if (++lag->count > LATER) {
#ifdef REFUSES_STEP
    return 2;
#elif defined FAILS_STEP
    lag->log(lag, 3, "the pump is off");
    return 3;
#elif defined IS_FATAL
    return 4;
#elif defined WRITES_NAN
    lag->y = NAN;
#elif defined CRASHES
    *(volatile int*)8 = 1;
#elif defined LOOPS
    for (volatile int i = 0;; ++i) {
    }
#elif defined LEAVES_RANGE
    lag->y = 2000;
#elif defined ALLOCATES
    void* volatile memory = malloc(32);
    free(memory);
#endif
  }
#ifdef WAITS
  const struct timespec pause = {0, 2000000};
  nanosleep(&pause, NULL);
#endif
  if (lag->count == 3) lag_log(lag, "third step");
  lag->time = time + step;
  return 0;
}
