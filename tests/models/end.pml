/* SPDX-License-Identifier: Apache-2.0
 *
 * The end of a journal: end_of and JournalWriter of journal.cpp, with a hint every 2 entries, in a
 * journal of 8. The writer is killed three times, anywhere, also between an entry and its hint.
 * Claims: a successor continues directly behind the last entry; a follower of a running writer
 * begins at most as far behind as the writer has written since, and never behind a missing entry.
 * Errors on purpose: -DNO_FIRST_HINT  -DHINT_FIRST
 */
#define HINT_EVERY 2
#define POSITIONS 12
#define DEATHS 3
#define LENGTH 8
#define FARTHEST (2 * HINT_EVERY)
#define HINT 0
#define ENTRY(position) (1 + (position) % LENGTH)

byte visible;  /* number of entries in memory */
#define DRAINED(cell, value) visible = visible + (cell != HINT)
#define CELLS 9
#define WRITERS 1
#include "memory.pml"

bool killed, finished;

/* fetch_at(journal, position, entry) == Fetched::Entry: an entry is its position plus 1 */
#define is_there(position) (memory[ENTRY(position)] == (position) + 1)

/* One attempt is enough: this is called only while the writer is dead. */
inline end_of(position) {
  position = memory[HINT];
  steps = 0;
  do
  :: steps < FARTHEST && is_there(position) -> position++; steps++
  :: else -> break
  od;
  steps = 0
}

proctype Writer() {
  byte next, steps;
life:
  {
    /* begin_at(end_of(journal)) */
    atomic { end_of(next); assert(next == visible) };
#ifndef NO_FIRST_HINT
    /* at(journal_.head->hint).store(position(), release) */
    store(0, HINT, next, RELEASE);
#endif
    do
    :: next < POSITIONS ->
#ifdef HINT_FIRST
       if
       :: (next + 1) % HINT_EVERY == 0 -> store(0, HINT, next + 1, RELEASE)
       :: else
       fi;
#endif
       /* publish(*next_, …) */
       store(0, ENTRY(next), next + 1, RELEASE);
       next++;
#ifndef HINT_FIRST
       /* advance_to: if (next == stop_) publish_hint() */
       if
       :: next % HINT_EVERY == 0 -> store(0, HINT, next, RELEASE)
       :: else
       fi
#endif
    :: else -> break
    od;
    goto done
  } unless { killed };
  atomic { is_drained(0) -> next = 0; steps = 0; killed = false };
  goto life;
done:
  finished = true
}

proctype Killer() {
  byte kills;
end:
  do
  :: kills < DEATHS && !finished -> atomic { kills++; killed = true };
end_idle:
     !killed
  od
}

/* Steps of end_of, interleaved with those of the writer. */
proctype Follower() {
  byte position, steps, before;
  atomic { before = visible; position = memory[HINT] };
  do
  :: atomic { steps < FARTHEST && is_there(position) -> position++; steps++ }
  :: atomic { !(steps < FARTHEST && is_there(position)) -> break }
  od;
  assert(position <= visible);
  assert(position >= before || steps == FARTHEST || visible - position >= LENGTH)
}

init { atomic { run Processor(0); run Writer(); run Killer(); run Follower() } }
