/* SPDX-License-Identifier: Apache-2.0
 *
 * The lag as an FMU of FMI 3. */
#include "lag.h"

#include "access3.h"

fmi3GetVersionTYPE fmi3GetVersion;
fmi3InstantiateCoSimulationTYPE fmi3InstantiateCoSimulation;
fmi3FreeInstanceTYPE fmi3FreeInstance;
fmi3EnterInitializationModeTYPE fmi3EnterInitializationMode;
fmi3ExitInitializationModeTYPE fmi3ExitInitializationMode;
fmi3TerminateTYPE fmi3Terminate;
fmi3DoStepTYPE fmi3DoStep;
fmi3GetFloat64TYPE fmi3GetFloat64;
fmi3SetFloat64TYPE fmi3SetFloat64;
fmi3GetFloat32TYPE fmi3GetFloat32;
fmi3SetFloat32TYPE fmi3SetFloat32;
fmi3GetInt32TYPE fmi3GetInt32;
fmi3SetInt32TYPE fmi3SetInt32;
fmi3GetUInt8TYPE fmi3GetUInt8;
fmi3SetUInt8TYPE fmi3SetUInt8;
fmi3GetBooleanTYPE fmi3GetBoolean;
fmi3SetBooleanTYPE fmi3SetBoolean;

UNUSED_ACCESS(Int8)
UNUSED_ACCESS(Int16)
UNUSED_ACCESS(UInt16)
UNUSED_ACCESS(UInt32)
UNUSED_ACCESS(Int64)
UNUSED_ACCESS(UInt64)

static void log_line(void* self, int status, const char* message) {
  Lag* lag = self;
  ((fmi3LogMessageCallback)lag->callback)(lag->environment, (fmi3Status)status, "log", message);
}

const char* fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instance, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean uses_event_mode, fmi3Boolean allows_early_return,
    const fmi3ValueReference intermediate_variables[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback intermediate_update) {
  (void)instance, (void)visible, (void)intermediate_variables;
  if (uses_event_mode || allows_early_return || intermediate_count > 0 || intermediate_update)
    return NULL;
  if (resources[strlen(resources) - 1] != '/') return NULL;
  if (strcmp(token, TOKEN) != 0) {
    log(environment, fmi3Error, "log", "wrong instantiation token");
    return NULL;
  }
  Lag* lag = calloc(1, sizeof *lag);
  lag_reset(lag);
  lag->callback = (void*)log;
  lag->environment = environment;
  lag->log = log_line;
  lag->logs = logging;
  lag_log(lag, "instantiate");
  return lag;
}

void fmi3FreeInstance(fmi3Instance c) {
  lag_log(c, "free");
  free(c);
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean has_tolerance,
                                       fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean has_stop, fmi3Float64 stop) {
  (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
  if (!lag_is_in(c, 1 << INSTANTIATED, "enter")) return fmi3Error;
  lag_log(c, "enter");
  ((Lag*)c)->time = start;
  ((Lag*)c)->state = INITIALIZATION;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
#ifdef INITIALIZATION_FAILS
  ((Lag*)c)->log(c, 3, "no equilibrium");
  return fmi3Error;
#endif
  if (!lag_is_in(c, 1 << INITIALIZATION, "exit")) return fmi3Error;
  lag_log(c, "exit");
  ((Lag*)c)->state = STEPPING;
  return fmi3OK;
}

fmi3Status fmi3Terminate(fmi3Instance c) {
  if (!lag_is_in(c, 1 << STEPPING, "terminate")) return fmi3Error;
  lag_log(c, "terminate");
  ((Lag*)c)->state = TERMINATED;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 step, fmi3Boolean is_final,
                      fmi3Boolean* needs_event, fmi3Boolean* terminates,
                      fmi3Boolean* returned_early, fmi3Float64* last_time) {
  (void)is_final;
  if (!lag_is_in(c, 1 << STEPPING, "step")) return fmi3Error;
  const int status = lag_step(c, time, step);
  const int later = ((Lag*)c)->count > LATER;
  *needs_event = *terminates = *returned_early = false;
  *last_time = status == 0 ? time + step : time + step / 2;
#ifdef NEEDS_EVENT
  *needs_event = later;
#elif defined RETURNS_EARLY
  *returned_early = later;
#elif defined TERMINATES
  *terminates = later;
#endif
  (void)later;
  return (fmi3Status)status;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          fmi3Float64 values[], size_t count) {
  Lag* lag = c;
  if (n != count) return fmi3Error;
#ifdef GIVES_NOTHING
  return fmi3OK;
#endif
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] == Y || refs[i] == ANGLE)
      values[i] = lag->y;
    else if (refs[i] == TEMPERATURE)
      values[i] = 20;
    else
      return fmi3Error;
  }
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          const fmi3Float64 values[], size_t count) {
  Lag* lag = c;
  if (n != count) return fmi3Error;
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] == TAU && !lag_is_in(c, 1 << INSTANTIATED, "set")) return fmi3Error;
    if (refs[i] == U)
      lag->u = values[i];
    else if (refs[i] == TAU)
      lag->tau = values[i];
    else if (refs[i] == GAIN)
      lag->gain = values[i];
    else
      return fmi3Error;
  }
  return fmi3OK;
}

fmi3Status fmi3GetFloat32(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          fmi3Float32 values[], size_t count) {
  if (n != 1 || count != 1 || refs[0] != SINGLE) return fmi3Error;
  values[0] = (fmi3Float32)((Lag*)c)->y;
  return fmi3OK;
}

fmi3Status fmi3SetFloat32(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          const fmi3Float32 values[], size_t count) {
  (void)c, (void)refs, (void)n, (void)values, (void)count;
  return fmi3Error;
}

fmi3Status fmi3GetInt32(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                        fmi3Int32 values[], size_t count) {
  if (n != 1 || count != 1 || refs[0] != COUNT) return fmi3Error;
  values[0] = ((Lag*)c)->count;
  return fmi3OK;
}

fmi3Status fmi3SetInt32(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                        const fmi3Int32 values[], size_t count) {
  (void)c, (void)refs, (void)n, (void)values, (void)count;
  return fmi3Error;
}

/* The level as it was received: FMI 3 has no Integer, so it is a UInt8 here. */
fmi3Status fmi3GetUInt8(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                        fmi3UInt8 values[], size_t count) {
  if (n != 1 || count != 1 || refs[0] != LEVEL + 1) return fmi3Error;
  values[0] = (fmi3UInt8)((Lag*)c)->level;
  return fmi3OK;
}

fmi3Status fmi3SetUInt8(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                        const fmi3UInt8 values[], size_t count) {
  if (n != 1 || count != 1 || refs[0] != LEVEL) return fmi3Error;
  ((Lag*)c)->level = values[0];
  return fmi3OK;
}

fmi3Status fmi3GetBoolean(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          fmi3Boolean values[], size_t count) {
  (void)c, (void)refs, (void)n, (void)values, (void)count;
  return fmi3Error;
}

fmi3Status fmi3SetBoolean(fmi3Instance c, const fmi3ValueReference refs[], size_t n,
                          const fmi3Boolean values[], size_t count) {
  if (n != 1 || count != 1 || refs[0] != ENABLED) return fmi3Error;
  ((Lag*)c)->enabled = values[0];
  return fmi3OK;
}
