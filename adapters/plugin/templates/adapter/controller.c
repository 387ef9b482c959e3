/* A controller: the reference moves along a straight line to each new target, ahead of it by the
 * delay of the machine. Flags precede the inputs that they guard and follow the outputs. */
#include <rths_adapter_simple.h>

enum { NEW_TARGET, TARGET, VELOC = 3, LOAD = 5, DISPL, ACCEL = 8, FORCE = 10, DELAY = 12 };
enum { REFERENCE, COMPRESSION = 2, FEEDBACK, FED_FORCE = 5, SPECIMEN = 7, AT_TARGET = 9, SWITCH };
enum { AXES = 2, MOVE = 8, PLATEN = 115000, WEIGHT = 9685600 }; /* steps of 1 ms, [kg], [N] */

static const rths_signal kSignals[] = {
    {"opf.newTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    RTHS_LONG_LAT("opf.", ".displ.target", "m", RTHS_INPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("opf.", ".veloc.target", "m/s", RTHS_INPUT, 0, 0, 0, 0),
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

/* The state is the number of steps that this move still has. */
static rths_status step(int* left, double time_s, const double* in, double* out) {
  const int has_target = in[NEW_TARGET] > 0;
  (void)time_s;
  if (has_target && *left == 0) *left = MOVE;
  const int moves = *left > has_target; /* the last step waits for the flag to fall */
  for (int i = 0; i < AXES; ++i) {
    const double end = in[TARGET + i] + in[DELAY] * in[VELOC + i];
    if (moves) out[REFERENCE + i] += (end - out[REFERENCE + i]) / *left;
    out[FEEDBACK + i] = in[DISPL + i];
    out[FED_FORCE + i] = out[SPECIMEN + i] = in[FORCE + i] - PLATEN * in[ACCEL + i];
  }
  *left -= moves;
  out[COMPRESSION] = WEIGHT + in[LOAD];
  out[AT_TARGET] = *left == 0;
  out[SWITCH] = has_target;
  return RTHS_OK;
}
RTHS_SIMPLE_ADAPTER(int, "@NAME@", "0.1", kSignals, step)
