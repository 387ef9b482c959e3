/* A controller: the reference moves along a straight line to each new target, ahead of it by the
 * delay of the machine. Flags precede the inputs that they guard and follow the outputs. */
#include <rths_adapter_simple.h>

enum { NEW_TARGET, TARGET, LOAD = 3, DISPLACEMENT, ACCELERATION = 6, FORCE = 8, DELAY = 10 };
enum { REFERENCE, COMPRESSION = 2, FEEDBACK, FED_FORCE = 5, SPECIMEN = 7, AT_TARGET = 9, SWITCH };
enum { AXES = 2, MOVE = 8 };                                              /* steps of 1 ms */
static const double kInterval = 0.01, kPlaten = 115e3, kWeight = 9685600; /* [s], [kg], [N] */

static const rths_signal kSignals[] = {
    {"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("opf.", ".displ.target", "m", RTHS_INPUT, 0, 0, 0, 0),
    {"opf.vert.force.target", "N", RTHS_INPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("srmd.", ".displ.fbk", "m", RTHS_INPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".accel.fbk", "m/s2", RTHS_INPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".force.fbk", "N", RTHS_INPUT, 0, 0, 0, 0),
    {"delay", "s", RTHS_PARAMETER, 0, 0.06, 0, 1},
    RTHS_LONG_LAT("xpc.", ".displ.ref", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0),
    {"xpc.compression.force.ref", "N", RTHS_OUTPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("daq.", ".displ.fbk", "m", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("daq.", ".force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("observer.force.", "", "N", RTHS_MONITOR, 0, 0, 0, 0), /* of the report */
    {"daq.atTarget", "1", RTHS_OUTPUT, 0, 0, 0, 1},
    {"daq.switchPC", "1", RTHS_OUTPUT, 0, 0, 0, 1},
};

typedef struct {
  double target[AXES], end[AXES], left; /* [m], [m], steps of this move */
} Controller;

static rths_status step(Controller* c, double time_s, const double* in, double* out) {
  const int has_target = in[NEW_TARGET] > 0, is_new = has_target && c->left == 0;
  (void)time_s;
  if (is_new) c->left = MOVE;
  const int moves = c->left > has_target; /* the last step waits for the flag to fall */
  for (int i = 0; i < AXES; ++i) {
    out[SPECIMEN + i] = in[FORCE + i] - kPlaten * in[ACCELERATION + i];
    if (is_new) {
      c->end[i] = in[TARGET + i] + in[DELAY] / kInterval * (in[TARGET + i] - c->target[i]);
      c->target[i] = in[TARGET + i];
    }
    if (!moves) continue;
    out[REFERENCE + i] += (c->end[i] - out[REFERENCE + i]) / c->left;
    out[FEEDBACK + i] = in[DISPLACEMENT + i]; /* stays while the solver reads it */
    out[FED_FORCE + i] = out[SPECIMEN + i];
  }
  c->left -= moves;
  out[COMPRESSION] = kWeight + in[LOAD];
  out[AT_TARGET] = c->left == 0;
  out[SWITCH] = has_target;
  return RTHS_OK;
}
RTHS_SIMPLE_ADAPTER(Controller, "@NAME@", "0.1", kSignals, step)
