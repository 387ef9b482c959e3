/* SPDX-License-Identifier: Apache-2.0
 *
 * Where a journal ends: end_of and JournalWriter of journal.cpp, with a hint every 2 entries, in a
 * journal of 8. The writer is killed three times, anywhere, also between an entry and its hint.
 * Claims: a successor goes on right behind the last entry; whoever follows a running writer begins
 * no further behind than the writer has written since, and never before an entry that is not there.
 * Broken: -DNO_FIRST_HINT  -DHINT_FIRST
 */
#define HINT_EVERY 2
#define POSITIONS 12
#define DEATHS 3
#define LENGTH 8
#define FARTHEST (2 * HINT_EVERY)
#define HINT 0
#define ENTRY(position) (1 + (position) % LENGTH)

byte visible;  /* entries, as memory has them */
#define DRAINED(cell, value) visible = visible + (cell != HINT)
#define CELLS 9
#define WRITERS 1
#include "memory.pml"

bool killed, finished;

/* fetch_at(place, position, entry) == Fetched::Entry: an entry is its position plus 1 */
#define is_there(position) (memory[ENTRY(position)] == (position) + 1)

/* One look is enough where nobody writes meanwhile: this is called when the writer is dead. */
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
    /* const std::uint64_t end = end_of(place) */
    atomic { end_of(next); assert(next == visible) };
#ifndef NO_FIRST_HINT
    /* at(place.head->hint).store(end, release) */
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
       /* publish(place_.entries[index_], entry) */
       store(0, ENTRY(next), next + 1, RELEASE);
       next++;
#ifndef HINT_FIRST
       /* if (++index_ % kHintEvery == 0) turn() */
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

/* Its steps one by one, as the writer goes on. */
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
