/* SPDX-License-Identifier: Apache-2.0
 *
 * Journal entries: publish, fetch and fetch_at of journal.hpp, in a journal of 2 entries that wraps
 * three and a half times, with laps of 2 bits. The reader reads any position at any time, up to a lap
 * too late or too early, since laps cannot distinguish more than half of all laps. The writer is
 * killed once, anywhere, also in the middle of an entry; its successor continues where it ended.
 *   as written        one 16-byte store
 *   -DSEVERAL_STORES  invalidate, contents, tag
 * Claims: an entry is whole and has the position that was read; Gone only if the writer has passed, or
 * is passing, the position; NotYet only if the entry was missing when the read began, or its slot was
 * being written.
 * Errors on purpose: -DNO_LAP  -DGONE_AT_ONCE;  with -DSEVERAL_STORES: -DNO_VOID  -DVALID_FIRST
 * -DNO_RECHECK, and -DRELAXED_CONTENTS (with -DWEAK)
 */
#define LENGTH 2
#define POSITIONS 7
#define LAPS 4
#define READS 1
#define DEATHS 1
/* journal.lap(position), and the tag with the kind Word in one bit: never 0, as in the C++ */
#define LAP(position) (((position) / LENGTH + 1) % LAPS)
#define TAG(position) (2 * LAP(position) + 1)

byte visible;  /* number of positions published in memory */
byte begun;    /* number of positions whose publication has begun */

#define WRITERS 1
#ifdef SEVERAL_STORES
#define CELLS 6
#define AT(position) (3 * ((position) % LENGTH)) /* tag; then two words of contents */
#define DRAINED(cell, value) visible = visible + (cell % 3 == 0 && value != 0)
#else
/* Cells are bytes: tag in the lower three bits, contents above. */
#define CELLS 2
#define AT(position) ((position) % LENGTH)
#define DRAINED(cell, value) visible++
#endif
#include "memory.pml"

#ifdef RELAXED_CONTENTS
#define CONTENTS RELAXED
#else
#define CONTENTS RELEASE
#endif

bool killed;

inline publish(position) {
  begun = position + 1;
#ifdef SEVERAL_STORES
#ifdef VALID_FIRST
  store(0, AT(position), TAG(position), RELEASE);
#else
#ifndef NO_VOID
  /* at(words[3]).store(0, relaxed) */
  store(0, AT(position), 0, RELAXED);
#endif
#endif
  /* at(words[0]).store(entry.a, release) and so on */
  store(0, AT(position) + 1, position, CONTENTS);
  store(0, AT(position) + 2, position, CONTENTS);
#ifndef VALID_FIRST
  /* at(words[3]).store(entry.tag, release) */
  store(0, AT(position), TAG(position), RELEASE);
#endif
#else
  /* _mm_store_si128 */
  store(0, AT(position), TAG(position) + 8 * position, RELEASE);
#endif
}

proctype Writer() {
  byte next;
life:
  {
    do
    :: next < POSITIONS -> publish(next); next++
    :: else -> break
    od;
    goto done
  } unless { killed };
  /* JournalWriter{journal}: continues at end_of(journal), see end.pml */
  atomic { is_drained(0) -> next = visible; killed = false };
  goto life;
done:
  skip
}

proctype Killer() {
  byte kills;
end:
  do
  :: kills < DEATHS -> atomic { kills++; killed = true };
end_idle:
     !killed
  od
}

proctype Reader() {
  byte reads, position, there, tag, again, a, b, ahead;
  do
  :: reads < READS ->
     atomic {
       there = visible;
       position = 0;
       do
       :: position < POSITIONS - 1 && position < there + LENGTH -> position++
       :: break
       od
     };
#ifdef SEVERAL_STORES
     /* entry.tag = at(words[3]).load(acquire), then the contents */
     tag = memory[AT(position)];
     a = memory[AT(position) + 1];
     b = memory[AT(position) + 2];
     /* if (at(words[3]).load(relaxed) != entry.tag) entry.tag = 0 */
     atomic {
#ifndef NO_RECHECK
       again = memory[AT(position)];
       tag = (again != tag -> 0 : tag);
#endif
#else
     /* _mm_load_si128 */
     atomic {
       again = memory[AT(position)];
       tag = again % 8; a = again / 8; b = a;
#endif
       /* found - expected, modulo the number of laps */
       ahead = (LAPS + tag / 2 - LAP(position)) % LAPS;
       if
       :: begun > position + 2 * LENGTH -> skip  /* more than a lap late: no claim */
       :: else ->
          if
#ifdef NO_LAP
          :: tag != 0 -> assert(a == position && b == position)
#else
          :: tag != 0 && ahead == 0 ->  /* Entry */
             assert(a == position && b == position)
#endif
#ifdef GONE_AT_ONCE
          :: tag != 0 && ahead != 0 ->
#else
          :: tag != 0 && ahead != 0 && ahead < LAPS / 2 ->  /* Gone */
#endif
             assert(begun > position + LENGTH)
          :: else ->  /* NotYet */
#ifdef SEVERAL_STORES
             assert(there <= position || begun > position + LENGTH)
#else
             assert(there <= position)
#endif
          fi
       fi;
       reads++; tag = 0; again = 0; a = 0; b = 0; ahead = 0; there = 0
     }
  :: else -> break
  od
}

init { atomic { run Processor(0); run Writer(); run Killer(); run Reader() } }
