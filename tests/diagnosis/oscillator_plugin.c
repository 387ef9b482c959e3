/* SPDX-License-Identifier: Apache-2.0
 *
 * A simulation as an adapter: a mass on a spring, pushed by a force. The mass is a key of its
 * configuration, stiffness and damping are parameters.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rths_adapter.h>

typedef struct {
  double mass, x, v, last_force, last_s; /* [kg], [m], [m/s], [N], [s] */
} Mass;

static const rths_signal kSignals[] = {
    {"lab.push", "N", RTHS_INPUT, 0, 0, 0, 0},
    {"stiffness", "N/m", RTHS_PARAMETER, 0, 2000, 0, 0},
    {"damping", "N.s/m", RTHS_PARAMETER, 0, 8, 0, 0},
    {"lab.displ", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"velocity", "m/s", RTHS_MONITOR, 0, 0, 0, 0},
#ifdef TWO_INPUTS
    {"lab.pull", "N", RTHS_INPUT, 0, 0, 0, 0},
#endif
};

static void* create(const char* config_toml, char* error, uint32_t error_size) {
  const char* const key = strstr(config_toml, "mass_kg = ");
  Mass* self = calloc(1, sizeof *self);
  if (key != NULL) self->mass = atof(key + strlen("mass_kg = "));
  if (!(self->mass > 0)) {
    snprintf(error, error_size, "mass_kg is %g, expected a positive number", self->mass);
    free(self);
    return NULL;
  }
  return self;
}
static const rths_signal* signals(void* self, uint32_t* count) {
  (void)self;
  *count = sizeof kSignals / sizeof *kSignals;
  return kSignals;
}
static rths_status activate(void* self, char* error, uint32_t error_size) {
  (void)self, (void)error, (void)error_size;
  return RTHS_OK;
}
static rths_status step(void* data, double time_s, const double* in, double* out) {
  Mass* const self = data;
  const double h = time_s - self->last_s;
  const double a =
      (0.5 * (self->last_force + in[0]) - in[1] * self->x - in[2] * self->v) / self->mass;
  self->v += h * a;
  self->x += h * (self->v - h / 2 * a);
  self->last_force = in[0], self->last_s = time_s;
  out[0] = self->x, out[1] = self->v;
  return fabs(self->x) > 1e3 ? RTHS_FAULT : RTHS_OK;
}
static void deactivate(void* self) { (void)self; }
static const char* message(void* self) {
  (void)self;
  return "the spring broke";
}

const rths_adapter* rths_adapter_entry(void) {
  static const rths_adapter adapter = {RTHS_ADAPTER_ABI,
                                       sizeof(rths_adapter),
                                       "mass",
                                       "1.0",
                                       create,
                                       signals,
                                       activate,
                                       step,
                                       deactivate,
                                       free,
                                       NULL,
                                       message};
  return &adapter;
}
