/* A test machine as an FMU of FMI 3: a first-order lag in each axis, and a specimen that is a
 * spring. An FMU exports all functions of the standard; those that this one does not need return an
 * error. */
#include <stdlib.h>
#include <string.h>

#include <rths/fmi/fmi3.h>

#define TOKEN "{5a5e0d2e-4a0f-4cf4-9f0e-0a6f1d0c2b77}" /* as in modelDescription.xml */

enum { AXES = 2, LIMIT_MM = 1500 };
/* Value references. Those of an axis follow each other. */
enum { REFERENCE = 0, DISPLACEMENT = 10, FORCE = 20, ECHO = 30, LAG = 40, STIFFNESS };

typedef struct {
  double reference[AXES], displacement[AXES]; /* [mm] */
  double lag;                                 /* [s] */
  double stiffness;                           /* [kN/mm] */
} Machine;

const char* fmi3GetVersion(void) { return "3.0"; }

fmi3Instance fmi3InstantiateCoSimulation(
    fmi3String instance, fmi3String token, fmi3String resources, fmi3Boolean visible,
    fmi3Boolean logging, fmi3Boolean uses_event_mode, fmi3Boolean allows_early_return,
    const fmi3ValueReference intermediate_variables[], size_t intermediate_count,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
    fmi3IntermediateUpdateCallback intermediate_update) {
  (void)instance, (void)resources, (void)visible, (void)logging, (void)uses_event_mode;
  (void)allows_early_return, (void)intermediate_variables, (void)intermediate_count;
  (void)intermediate_update;
  if (strcmp(token, TOKEN) != 0) {
    log(environment, fmi3Error, "logStatusError", "wrong instantiation token");
    return NULL;
  }
  Machine* machine = calloc(1, sizeof *machine);
  if (machine == NULL) return NULL;
  machine->lag = 0.02;
  machine->stiffness = 5;
  return machine;
}

void fmi3FreeInstance(fmi3Instance instance) { free(instance); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance instance, fmi3Boolean has_tolerance,
                                       fmi3Float64 tolerance, fmi3Float64 start,
                                       fmi3Boolean has_stop, fmi3Float64 stop) {
  (void)instance, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
  return fmi3OK;
}

fmi3Status fmi3ExitInitializationMode(fmi3Instance instance) {
  const Machine* machine = instance;
  return machine->lag > 0 ? fmi3OK : fmi3Error;
}

fmi3Status fmi3Terminate(fmi3Instance instance) {
  (void)instance;
  return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance instance, fmi3Float64 time, fmi3Float64 step,
                      fmi3Boolean is_final, fmi3Boolean* needs_event, fmi3Boolean* terminates,
                      fmi3Boolean* returned_early, fmi3Float64* last_time) {
  Machine* machine = instance;
  (void)is_final;
  for (int i = 0; i < AXES; ++i) {
    double* x = &machine->displacement[i];
    *x += (machine->reference[i] - *x) * step / (step + machine->lag);
    if (*x > LIMIT_MM) *x = LIMIT_MM;
    if (*x < -LIMIT_MM) *x = -LIMIT_MM;
  }
  *needs_event = *terminates = *returned_early = false;
  *last_time = time + step;
  return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t reference_count, fmi3Float64 values[], size_t count) {
  const Machine* machine = instance;
  (void)count;
  for (size_t i = 0; i < reference_count; ++i) {
    const fmi3ValueReference axis = references[i] % 10;
    if (axis >= AXES) return fmi3Error;
    switch (references[i] - axis) {
      case DISPLACEMENT:
        values[i] = machine->displacement[axis];
        break;
      case FORCE:
        values[i] = machine->stiffness * machine->displacement[axis];
        break;
      case ECHO:
        values[i] = machine->reference[axis];
        break;
      default:
        return fmi3Error;
    }
  }
  return fmi3OK;
}

fmi3Status fmi3SetFloat64(fmi3Instance instance, const fmi3ValueReference references[],
                          size_t reference_count, const fmi3Float64 values[], size_t count) {
  Machine* machine = instance;
  (void)count;
  for (size_t i = 0; i < reference_count; ++i) {
    if (references[i] == LAG)
      machine->lag = values[i];
    else if (references[i] == STIFFNESS)
      machine->stiffness = values[i];
    else if (references[i] < AXES)
      machine->reference[references[i]] = values[i];
    else
      return fmi3Error;
  }
  return fmi3OK;
}

/* Numbers of other types. */
#define UNUSED(NUMBER)                                                                            \
  fmi3Status fmi3Get##NUMBER(fmi3Instance instance, const fmi3ValueReference references[],        \
                             size_t reference_count, fmi3##NUMBER values[], size_t count) {       \
    (void)instance, (void)references, (void)reference_count, (void)values, (void)count;           \
    return fmi3Error;                                                                             \
  }                                                                                               \
  fmi3Status fmi3Set##NUMBER(fmi3Instance instance, const fmi3ValueReference references[],        \
                             size_t reference_count, const fmi3##NUMBER values[], size_t count) { \
    (void)instance, (void)references, (void)reference_count, (void)values, (void)count;           \
    return fmi3Error;                                                                             \
  }
UNUSED(Float32)
UNUSED(Int8)
UNUSED(UInt8)
UNUSED(Int16)
UNUSED(UInt16)
UNUSED(Int32)
UNUSED(UInt32)
UNUSED(Int64)
UNUSED(UInt64)
UNUSED(Boolean)
