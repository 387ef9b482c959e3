/* SPDX-License-Identifier: Apache-2.0
 *
 * Types and functions of the Functional Mock-up Interface 3.0 that co-simulation uses, from the
 * standard's text (https://fmi-standard.org). C11 and C++20. */
#ifndef RTHS_FMI3_H
#define RTHS_FMI3_H

#include <stddef.h>
#include <stdint.h>
#ifndef __cplusplus
#include <stdbool.h>
#endif

#ifdef __cplusplus
extern "C" {
#endif

typedef void* fmi3Instance;
typedef void* fmi3InstanceEnvironment;
typedef uint32_t fmi3ValueReference;
typedef float fmi3Float32;
typedef double fmi3Float64;
typedef int8_t fmi3Int8;
typedef uint8_t fmi3UInt8;
typedef int16_t fmi3Int16;
typedef uint16_t fmi3UInt16;
typedef int32_t fmi3Int32;
typedef uint32_t fmi3UInt32;
typedef int64_t fmi3Int64;
typedef uint64_t fmi3UInt64;
typedef bool fmi3Boolean;
typedef const char* fmi3String;

typedef enum { fmi3OK, fmi3Warning, fmi3Discard, fmi3Error, fmi3Fatal } fmi3Status;

typedef void (*fmi3LogMessageCallback)(fmi3InstanceEnvironment environment, fmi3Status status,
                                       fmi3String category, fmi3String message);
typedef void (*fmi3IntermediateUpdateCallback)(fmi3InstanceEnvironment environment,
                                               fmi3Float64 time, fmi3Boolean set_requested,
                                               fmi3Boolean get_allowed, fmi3Boolean step_finished,
                                               fmi3Boolean can_return_early,
                                               fmi3Boolean* return_requested,
                                               fmi3Float64* return_time);

typedef const char* fmi3GetVersionTYPE(void);
typedef fmi3Instance fmi3InstantiateCoSimulationTYPE(
    fmi3String instance, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean uses_event_mode, fmi3Boolean allows_early_return,
    const fmi3ValueReference intermediate_variables[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback intermediate_update);
typedef void fmi3FreeInstanceTYPE(fmi3Instance instance);
typedef fmi3Status fmi3EnterInitializationModeTYPE(fmi3Instance instance, fmi3Boolean has_tolerance,
                                                   fmi3Float64 tolerance, fmi3Float64 start,
                                                   fmi3Boolean has_stop, fmi3Float64 stop);
typedef fmi3Status fmi3ExitInitializationModeTYPE(fmi3Instance instance);
typedef fmi3Status fmi3TerminateTYPE(fmi3Instance instance);
typedef fmi3Status fmi3ResetTYPE(fmi3Instance instance);
typedef fmi3Status fmi3DoStepTYPE(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                                  fmi3Boolean is_final, fmi3Boolean* needs_event,
                                  fmi3Boolean* terminates, fmi3Boolean* returned_early,
                                  fmi3Float64* last_time);

/* fmi3GetFloat64TYPE, fmi3SetFloat64TYPE and those of the other types of numbers. */
#define RTHS_FMI3_ACCESS(NUMBER)                                                            \
  typedef fmi3Status fmi3Get##NUMBER##TYPE(                                                 \
      fmi3Instance instance, const fmi3ValueReference references[], size_t reference_count, \
      fmi3##NUMBER values[], size_t count);                                                 \
  typedef fmi3Status fmi3Set##NUMBER##TYPE(                                                 \
      fmi3Instance instance, const fmi3ValueReference references[], size_t reference_count, \
      const fmi3##NUMBER values[], size_t count);
RTHS_FMI3_ACCESS(Float32)
RTHS_FMI3_ACCESS(Float64)
RTHS_FMI3_ACCESS(Int8)
RTHS_FMI3_ACCESS(UInt8)
RTHS_FMI3_ACCESS(Int16)
RTHS_FMI3_ACCESS(UInt16)
RTHS_FMI3_ACCESS(Int32)
RTHS_FMI3_ACCESS(UInt32)
RTHS_FMI3_ACCESS(Int64)
RTHS_FMI3_ACCESS(UInt64)
RTHS_FMI3_ACCESS(Boolean)
#undef RTHS_FMI3_ACCESS

#ifdef __cplusplus
}
#endif

#endif
