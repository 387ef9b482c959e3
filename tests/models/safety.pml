/* SPDX-License-Identifier: Apache-2.0
 *
 * The safety layer in front of a machine: its transition table, read from safety_table.inc as the
 * compiler does, against every order of events. The layer sends Standstill only in Hold and the two
 * Rest events only in RampDown; all other events may come at any time.
 * Claims: commands pass only while running, after an admission, and not after a stop or a trip; the
 * machine ramps only from standstill; a state of rest is entered at rest; a trip ends in Tripped and
 * is remembered until it is disabled; a stop or a trip always leads to rest.
 * Errors on purpose: -DFROM=Running -DEVENT=Trip -DTO=Running changes one cell of the table.
 */
#define Off 0
#define Ready 1
#define Running 2
#define Hold 3
#define RampDown 4
#define Tripped 5
#define STATES 6

#define Enable 0
#define Admit 1
#define Stop 2
#define Trip 3
#define Standstill 4
#define Rest 5
#define RestAfterTrip 6
#define Disable 7
#define EVENTS 8

#define CELL(state, event) next[(state) * EVENTS + (event)]
#define RTHS_SAFETY_TRANSITION(from, event, to) CELL(from, event) = to;
#define AT_REST(state) (state == Off || state == Ready || state == Tripped)

byte next[48];
byte state;
bool admitted;  /* since the layer was enabled */
bool stopped;   /* a stop or a disabling was asked for since then */
bool latched;   /* a trip since then */
bool moving;    /* the reference may differ from the rest position */
bool standing;  /* the reference has stood */

inline receive(event) {
  before = state;
  state = CELL(before, event);
  if
  :: event == Enable && before == Off ->
     assert(state == Ready);
     admitted = false; stopped = false; latched = false; standing = false
  :: event == Admit && before == Ready ->
     assert(state == Running);
     admitted = true
  :: event == Trip && before != Off && before != Tripped -> latched = true
  :: (event == Stop || event == Disable) && before != Off && before != Tripped -> stopped = true
  :: event == Standstill ->
     standing = true;
     assert(state == RampDown)  /* else it would hold for ever */
  :: event == Rest || event == RestAfterTrip ->
     moving = false;
     assert(state == (latched -> Tripped : Off))
  :: event == Disable && before == Tripped ->
     assert(state == Off);
     latched = false
  :: else
  fi;
  if
  :: state == Running ->
     assert(admitted && !stopped && !latched);
     moving = true;
     standing = false
  :: state == RampDown -> assert(standing)
  :: else
  fi;
  assert(!AT_REST(state) || !moving);
  assert(!(state == Off || state == Ready) || !latched);
  assert(state != Tripped || latched);
  /* a stop before the first command ends the wait */
  assert(state != Ready || !stopped)
}

init {
  byte before, i;
  d_step {
    i = 0;
    do
    :: i < STATES * EVENTS -> next[i] = i / EVENTS; i++
    :: else -> break
    od;
#include "safety_table.inc"
#ifdef TO
    CELL(FROM, EVENT) = TO;
#endif
    i = 0
  };
  do
  :: atomic { receive(Enable); before = 0 }
  :: atomic { receive(Admit); before = 0 }
  :: atomic { receive(Stop); before = 0 }
  :: atomic { receive(Trip); before = 0 }
  :: atomic { receive(Disable); before = 0 }
  :: atomic { state == Hold -> receive(Standstill); before = 0 }
  :: atomic { state == RampDown && !latched -> receive(Rest); before = 0 }
  :: atomic { state == RampDown && latched -> receive(RestAfterTrip); before = 0 }
  od
}
