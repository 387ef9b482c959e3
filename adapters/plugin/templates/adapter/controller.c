/* A controller: on a new target, it moves the reference along a straight line for one step. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rths_adapter.h>

enum {
  AXES = 2,
  NEW_TARGET = 0,
  TARGET,
  DISPLACEMENT = TARGET + AXES,
  FORCE = DISPLACEMENT + AXES,
  LOAD = FORCE + AXES,
  STEP,
  WEIGHT
}; /* of the inputs */
enum {
  REFERENCE,
  COMPRESSION = AXES,
  FEEDBACK,
  FED_FORCE = FEEDBACK + AXES,
  AT_TARGET = FED_FORCE + AXES,
  SWITCH
}; /* of the outputs */

typedef struct {
  double from[AXES], to[AXES]; /* [m] */
  double begun;                /* [s] */
  int has_target, at_target;
} Controller;

/* Inputs are read in this order, so the flag comes before the targets. Outputs are written in this
 * order, so the flags come last. */
static const rths_signal kSignals[] = {
    {"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.long.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.lat.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.long.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.lat.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.long.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.lat.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.vert.force.target", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"step", "s", RTHS_PARAMETER, 0, 0.007, 0.001, 10},
    {"weight", "N", RTHS_PARAMETER, 0, 9685600, 0, 53.4e6},
    {"xpc.long.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
    {"xpc.lat.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
    {"xpc.compression.force.ref", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.atTarget", "1", RTHS_OUTPUT, 0, 0, 0, 1},
    {"daq.switchPC", "1", RTHS_OUTPUT, 0, 0, 0, 1},
};

static void* create(const char* config_toml, char* error, uint32_t error_size) {
  Controller* controller = calloc(1, sizeof *controller);
  (void)config_toml; /* this controller has no settings of its own */
  if (controller == NULL) snprintf(error, error_size, "no memory");
  return controller;
}

static const rths_signal* list(void* self, uint32_t* count) {
  (void)self;
  *count = sizeof kSignals / sizeof *kSignals;
  return kSignals;
}

static rths_status activate(void* self, char* error, uint32_t error_size) {
  (void)error, (void)error_size;
  memset(self, 0, sizeof(Controller)); /* the initial state, also at a restart */
  ((Controller*)self)->at_target = 1;
  return RTHS_OK;
}

static rths_status step(void* self, double time_s, const double* in, double* out) {
  Controller* c = self;
  const int has_target = in[NEW_TARGET] > 0;
  if (has_target && !c->has_target) { /* takes the target and answers with switchPC */
    memcpy(c->from, out + REFERENCE, sizeof c->from);
    memcpy(c->to, in + TARGET, sizeof c->to);
    c->begun = time_s;
    c->at_target = 0;
  }
  c->has_target = has_target;
  double x = (time_s - c->begun) / in[STEP];
  if (x > 1) x = 1;
  for (int i = 0; i < AXES; ++i) out[REFERENCE + i] = c->from[i] + x * (c->to[i] - c->from[i]);
  out[COMPRESSION] = in[WEIGHT] + in[LOAD];
  if (x >= 1 && !has_target && !c->at_target) {
    c->at_target = 1;
    memcpy(out + FEEDBACK, in + DISPLACEMENT, AXES * sizeof *out);
    memcpy(out + FED_FORCE, in + FORCE, AXES * sizeof *out);
  }
  out[AT_TARGET] = c->at_target;
  out[SWITCH] = has_target;
  return RTHS_OK;
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
