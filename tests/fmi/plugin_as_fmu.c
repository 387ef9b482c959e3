/* SPDX-License-Identifier: Apache-2.0
 *
 * Any plugin as an FMU of FMI 3. resources/plugin.txt has the path of its library, then its
 * config. Variables: signal i of the plugin has the value reference i; `phase` is that of its
 * steps [s]. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rths_adapter.h>

#include "access3.h"

#define PHASE 100000
#define MOST_SIGNALS 2000
#define MOST_TEXT 4000

fmi3InstantiateCoSimulationTYPE fmi3InstantiateCoSimulation;
fmi3FreeInstanceTYPE fmi3FreeInstance;
fmi3EnterInitializationModeTYPE fmi3EnterInitializationMode;
fmi3ExitInitializationModeTYPE fmi3ExitInitializationMode;
fmi3TerminateTYPE fmi3Terminate;
fmi3DoStepTYPE fmi3DoStep;
fmi3GetFloat64TYPE fmi3GetFloat64;
fmi3SetFloat64TYPE fmi3SetFloat64;

UNUSED_ACCESS(Float32)
UNUSED_ACCESS(Int8)
UNUSED_ACCESS(UInt8)
UNUSED_ACCESS(Int16)
UNUSED_ACCESS(UInt16)
UNUSED_ACCESS(Int32)
UNUSED_ACCESS(UInt32)
UNUSED_ACCESS(Int64)
UNUSED_ACCESS(UInt64)
UNUSED_ACCESS(Boolean)

typedef struct {
  const rths_adapter* adapter;
  void* self;
  double* slot[MOST_SIGNALS]; /* of each signal, in `in` or `out` */
  double in[MOST_SIGNALS], out[MOST_SIGNALS];
  double phase;
  fmi3InstanceEnvironment environment;
  fmi3LogMessageCallback log;
} Bridge;

static int load(Bridge* bridge, const char* resources, char* error) {
  char path[MOST_TEXT], text[MOST_TEXT];
  snprintf(path, sizeof path, "%splugin.txt", resources);
  FILE* file = fopen(path, "r");
  if (file == NULL) return 0;
  const size_t size = fread(text, 1, sizeof text - 1, file);
  text[size] = '\0';
  fclose(file);
  char* config = strchr(text, '\n');
  *config++ = '\0';
  void* library = dlopen(text, RTLD_NOW);
  if (library == NULL) return 0;
  const rths_adapter* (*entry)(void) =
      (const rths_adapter* (*)(void))dlsym(library, "rths_adapter_entry");
  bridge->adapter = entry();
  bridge->self = bridge->adapter->create(config, error, MOST_TEXT);
  return bridge->self != NULL;
}

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instance, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean uses_event_mode, fmi3Boolean allows_early_return,
    const fmi3ValueReference intermediate_variables[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback intermediate_update) {
  (void)instance, (void)token, (void)visible, (void)logging, (void)uses_event_mode;
  (void)allows_early_return, (void)intermediate_variables, (void)intermediate_count;
  (void)intermediate_update;
  char error[MOST_TEXT] = "no plugin";
  Bridge* bridge = calloc(1, sizeof *bridge);
  bridge->environment = environment;
  bridge->log = log;
  if (!load(bridge, resources, error)) {
    log(environment, fmi3Error, "log", error);
    free(bridge);
    return NULL;
  }
  uint32_t count = 0;
  const rths_signal* signals = bridge->adapter->signals(bridge->self, &count);
  double *in = bridge->in, *out = bridge->out;
  for (uint32_t i = 0; i < count; ++i) {
    const int is_read =
        signals[i].direction == RTHS_INPUT || signals[i].direction == RTHS_PARAMETER;
    bridge->slot[i] = is_read ? in++ : out++;
    if (signals[i].direction == RTHS_PARAMETER) *bridge->slot[i] = signals[i].initial;
  }
  return bridge;
}

void fmi3FreeInstance(fmi3Instance c) {
  Bridge* bridge = c;
  bridge->adapter->destroy(bridge->self);
  free(bridge);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance,
                                       fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean has_stop, fmi3Float64 stop) {
  (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
  Bridge* bridge = c;
  char error[MOST_TEXT] = "";
  if (bridge->adapter->activate(bridge->self, error, sizeof error) == RTHS_OK) return fmi3OK;
  bridge->log(bridge->environment, fmi3Error, "log", error);
  return fmi3Error;
}

fmi3Status fmi3Terminate(fmi3Instance c) {
  Bridge* bridge = c;
  bridge->adapter->deactivate(bridge->self);
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean is_final,
                      fmi3Boolean* needs_event, fmi3Boolean* terminates,
                      fmi3Boolean* returned_early, fmi3Float64* last_time) {
  Bridge* bridge = c;
  (void)is_final;
  *needs_event = *terminates = *returned_early = false;
  *last_time = time + step;
  const rths_status status =
      bridge->adapter->step(bridge->self, time + bridge->phase, bridge->in, bridge->out);
  return status == RTHS_FAULT ? fmi3Error : fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          fmi3Float64 values[], size_t count) {
  (void)count;
  for (size_t i = 0; i < n; ++i) values[i] = *((Bridge*)c)->slot[refs[i]];
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          const fmi3Float64 values[], size_t count) {
  Bridge* bridge = c;
  (void)count;
  for (size_t i = 0; i < n; ++i)
    *(refs[i] == PHASE ? &bridge->phase : bridge->slot[refs[i]]) = values[i];
  return fmi3OK;
}
