/* SPDX-License-Identifier: Apache-2.0
 *
 * A correct adapter, from which each definition makes one that breaks one rule.
 */
#define _GNU_SOURCE
#include <math.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include <rths_adapter.h>

#define LATER 100 /* step */

typedef struct {
  double position; /* [m] */
  int steps;
  int stopping;
  int active;
  const char* reason;
} Lag;

#ifdef UNIT_NOT_SI
#define UNIT "mm"
#elif defined UNIT_UNKNOWN
#define UNIT "furlongish"
#else
#define UNIT "m"
#endif

#ifdef NO_NAME_OF_A_SIGNAL
#define OUTPUT NULL
#elif defined SIGNAL_TWICE
#define OUTPUT "srmd.lat.displ.fbk"
#else
#define OUTPUT "srmd.long.displ.fbk"
#endif

#ifdef DIRECTION_UNKNOWN
#define MONITOR 9
#else
#define MONITOR RTHS_MONITOR
#endif

#ifdef INITIAL_OUTSIDE
#define INITIAL 2.0
#else
#define INITIAL 0.5
#endif

#ifdef RANGE_REVERSED
#define LOWEST 1.0
#define HIGHEST 0.1
#else
#define LOWEST 0.1
#define HIGHEST 1.0
#endif

enum { REFERENCE, GAIN };
enum { POSITION, OTHER, COUNT };

static const rths_signal kSignals[] = {
    {"xpc.long.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"gain", "1", RTHS_PARAMETER, 0, INITIAL, LOWEST, HIGHEST},
    {OUTPUT, UNIT, RTHS_OUTPUT, RTHS_RAMP, 0, -1, 1},
    {"srmd.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"count", "1", MONITOR, RTHS_EVENT, 0, 0, 0},
};

#ifdef STATE_IS_SHARED
static double shared_position;
#endif
#ifdef EXPORTS_MORE
__attribute__((visibility("default"))) int another_symbol(void) { return 1; }
#endif

#ifdef DESTRUCTOR_ABORTS
__attribute__((destructor)) static void end(void) { abort(); }
#endif

static void* create(const char* config_toml, char* error, uint32_t error_size) {
#ifdef CREATE_FAILS
  snprintf(error, error_size, "no licence found, expected one");
  return NULL;
#elif defined CREATE_FAILS_SILENTLY
  (void)error, (void)error_size;
  return NULL;
#elif defined CREATE_LOOPS
  for (volatile int i = 0;; ++i) i = 0;
#elif defined CREATE_EXITS
  exit(7);
#elif defined CREATE_FORKS
  if (fork() == 0)
    for (;;) pause();
#endif
  (void)config_toml;
  Lag* lag = calloc(1, sizeof *lag);
  if (lag == NULL) snprintf(error, error_size, "no memory");
  return lag;
}

static const rths_signal* list(void* self, uint32_t* count) {
  *count = sizeof kSignals / sizeof *kSignals;
#ifdef NO_SIGNALS
  *count = 0;
#elif defined SIGNALS_CHANGE
  *count -= (uint32_t)((Lag*)self)->active;
#endif
  (void)self;
  return kSignals;
}

static rths_status activate(void* self, char* error, uint32_t error_size) {
  Lag* lag = self;
  (void)error, (void)error_size;
#ifdef ACTIVATE_FAILS
  snprintf(error, error_size, "the amplifier is off");
  return RTHS_FAULT;
#elif defined ACTIVATE_ABORTS
  abort();
#endif
#ifndef KEEPS_ITS_STATE
  memset(lag, 0, sizeof *lag);
#endif
  lag->active = 1;
  lag->stopping = 0;
#ifdef STATE_IS_SHARED
  shared_position = 0;
#endif
  return RTHS_OK;
}

static void wait_ms(long milliseconds) {
  const struct timespec time = {0, milliseconds * 1000000};
  nanosleep(&time, NULL);
}

/* Every `period` calls, 5 ms of the processor: in other steps of each run. */
static int slow_every(int period) {
  static int calls = 0;
  const clock_t begun = clock();
  if (++calls % period == 0)
    while (clock() - begun < CLOCKS_PER_SEC / 200) continue;
  return 1;
}

static rths_status step(void* self, double time_s, const double* in, double* out) {
  Lag* lag = self;
  const int is_later = ++lag->steps > LATER;
  (void)time_s, (void)is_later, (void)slow_every;
#ifdef STATE_IS_SHARED
  double* position = &shared_position;
#else
  double* position = &lag->position;
#endif
#ifdef STEP_SETS_NOTHING
  return RTHS_OK;
#endif
  *position += in[GAIN] * 0.1 * (in[REFERENCE] - *position);
  out[POSITION] = *position;
  out[OTHER] = 0;
  out[COUNT] = lag->steps;
#ifdef STEP_LOOPS
  while (is_later) lag->active = is_later;
#elif defined STEP_WAITS
  wait_ms(2);
#elif defined STEP_IS_SLOW_ONCE
  const clock_t begun = clock();
  while (lag->steps == LATER && clock() - begun < CLOCKS_PER_SEC / 20) lag->active = 1;
#elif defined STEP_IS_SLOW_AT_RANDOM
  lag->active = slow_every(51);
#elif defined STEP_IS_SLOW_IN_ONE_RUN
  lag->active = slow_every(601);
#elif defined STEP_ALLOCATES
  void* volatile memory = malloc(100);
  free(memory);
#elif defined STEP_ALLOCATES_LATER
  if (lag->steps == LATER) free(strdup("late"));
#elif defined STEP_CRASHES
  if (is_later) *(volatile int*)8 = 1;
#elif defined STEP_DIVIDES_BY_ZERO
  if (is_later) raise(SIGFPE);
#elif defined STEP_WRITES_NAN
  if (is_later) out[POSITION] = NAN;
#elif defined STEP_WRITES_INFINITY
  out[COUNT] = INFINITY;
#elif defined STEP_LEAVES_ITS_RANGE
  if (is_later) out[POSITION] = 1.5;
#elif defined STEP_WRITES_BEHIND
  out[COUNT + 1] = 1;
#elif defined STEP_WRITES_BEFORE
  out[-1] = 1;
#elif defined STEP_WRITES_INPUTS
  ((double*)in)[REFERENCE] = 3;
#elif defined STEP_RETURNS_UNKNOWN
  return 17;
#elif defined STEP_FAILS
  lag->reason = "the pump is off";
  if (is_later) return RTHS_FAULT;
#elif defined USES_THE_CLOCK
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  out[OTHER] = lag->steps == LATER / 2 ? 1e-9 * (double)getpid() : 0;
#endif
#ifdef NEVER_RESTS
  return RTHS_OK;
#else
  return lag->stopping > 0 && ++lag->stopping > 20 ? RTHS_DONE : RTHS_OK;
#endif
}

static void stop(void* self) { ((Lag*)self)->stopping = 1; }
static const char* message(void* self) { return ((Lag*)self)->reason; }

static void deactivate(void* self) {
  ((Lag*)self)->active = 0;
#ifdef DEACTIVATE_CRASHES
  *(volatile int*)8 = 1;
#elif defined DEACTIVATE_LOOPS
  for (;;) wait_ms(1);
#endif
}

static void destroy(void* self) {
  (void)wait_ms;
#ifdef DESTROYS_TWICE
  free(self);
  abort();
#endif
  free(self);
}

#ifdef WRONG_MAJOR
#define ABI ((RTHS_ADAPTER_ABI_MAJOR + 1) << 16)
#elif defined LATER_MINOR
#define ABI (RTHS_ADAPTER_ABI + 5)
#elif defined EARLIER_MINOR
#define ABI (RTHS_ADAPTER_ABI_MAJOR << 16)
#else
#define ABI RTHS_ADAPTER_ABI
#endif

#ifdef STRUCT_TOO_SMALL
#define SIZE 24
#elif defined EARLIER_MINOR
#define SIZE offsetof(rths_adapter, stop)
#else
#define SIZE sizeof(rths_adapter)
#endif

#ifdef NO_NAME
#define NAME ""
#else
#define NAME "lag"
#endif
#ifdef NO_STEP
#define STEP NULL
#else
#define STEP step
#endif

#ifdef EARLIER_MINOR
#define STOP (void (*)(void*))8 /* beyond the struct of minor 0: must not be read */
#else
#define STOP stop
#endif

#ifdef NO_ENTRY
int rths_adapter_entry_of_old(void) { return 0; }
#else
const rths_adapter* rths_adapter_entry(void) {
  static const rths_adapter adapter = {ABI,      SIZE, NAME,       "1.0",   create, list,
                                       activate, STEP, deactivate, destroy, STOP,   message};
#ifdef ENTRY_RETURNS_NULL
  return NULL;
#endif
  return &adapter;
}
#endif
