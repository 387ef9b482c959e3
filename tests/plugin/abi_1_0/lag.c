/* SPDX-License-Identifier: Apache-2.0
 *
 * A first-order lag, built against the frozen header of minor 0. */
#include <stdlib.h>

#include "rths_adapter.h"

static const rths_signal kSignals[] = {
    {"xpc.long.displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0},
    {"srmd.long.displ.fbk", "m", RTHS_OUTPUT, RTHS_RAMP, 0, 0, 0},
};

static void* create(const char* config, char* error, uint32_t size) {
  (void)config, (void)error, (void)size;
  return calloc(1, sizeof(double));
}

static const rths_signal* list(void* self, uint32_t* count) {
  (void)self;
  *count = 2;
  return kSignals;
}

static rths_status activate(void* self, char* error, uint32_t size) {
  (void)error, (void)size;
  *(double*)self = 0;
  return RTHS_OK;
}

static rths_status step(void* self, double time, const double* in, double* out) {
  (void)time;
  double* x = self;
  *x += 0.5 * (in[0] - *x);
  out[0] = *x;
  return RTHS_OK;
}

static void deactivate(void* self) { (void)self; }

const rths_adapter* rths_adapter_entry(void) {
  static const rths_adapter adapter = {RTHS_ADAPTER_ABI,
                                       sizeof(rths_adapter),
                                       "lag",
                                       "1.0",
                                       create,
                                       list,
                                       activate,
                                       step,
                                       deactivate,
                                       free};
  return &adapter;
}
