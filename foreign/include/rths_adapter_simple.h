/* SPDX-License-Identifier: Apache-2.0
 *
 * The common case of rths_adapter.h in C: an adapter without settings, whose state is one struct
 * that is all zero at the start and at a restart. The signals are an array, `step` takes a pointer
 * to the struct:
 *
 *     static rths_status step(Machine* machine, double time_s, const double* in, double* out);
 *     RTHS_SIMPLE_ADAPTER(Machine, "machine", "1.0", kSignals, step)
 */
#ifndef RTHS_ADAPTER_SIMPLE_H
#define RTHS_ADAPTER_SIMPLE_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rths_adapter.h"

#define RTHS_SIMPLE_ADAPTER(STATE, NAME, VERSION, SIGNALS, STEP)                           \
  static void* rths_create(const char* config_toml, char* error, uint32_t error_size) {    \
    void* self = calloc(1, sizeof(STATE));                                                 \
    (void)config_toml;                                                                     \
    if (self == NULL) snprintf(error, error_size, "no memory");                            \
    return self;                                                                           \
  }                                                                                        \
  static const rths_signal* rths_signals(void* self, uint32_t* count) {                    \
    (void)self;                                                                            \
    *count = sizeof(SIGNALS) / sizeof *(SIGNALS);                                          \
    return SIGNALS;                                                                        \
  }                                                                                        \
  static rths_status rths_activate(void* self, char* error, uint32_t error_size) {         \
    (void)error, (void)error_size;                                                         \
    memset(self, 0, sizeof(STATE));                                                        \
    return RTHS_OK;                                                                        \
  }                                                                                        \
  static rths_status rths_step(void* self, double time_s, const double* in, double* out) { \
    return STEP((STATE*)self, time_s, in, out);                                            \
  }                                                                                        \
  static void rths_deactivate(void* self) { (void)self; }                                  \
  const rths_adapter* rths_adapter_entry(void) {                                           \
    static const rths_adapter adapter = {RTHS_ADAPTER_ABI,                                 \
                                         sizeof(rths_adapter),                             \
                                         NAME,                                             \
                                         VERSION,                                          \
                                         rths_create,                                      \
                                         rths_signals,                                     \
                                         rths_activate,                                    \
                                         rths_step,                                        \
                                         rths_deactivate,                                  \
                                         free,                                             \
                                         NULL,                                             \
                                         NULL};                                            \
    return &adapter;                                                                       \
  }

#endif
