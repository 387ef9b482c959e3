/* SPDX-License-Identifier: Apache-2.0
 *
 * The user's simulation of a trial, as an FMU of FMI 2: up to three masses in a chain of springs on
 * a shaking ground, by the semi-implicit method of Euler with one step per communication step.
 *     m_i a_i = −m_i a_ground + s_(i+1) − s_i,   s_i = k_i d_i + c_i d_i' − f_i,   d_i = y_i −
 * y_(i−1) A mass of 0 is absent. */
#include <stddef.h>
#include <string.h>

#include <rths/fmi/fmi2.h>

enum { MASSES = 3 };
enum {
  GROUND,
  FORCE,
  MASS = 4,
  STIFFNESS = 7,
  DAMPING = 10,
  POSITION = 13,
  DEFORMATION = 16,
  RATE = 19,
  END = 22
};

typedef struct {
  double value[END];    /* by value reference */
  double speed[MASSES]; /* of the masses [m/s] */
  const fmi2CallbackFunctions* calls;
} Chain;

fmi2GetVersionTYPE fmi2GetVersion;
fmi2InstantiateTYPE fmi2Instantiate;
fmi2FreeInstanceTYPE fmi2FreeInstance;
fmi2SetupExperimentTYPE fmi2SetupExperiment;
fmi2EnterInitializationModeTYPE fmi2EnterInitializationMode;
fmi2ExitInitializationModeTYPE fmi2ExitInitializationMode;
fmi2TerminateTYPE fmi2Terminate;
fmi2ResetTYPE fmi2Reset;
fmi2DoStepTYPE fmi2DoStep;
fmi2GetRealStatusTYPE fmi2GetRealStatus;
fmi2GetBooleanStatusTYPE fmi2GetBooleanStatus;
fmi2GetRealTYPE fmi2GetReal;
fmi2SetRealTYPE fmi2SetReal;
fmi2GetIntegerTYPE fmi2GetInteger;
fmi2SetIntegerTYPE fmi2SetInteger;
fmi2GetBooleanTYPE fmi2GetBoolean;
fmi2SetBooleanTYPE fmi2SetBoolean;

const char* fmi2GetVersion(void) { return "2.0"; }

fmi2Component fmi2Instantiate(fmi2String instance, fmi2Type type, fmi2String guid,
                              fmi2String resources, const fmi2CallbackFunctions* calls,
                              fmi2Boolean visible, fmi2Boolean logging) {
  (void)instance, (void)guid, (void)resources, (void)visible, (void)logging;
  if (type != fmi2CoSimulation) return NULL;
  Chain* chain = calls->allocateMemory(1, sizeof *chain);
  if (chain != NULL) chain->calls = calls;
  return chain;
}

void fmi2FreeInstance(fmi2Component c) { ((Chain*)c)->calls->freeMemory(c); }

fmi2Status fmi2Reset(fmi2Component c) {
  Chain* chain = c;
  memset(chain->value, 0, sizeof chain->value);
  memset(chain->speed, 0, sizeof chain->speed);
  return fmi2OK;
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                               fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
  return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) { return (void)c, fmi2OK; }
fmi2Status fmi2ExitInitializationMode(fmi2Component c) { return (void)c, fmi2OK; }
fmi2Status fmi2Terminate(fmi2Component c) { return (void)c, fmi2OK; }

fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real step, fmi2Boolean is_final) {
  Chain* chain = c;
  double* value = chain->value;
  double spring[MASSES + 1] = {0};
  (void)time, (void)is_final;
  for (int i = 0; i < MASSES; ++i)
    spring[i] = value[STIFFNESS + i] * value[DEFORMATION + i] +
                value[DAMPING + i] * value[RATE + i] - value[FORCE + i];
  for (int i = 0; i < MASSES && value[MASS + i] > 0; ++i) {
    const double above = i + 1 < MASSES && value[MASS + i + 1] > 0 ? spring[i + 1] : 0;
    const double acceleration = (above - spring[i]) / value[MASS + i] - value[GROUND];
    chain->speed[i] += step * acceleration;
    value[POSITION + i] += step * chain->speed[i];
  }
  for (int i = 0; i < MASSES && value[MASS + i] > 0; ++i) {
    value[DEFORMATION + i] = value[POSITION + i] - (i > 0 ? value[POSITION + i - 1] : 0);
    value[RATE + i] = chain->speed[i] - (i > 0 ? chain->speed[i - 1] : 0);
  }
  return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                       fmi2Real values[]) {
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] >= END) return fmi2Error;
    values[i] = ((Chain*)c)->value[refs[i]];
  }
  return fmi2OK;
}

fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference refs[], size_t n,
                       const fmi2Real values[]) {
  for (size_t i = 0; i < n; ++i) {
    if (refs[i] >= POSITION) return fmi2Error;
    ((Chain*)c)->value[refs[i]] = values[i];
  }
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
