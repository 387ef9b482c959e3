/* SPDX-License-Identifier: Apache-2.0
 *
 * Types and functions of the Functional Mock-up Interface 2.0 that co-simulation uses, from the
 * standard's text (https://fmi-standard.org). C11 and C++20. */
#ifndef RTHS_FMI2_H
#define RTHS_FMI2_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef void* fmi2Component;
typedef void* fmi2ComponentEnvironment;
typedef unsigned int fmi2ValueReference;
typedef double fmi2Real;
typedef int fmi2Integer;
typedef int fmi2Boolean;
typedef const char* fmi2String;
enum { fmi2False = 0, fmi2True = 1 };

typedef enum { fmi2OK, fmi2Warning, fmi2Discard, fmi2Error, fmi2Fatal, fmi2Pending } fmi2Status;
typedef enum { fmi2ModelExchange, fmi2CoSimulation } fmi2Type;
typedef enum {
  fmi2DoStepStatus,
  fmi2PendingStatus,
  fmi2LastSuccessfulTime,
  fmi2Terminated
} fmi2StatusKind;

typedef struct {
  void (*logger)(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                 fmi2String category, fmi2String message, ...);
  void* (*allocateMemory)(size_t count, size_t size);
  void (*freeMemory)(void* memory);
  void (*stepFinished)(fmi2ComponentEnvironment environment, fmi2Status status);
  fmi2ComponentEnvironment componentEnvironment;
} fmi2CallbackFunctions;

typedef const char* fmi2GetVersionTYPE(void);
typedef fmi2Component fmi2InstantiateTYPE(fmi2String instance, fmi2Type type, fmi2String guid,
                                          fmi2String resources, const fmi2CallbackFunctions* calls,
                                          fmi2Boolean visible, fmi2Boolean logging);
typedef void fmi2FreeInstanceTYPE(fmi2Component component);
typedef fmi2Status fmi2SetupExperimentTYPE(fmi2Component component, fmi2Boolean has_tolerance,
                                           fmi2Real tolerance, fmi2Real start, fmi2Boolean has_stop,
                                           fmi2Real stop);
typedef fmi2Status fmi2EnterInitializationModeTYPE(fmi2Component component);
typedef fmi2Status fmi2ExitInitializationModeTYPE(fmi2Component component);
typedef fmi2Status fmi2TerminateTYPE(fmi2Component component);
typedef fmi2Status fmi2ResetTYPE(fmi2Component component);
typedef fmi2Status fmi2GetRealTYPE(fmi2Component component, const fmi2ValueReference references[],
                                   size_t count, fmi2Real values[]);
typedef fmi2Status fmi2GetIntegerTYPE(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      fmi2Integer values[]);
typedef fmi2Status fmi2GetBooleanTYPE(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      fmi2Boolean values[]);
typedef fmi2Status fmi2SetRealTYPE(fmi2Component component, const fmi2ValueReference references[],
                                   size_t count, const fmi2Real values[]);
typedef fmi2Status fmi2SetIntegerTYPE(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      const fmi2Integer values[]);
typedef fmi2Status fmi2SetBooleanTYPE(fmi2Component component,
                                      const fmi2ValueReference references[], size_t count,
                                      const fmi2Boolean values[]);
typedef fmi2Status fmi2DoStepTYPE(fmi2Component component, fmi2Real time, fmi2Real step,
                                  fmi2Boolean is_final);
typedef fmi2Status fmi2GetRealStatusTYPE(fmi2Component component, fmi2StatusKind kind,
                                         fmi2Real* value);
typedef fmi2Status fmi2GetBooleanStatusTYPE(fmi2Component component, fmi2StatusKind kind,
                                            fmi2Boolean* value);

#ifdef __cplusplus
}
#endif

#endif
