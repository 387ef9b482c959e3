/* A test machine: a valve and a platen follow the reference, and the specimen is a spring. */
#include <rths_adapter_simple.h>

enum { AXES = 2, LOAD = AXES, BANDWIDTH, STIFFNESS, PLATEN };                  /* of the inputs */
enum { DISPLACEMENT, ACCELERATION = 2, FORCE = 4, ECHO = 6, COMPRESSION = 8 }; /* of the outputs */
static const double kStroke = 1.5, kDamping = 0.7, kValve = 0.01;              /* [m], [-], [s] */

static const rths_signal kSignals[] = {
    RTHS_LONG_LAT("xpc.", ".displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0),
    {"xpc.compression.force.ref", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"bandwidth", "rad/s", RTHS_PARAMETER, 0, 40, 1, 500},
    {"stiffness", "N/m", RTHS_PARAMETER, 0, 5e6, 0, 1e9},
    {"platen", "kg", RTHS_PARAMETER, 0, 115e3, 0, 1e6},
    RTHS_LONG_LAT("srmd.", ".displ.fbk", "m", RTHS_OUTPUT, 0, 0, -1.5, 1.5),
    RTHS_LONG_LAT("srmd.", ".accel.fbk", "m/s2", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0),
    RTHS_LONG_LAT("srmd.", ".displ.ref_echo", "m", RTHS_OUTPUT, 0, 0, 0, 0),
    {"srmd.compression.force.fbk", "N", RTHS_OUTPUT, 0, 0, 0, 0},
};

typedef struct {
  double valve[AXES], displacement[AXES], velocity[AXES], last_time; /* [m], [m], [m/s], [s] */
} Machine;

static rths_status step(Machine* machine, double time_s, const double* in, double* out) {
  const double passed = time_s - machine->last_time, bandwidth = in[BANDWIDTH];
  rths_status status = RTHS_OK;
  for (int i = 0; i < AXES; ++i) {
    double *x = &machine->displacement[i], *v = &machine->velocity[i], *valve = &machine->valve[i];
    *valve += (in[i] - *valve) * passed / (passed + kValve);
    const double acceleration = bandwidth * (bandwidth * (*valve - *x) - 2 * kDamping * *v);
    *v += acceleration * passed;
    *x += *v * passed;
    if (*x < -kStroke || *x > kStroke) status = RTHS_LIMIT_EXCEEDED;
    *x = *x < -kStroke ? -kStroke : *x > kStroke ? kStroke : *x;
    out[DISPLACEMENT + i] = *x;
    out[ACCELERATION + i] = acceleration;
    out[FORCE + i] = in[STIFFNESS] * *x + in[PLATEN] * acceleration;
    out[ECHO + i] = in[i];
  }
  out[COMPRESSION] = in[LOAD];
  machine->last_time = time_s;
  return status;
}
RTHS_SIMPLE_ADAPTER(Machine, "@NAME@", "0.1", kSignals, step)
