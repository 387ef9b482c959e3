/* SPDX-License-Identifier: Apache-2.0
 *
 * The lag as an FMU of FMI 2. */
#include "lag.h"

#include <rths/fmi/fmi2.h>

fmi2GetVersionTYPE fmi2GetVersion;
fmi2InstantiateTYPE fmi2Instantiate;
fmi2FreeInstanceTYPE fmi2FreeInstance;
fmi2SetupExperimentTYPE fmi2SetupExperiment;
fmi2EnterInitializationModeTYPE fmi2EnterInitializationMode;
fmi2ExitInitializationModeTYPE fmi2ExitInitializationMode;
fmi2TerminateTYPE fmi2Terminate;
fmi2DoStepTYPE fmi2DoStep;
fmi2GetRealStatusTYPE fmi2GetRealStatus;
fmi2GetBooleanStatusTYPE fmi2GetBooleanStatus;
fmi2GetRealTYPE fmi2GetReal;
fmi2SetRealTYPE fmi2SetReal;
fmi2GetIntegerTYPE fmi2GetInteger;
fmi2SetIntegerTYPE fmi2SetInteger;
fmi2GetBooleanTYPE fmi2GetBoolean;
fmi2SetBooleanTYPE fmi2SetBoolean;

static void log_line(void* self, int status, const char* message) {
  Lag* lag = self;
  const fmi2CallbackFunctions* calls = lag->callback;
  calls->logger(lag->environment, "lag", (fmi2Status)status, "log", "%s", message);
}

const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String instance, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions* calls,
                              fmi2Boolean visible, fmi2Boolean logging) {
  (void)instance, (void)visible;
  if (type != fmi2CoSimulation || strncmp(resources, "file:///", 8) != 0) return NULL;
  if (strcmp(guid, TOKEN) != 0) {
    calls->logger(calls->componentEnvironment, "lag", fmi2Error, "log", "wrong %s '%s'", "GUID",
                  guid);
    return NULL;
  }
  Lag* lag = calls->allocateMemory(1, sizeof *lag);
  lag_reset(lag);
  lag->callback = (void*)calls;
  lag->environment = calls->componentEnvironment;
  lag->log = log_line;
  lag->logs = logging;
  lag_log(lag, "instantiate");
  return lag;
}

void fmi2FreeInstance(fmi2Component c) {
  Lag* lag = c;
  lag_log(lag, "free");
  ((const fmi2CallbackFunctions*)lag->callback)->freeMemory(lag);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)has_tolerance, (void)tolerance, (void)has_stop, (void)stop;
  ((Lag*)c)->time = start;
  lag_log(c, "setup");
  return lag_is_in(c, 1 << INSTANTIATED, "setup") ? fmi2OK : fmi2Error;
}

fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
  if (!lag_is_in(c, 1 << INSTANTIATED, "enter")) return fmi2Error;
  lag_log(c, "enter");
  ((Lag*)c)->state = INITIALIZATION;
  return fmi2OK;
}

fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
#ifdef INITIALIZATION_FAILS
  ((Lag*)c)->log(c, 3, "no equilibrium");
  return fmi2Error;
#endif
  if (!lag_is_in(c, 1 << INITIALIZATION, "exit")) return fmi2Error;
  lag_log(c, "exit");
  ((Lag*)c)->state = STEPPING;
  return fmi2OK;
}

fmi2Status fmi2Terminate(fmi2Component c) {
  if (!lag_is_in(c, 1 << STEPPING, "terminate")) return fmi2Error;
  lag_log(c, "terminate");
  ((Lag*)c)->state = TERMINATED;
  return fmi2OK;
}

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean is_final) {
  (void)is_final;
  if (!lag_is_in(c, 1 << STEPPING, "step")) return fmi2Error;
#ifdef IS_PENDING
  return fmi2Pending;
#endif
#ifdef TERMINATES
  if (((Lag*)c)->count >= LATER) return fmi2Discard;
#endif
  return (fmi2Status)lag_step(c, time, step);
}

fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  *value = ((Lag*)c)->time + 0.0005;
  return kind == fmi2LastSuccessfulTime ? fmi2OK : fmi2Discard;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  (void)c, (void)kind;
#ifdef TERMINATES
  *value = fmi2True;
#else
  *value = fmi2False;
#endif
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                       fmi2Real values[]) {
  Lag* lag = c;
#ifdef GIVES_NOTHING
  return fmi2OK;
#endif
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] == Y || refs[i] == ANGLE)
      values[i] = lag->y;
    else if (refs[i] == TEMPERATURE)
      values[i] = 20;
    else
      return fmi2Error;
  }
  return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                       const fmi2Real values[]) {
  Lag* lag = c;
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] == TAU && !lag_is_in(c, 1 << INSTANTIATED, "set")) return fmi2Error;
    if (refs[i] == U)
      lag->u = values[i];
    else if (refs[i] == TAU)
      lag->tau = values[i];
    else if (refs[i] == GAIN)
      lag->gain = values[i];
    else
      return fmi2Error;
  }
  return fmi2OK;
}

fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          fmi2Integer values[]) {
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] != COUNT) return fmi2Error;
    values[i] = ((Lag*)c)->count;
  }
  return fmi2OK;
}

fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          const fmi2Integer values[]) {
  if (n != 1 || refs[0] != LEVEL) return fmi2Error;
  ((Lag*)c)->level = values[0];
  return fmi2OK;
}

fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          fmi2Boolean values[]) {
  (void)c, (void)refs, (void)n, (void)values;
  return fmi2Error;
}

fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          const fmi2Boolean values[]) {
  if (n != 1 || refs[0] != ENABLED) return fmi2Error;
  ((Lag*)c)->enabled = values[0];
  return fmi2OK;
}
