/* SPDX-License-Identifier: Apache-2.0
 *
 * A solver along one axis that commands a growing sine, with the fault that its config names. The
 * fault begins at step 100 of 10 ms. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <rths_adapter.h>

#define STEP_S 0.01
#define FAULT_AT 100 /* step */

enum { AT_TARGET, SWITCH_PC };
enum { NEW_TARGET, DISPLACEMENT, TIME };
enum phase { READY, SENT, MOVING };

typedef struct {
  char fault[40];
  int steps; /* of the test */
  int step;
  enum phase phase;
  double sent_s;
  int is_stopping;
} Solver;

static const rths_signal kSignals[] = {
    {"daq.atTarget", "1", RTHS_INPUT, 0, 0, 0, 0},
    {"daq.switchPC", "1", RTHS_INPUT, 0, 0, 0, 0},
    {"opf.newTarget", "1", RTHS_OUTPUT, 0, 0, 0, 0},
    {"opf.long.displ.target", "m", RTHS_OUTPUT, 0, 0, 0, 0},
    {"opf.1.time.target", "s", RTHS_OUTPUT, 0, 0, 0, 0},
};

static void* create(const char* config_toml, char* error, uint32_t error_size) {
  Solver* solver = calloc(1, sizeof *solver);
  const char* fault = strstr(config_toml, "fault = \"");
  const char* duration = strstr(config_toml, "duration_s = ");
  if (solver == NULL || fault == NULL || duration == NULL) {
    snprintf(error, error_size, "expected fault and duration_s");
    free(solver);
    return NULL;
  }
  sscanf(fault, "fault = \"%39[^\"]", solver->fault);
  solver->steps = (int)(atof(duration + strlen("duration_s = ")) / STEP_S + 0.5);
  return solver;
}

static const rths_signal* list(void* self, uint32_t* count) {
  (void)self;
  *count = sizeof kSignals / sizeof *kSignals;
  return kSignals;
}

static rths_status activate(void* self, char* error, uint32_t error_size) {
  Solver* solver = self;
  (void)error, (void)error_size;
  solver->step = solver->is_stopping = 0;
  solver->phase = READY;
  return RTHS_OK;
}

static int has(const Solver* solver, const char* fault) {
  return solver->step >= FAULT_AT && strcmp(solver->fault, fault) == 0;
}

static double displacement_at(const Solver* solver, int step) {
  const double time = step * STEP_S, growth = time < 1 ? time : 1;
  double value = 0.02 * growth * sin(2 * 3.14159265 * time);
  if (has(solver, "sends millimetres")) value *= 1000;
  if (has(solver, "sends centimetres")) value *= 100;
  if (has(solver, "sends the last target")) value = 0.02;
  if (has(solver, "sends nan")) value = NAN;
  return value;
}

static double time_at(const Solver* solver, int step) {
  double time = step * STEP_S;
  if (has(solver, "goes back")) time -= 0.5;
  if (has(solver, "iterates")) time = (FAULT_AT + (step - FAULT_AT) / 2) * STEP_S;
  if (has(solver, "has uneven steps")) time += 0.3 * STEP_S * (step % 2);
  if (has(solver, "has double steps")) time += (step - FAULT_AT) * STEP_S;
  if (has(solver, "counts steps")) time = step;
  if (has(solver, "stops its time")) time = FAULT_AT * STEP_S;
  return time;
}

static void send(Solver* solver, double time_s, double* out) {
  ++solver->step;
  out[DISPLACEMENT] = displacement_at(solver, solver->step);
  out[TIME] = time_at(solver, solver->step);
  out[NEW_TARGET] = 1;
  solver->sent_s = time_s;
  solver->phase = SENT;
}

static rths_status step(void* self, double time_s, const double* in, double* out) {
  Solver* solver = self;
  const int is_over = solver->step >= solver->steps && strcmp(solver->fault, "never ends") != 0;
  if (solver->is_stopping || (solver->phase == READY && is_over) || has(solver, "leaves early")) {
    out[NEW_TARGET] = -1;
    return RTHS_DONE;
  }
  if (has(solver, "hangs") || strcmp(solver->fault, "sends nothing") == 0) return RTHS_OK;
  if (has(solver, "asks for no switch") && time_s >= solver->sent_s + 0.25 * STEP_S) {
    send(solver, time_s, out);
    return RTHS_OK;
  }
  if (solver->phase == READY && in[AT_TARGET] > 0) {
    if (has(solver, "is slow") && time_s < solver->sent_s + 2 * STEP_S) return RTHS_OK;
    send(solver, time_s, out);
  } else if (solver->phase == SENT && in[SWITCH_PC] > 0) {
    out[NEW_TARGET] = 0;
    solver->phase = MOVING;
  } else if (solver->phase == MOVING && in[SWITCH_PC] == 0) {
    solver->phase = READY;
  }
  return RTHS_OK;
}

static void deactivate(void* self) { (void)self; }
static void destroy(void* self) { free(self); }
static void stop(void* self) { ((Solver*)self)->is_stopping = 1; }

const rths_adapter* rths_adapter_entry(void) {
  static const rths_adapter adapter = {RTHS_ADAPTER_ABI,
                                       sizeof(rths_adapter),
                                       "contrary solver",
                                       "1",
                                       create,
                                       list,
                                       activate,
                                       step,
                                       deactivate,
                                       destroy,
                                       stop,
                                       NULL};
  return &adapter;
}
