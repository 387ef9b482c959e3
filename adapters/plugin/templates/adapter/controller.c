/* A controller: on a new target, it moves the reference along a straight line, ahead of the target
 * by the delay of the machine. Flags precede the inputs that they guard and follow the outputs. */
#include <rths_adapter_simple.h>

enum { AXES = 2, TARGET = 1, DISPLACEMENT = 3, ACCELERATION = 5, FORCE = 7, LOAD = 9 }; /* inputs */
enum { INTERVAL = 10, MOVE, DELAY, PLATEN, WEIGHT }; /* parameters */
enum { REFERENCE, COMPRESSION = 2, FEEDBACK, FED_FORCE = 5, SPECIMEN = 7, AT_TARGET = 9, SWITCH };

static const rths_signal kSignals[] = {
    {"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.long.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.lat.displ.target", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.long.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.lat.displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.long.accel.fbk", "m/s2", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.lat.accel.fbk", "m/s2", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.long.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.lat.force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.vert.force.target", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"interval", "s", RTHS_PARAMETER, 0, 0.01, 0.001, 10}, /* between targets */
    {"move", "s", RTHS_PARAMETER, 0, 0.007, 0.001, 10},
    {"delay", "s", RTHS_PARAMETER, 0, 0.06, 0, 1},
    {"platen", "kg", RTHS_PARAMETER, 0, 115e3, 0, 1e6}, /* its inertia is in the measured force */
    {"weight", "N", RTHS_PARAMETER, 0, 9685600, 0, 53.4e6},
    {"xpc.long.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
    {"xpc.lat.displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
    {"xpc.compression.force.ref", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.long.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.lat.displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.long.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"daq.lat.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    {"observer.force.long", "N", RTHS_MONITOR, 0, 0, 0, 0}, /* role `force` of the report */
    {"observer.force.lat", "N", RTHS_MONITOR, 0, 0, 0, 0},
    {"daq.atTarget", "1", RTHS_OUTPUT, 0, 0, 0, 1},
    {"daq.switchPC", "1", RTHS_OUTPUT, 0, 0, 0, 1},
};

typedef struct {
  double target[AXES], from[AXES], to[AXES], begun; /* [m], [s] */
  int has_target, moves;
} Controller;

static rths_status step(Controller* c, double time_s, const double* in, double* out) {
  const int has_target = in[0] > 0;
  for (int i = 0; has_target && !c->has_target && i < AXES; ++i) {
    c->from[i] = out[REFERENCE + i];
    c->to[i] = in[TARGET + i] + in[DELAY] / in[INTERVAL] * (in[TARGET + i] - c->target[i]);
    c->target[i] = in[TARGET + i];
    c->begun = time_s;
    c->moves = 1;
  }
  c->has_target = has_target;
  const double x = time_s < c->begun + in[MOVE] ? (time_s - c->begun) / in[MOVE] : 1;
  for (int i = 0; i < AXES; ++i) {
    out[REFERENCE + i] = c->from[i] + x * (c->to[i] - c->from[i]);
    out[SPECIMEN + i] = in[FORCE + i] - in[PLATEN] * in[ACCELERATION + i];
  }
  out[COMPRESSION] = in[WEIGHT] + in[LOAD];
  if (x >= 1 && !has_target && c->moves) { /* at the target: the solver gets its feedback */
    c->moves = 0;
    memcpy(out + FEEDBACK, in + DISPLACEMENT, AXES * sizeof *out);
    memcpy(out + FED_FORCE, out + SPECIMEN, AXES * sizeof *out);
  }
  out[AT_TARGET] = !c->moves;
  out[SWITCH] = has_target;
  return RTHS_OK;
}

RTHS_SIMPLE_ADAPTER(Controller, "@NAME@", "0.1", kSignals, step)
