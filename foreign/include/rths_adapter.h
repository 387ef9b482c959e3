/* SPDX-License-Identifier: Apache-2.0
 *
 * The interface between a program that runs a hybrid test and an adapter in a shared library.
 * C11 and C++20. The library exports one symbol, rths_adapter_entry. An adapter exchanges arrays of
 * numbers in SI units and never sees the ring: the same library runs inside a node, in a process of
 * its own, in virtual time, and on a recording.
 *
 * [setup] functions may allocate and open files. [realtime] functions return within a fraction of
 * the period: no heap, no lock, no file, every loop bounded. All calls come from one thread at a
 * time. Several adapters of one library can exist at once.
 */
#ifndef RTHS_ADAPTER_H
#define RTHS_ADAPTER_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Version of this interface: major << 16 | minor. A new minor only appends members to rths_adapter:
 * adapters of an older or newer minor load. A new major changes the meaning of a member; adapters
 * of another major are refused. rths_signal does not change within a major version. */
#define RTHS_ADAPTER_ABI_MAJOR 1u
#define RTHS_ADAPTER_ABI_MINOR 1u
#define RTHS_ADAPTER_ABI ((RTHS_ADAPTER_ABI_MAJOR << 16) | RTHS_ADAPTER_ABI_MINOR)

typedef int32_t rths_status;
enum {
  RTHS_OK = 0,
  RTHS_DONE = 1,           /* finished and at rest: this node may leave the test */
  RTHS_STALE = 2,          /* no new input; the last values were held */
  RTHS_LIMIT_EXCEEDED = 3, /* an output was clamped to a limit */
  RTHS_FAULT = 4           /* cannot continue; every node comes to rest */
};

/* Direction of a signal. */
enum {
  RTHS_INPUT = 0,    /* read from a signal of the laboratory's map, by its full name */
  RTHS_OUTPUT = 1,   /* written to a signal of the laboratory's map */
  RTHS_MONITOR = 2,  /* written to monitor.<node>.<name>, to display and record */
  RTHS_PARAMETER = 3 /* read from tune.<node>.<name>: a setting that may change during a run */
};

/* Flags of a signal. */
enum {
  RTHS_EVENT = 1, /* of a monitor: the recording lists each change */
  RTHS_RAMP = 2   /* of an output, without `stop`: held at the stop, then ramped to 0 */
};

/* One value of each step. */
typedef struct rths_signal {
  const char* name;
  const char* unit; /* SI: "m", "N", "m/s2", "rad", "1" */
  uint32_t direction;
  uint32_t flags;
  double initial; /* of a parameter [unit] */
  double lowest;  /* range of a parameter, output or monitor [unit]; */
  double highest; /* none if both are 0 */
} rths_signal;

/* Two entries of a table of signals, of the axes long and lat; then as in rths_signal from `unit`.
 *     RTHS_LONG_LAT("xpc.", ".displ.ref", "m", RTHS_INPUT, 0, 0, 0, 0) */
#define RTHS_LONG_LAT(NODE, QUANTITY, ...) \
  {NODE "long" QUANTITY, __VA_ARGS__}, { NODE "lat" QUANTITY, __VA_ARGS__ }

typedef struct rths_adapter {
  uint32_t abi;         /* RTHS_ADAPTER_ABI */
  uint32_t struct_size; /* sizeof(rths_adapter) */
  const char* name;
  const char* version;
  /* [setup] Makes an adapter. config_toml: table `config` of the node, as TOML text. On failure
   * returns NULL with a message: found, expected. */
  void* (*create)(const char* config_toml, char* error, uint32_t error_size);
  /* [setup] The signals, always the same; valid until destroy. */
  const rths_signal* (*signals)(void* self, uint32_t* count);
  /* [setup] Takes the initial state; last chance to allocate. On failure returns RTHS_FAULT with a
   * message. */
  rths_status (*activate)(void* self, char* error, uint32_t error_size);
  /* [realtime] One period. time_s: scheduled time since the start [s]. in: inputs and parameters,
   * out: outputs and monitors, each in the order of `signals`. out keeps its values from step to
   * step, at first 0 or the value on the ring; `in` must not be written. */
  rths_status (*step)(void* self, double time_s, const double* in, double* out);
  /* [setup] Releases the resources of activate, which may follow again. */
  void (*deactivate)(void* self);
  /* [setup] Not while active. */
  void (*destroy)(void* self);
  /* Since minor 1; both may be NULL. */
  /* [realtime] The test is over or a peer is lost. From the next step on, come to rest; return
   * RTHS_DONE at rest, within two seconds. Without it, outputs with RTHS_RAMP are ramped to 0. */
  void (*stop)(void* self);
  /* [realtime] Reason of the last RTHS_FAULT; valid until the next call. */
  const char* (*message)(void* self);
} rths_adapter;

/* The only exported symbol. */
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const rths_adapter*
rths_adapter_entry(void);

#ifdef __cplusplus
}
#endif

#endif
