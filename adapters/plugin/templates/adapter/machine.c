/* A test machine: a first-order lag, and a specimen that is a spring with a damper. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rths_adapter.h>

enum { AXES = 2, LAG = AXES, STIFFNESS };             /* of the inputs */
enum { DISPLACEMENT, FORCE = AXES, ECHO = 2 * AXES }; /* of the outputs */

typedef struct {
  double displacement[AXES]; /* [m] */
  double last_time;          /* [s] */
} Machine;

static const rths_signal kSignals[] = {
    {"xpc.long.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"xpc.lat.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"lag", "s", RTHS_PARAMETER, 0, 0.02, 0.001, 1},
    {"stiffness", "N/m", RTHS_PARAMETER, 0, 5e6, 0, 1e9},
    {"srmd.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, -1.5, 1.5},
    {"srmd.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, -1.5, 1.5},
    {"srmd.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"srmd.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"srmd.long.displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"srmd.lat.displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0},
};

static void* create(const char* config_toml, char* error, uint32_t error_size) {
  Machine* machine = calloc(1, sizeof *machine);
  (void)config_toml; /* this machine has no settings of its own */
  if (machine == NULL) snprintf(error, error_size, "no memory");
  return machine;
}

static const rths_signal* list(void* self, uint32_t* count) {
  (void)self;
  *count = sizeof kSignals / sizeof *kSignals;
  return kSignals;
}

static rths_status activate(void* self, char* error, uint32_t error_size) {
  (void)error, (void)error_size;
  memset(self, 0, sizeof(Machine)); /* the initial state, also at a restart */
  return RTHS_OK;
}

static rths_status step(void* self, double time_s, const double* in, double* out) {
  Machine* machine = self;
  const double passed = time_s - machine->last_time;
  rths_status status = RTHS_OK;
  for (int i = 0; i < AXES; ++i) {
    double* x = &machine->displacement[i];
    *x += (in[i] - *x) * passed / (passed + in[LAG]);
    if (*x < -1.5 || *x > 1.5) status = RTHS_LIMIT_EXCEEDED;
    *x = *x < -1.5 ? -1.5 : *x > 1.5 ? 1.5 : *x;
    out[DISPLACEMENT + i] = *x;
    out[FORCE + i] = in[STIFFNESS] * *x;
    out[ECHO + i] = in[i];
  }
  machine->last_time = time_s;
  return status;
}

static void deactivate(void* self) { (void)self; }

const rths_adapter* rths_adapter_entry(void) {
  static const rths_adapter adapter = {RTHS_ADAPTER_ABI,
                                       sizeof(rths_adapter),
                                       "@NAME@",
                                       "0.1",
                                       create,
                                       list,
                                       activate,
                                       step,
                                       deactivate,
                                       free,
                                       NULL,
                                       NULL};
  return &adapter;
}
