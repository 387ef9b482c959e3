/* SPDX-License-Identifier: Apache-2.0
 *
 * A unit mass on a spring under a force as an FMU of FMI 2: x'' = F − k x − c v. Its states x and v
 * can be set. Where e > 0, it bounces from a floor at x = 0 and keeps the share e of its speed.
 * With the definition HIDDEN_STATE, it also counts its steps, which no variable shows, and its mass
 * grows. */
#include <stddef.h>
#include <string.h>

#include <rths/fmi/fmi2.h>

enum { X, V, F, K, C, E, END };

typedef struct {
  double value[END];
  int steps;
  const fmi2CallbackFunctions* calls;
} Mass;

fmi2GetVersionTYPE fmi2GetVersion;
fmi2InstantiateTYPE fmi2Instantiate;
fmi2FreeInstanceTYPE fmi2FreeInstance;
fmi2SetupExperimentTYPE fmi2SetupExperiment;
fmi2EnterInitializationModeTYPE fmi2EnterInitializationMode, fmi2ExitInitializationMode;
fmi2TerminateTYPE fmi2Terminate;
fmi2ResetTYPE fmi2Reset;
fmi2DoStepTYPE fmi2DoStep;
fmi2GetRealStatusTYPE fmi2GetRealStatus;
fmi2GetBooleanStatusTYPE fmi2GetBooleanStatus;
fmi2GetRealTYPE fmi2GetReal;
fmi2SetRealTYPE fmi2SetReal;
fmi2GetIntegerTYPE fmi2GetInteger, fmi2GetBoolean;
fmi2SetIntegerTYPE fmi2SetInteger, fmi2SetBoolean;

const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String instance, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions* calls,
                              fmi2Boolean visible, fmi2Boolean logging) {
  (void)instance, (void)type, (void)guid, (void)resources, (void)visible, (void)logging;
  Mass* mass = calls->allocateMemory(1, sizeof *mass);
  mass->calls = calls;
  return mass;
}
void fmi2FreeInstance(fmi2Component c) { ((Mass*)c)->calls->freeMemory(c); }

fmi2Status fmi2Reset(fmi2Component c) {
  memset(((Mass*)c)->value, 0, sizeof((Mass*)c)->value);
  ((Mass*)c)->steps = 0;
  return fmi2OK;
}
fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  return (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop,
         fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return (void)c, fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return (void)c, fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return (void)c, fmi2OK; }

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean is_final) {
  Mass* mass = c;
  (void)time, (void)is_final;
  double* value = mass->value;
  double acceleration = value[F] - value[K] * value[X] - value[C] * value[V];
#ifdef HIDDEN_STATE
  acceleration /= 1 + 0.1 * ++mass->steps;
#endif
  value[V] += step * acceleration;
  value[X] += step * (value[V] - step / 2 * acceleration);
  if (value[E] > 0 && value[X] <= 0 && value[V] < 0) value[X] = 0, value[V] *= -value[E];
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                       fmi2Real values[]) {
  for (size_t i = 0; i < n; ++i) values[i] = ((Mass*)c)->value[refs[i]];
  return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                       const fmi2Real values[]) {
  for (size_t i = 0; i < n; ++i) ((Mass*)c)->value[refs[i]] = values[i];
  return fmi2OK;
}

fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real* value) {
  return (void)c, (void)kind, (void)value, fmi2Discard;
}
fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean* value) {
  return (void)c, (void)kind, (void)value, fmi2Discard;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          fmi2Integer values[]) {
  return (void)c, (void)refs, (void)n, (void)values, fmi2Error;
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          const fmi2Integer values[]) {
  return (void)c, (void)refs, (void)n, (void)values, fmi2Error;
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          fmi2Boolean values[]) {
  return (void)c, (void)refs, (void)n, (void)values, fmi2Error;
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                          const fmi2Boolean values[]) {
  return (void)c, (void)refs, (void)n, (void)values, fmi2Error;
}
