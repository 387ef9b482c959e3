/* SPDX-License-Identifier: Apache-2.0
 *
 * A record of one line: write_record and read_record of record.hpp for 8 to 15 words, here 2. Its
 * writer is killed twice, anywhere; each time a successor mends what is left, mend_group of mend.cpp.
 * The journal is one cell, the number of the last whole write; group.pml has a real one.
 * Claims: what is read is whole and never older than before; an attempt fails only if the writer is
 * in the middle or wrote meanwhile; in the end everybody reads the last whole write of the journal.
 * Broken: -DNO_ODD  -DNO_RECHECK  -DEVEN_FIRST  -DNO_MEND  -DCOUNT_ANEW  -DRELAXED_WORDS (-DWEAK)
 */
#define WRITES 3
#define READS 2
#define DEATHS 2
#define COUNT 0
#define WORD 1
#define JOURNAL 3

bool changed;  /* the record, since the attempt began */
#define DRAINED(cell, value) changed = changed || cell != JOURNAL
#define CELLS 4
#define WRITERS 1
#include "memory.pml"

#ifdef RELAXED_WORDS
#define WORDS RELAXED
#else
#define WORDS RELEASE
#endif

bool killed, finished;

/* count: record[0] as the writer loads it. Its own stores it sees at once. */
inline write_record(value) {
#ifdef COUNT_ANEW
  middle = count + 1;  /* instead of count | 1 */
#else
  middle = count | 1;
#endif
#ifndef NO_ODD
  /* at(record[0]).store(middle, relaxed) */
  store(0, COUNT, middle, RELAXED);
#endif
#ifdef EVEN_FIRST
  store(0, COUNT, middle + 1, RELEASE);
#endif
  /* at(record[1 + i]).store(words[i], release) */
  store(0, WORD, value, WORDS);
  store(0, WORD + 1, value, WORDS);
#ifndef EVEN_FIRST
  /* at(record[0]).store(middle + 1, release) */
  store(0, COUNT, middle + 1, RELEASE);
#endif
  count = middle + 1
}

proctype Writer() {
  byte count, middle, last;
  byte begun;  /* writes, of all lives */
life:
  {
    count = memory[COUNT];
    last = memory[JOURNAL];
#ifndef NO_MEND
    /* if (!torn && recorded == words) return false; write_record(record, words) */
    if
    :: count % 2 != 0 || memory[WORD] != last || memory[WORD + 1] != last -> write_record(last)
    :: else
    fi;
#endif
    do
    :: begun < WRITES ->
       begun++;
       store(0, JOURNAL, begun, RELEASE);
       write_record(begun)
    :: else -> break
    od;
    goto done
  } unless { killed };
  /* The kernel calls it dead when its last store is in memory. */
  atomic { is_drained(0) -> count = 0; middle = 0; last = 0; killed = false };
  goto life;
done:
  is_drained(0);
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

proctype Reader() {
  byte reads, count, again, first, second, seen;
  bool last;
  do
  :: reads < READS || (finished && !last) ->
     /* count = at(record[0]).load(acquire) */
     atomic { last = finished; count = memory[COUNT]; changed = false };
     if
     :: count % 2 != 0 -> assert(!last)  /* false: in the middle */
     :: else ->
        /* words[i] = at(record[1 + i]).load(acquire) */
        first = memory[WORD];
        second = memory[WORD + 1];
        /* return at(record[0]).load(relaxed) == count */
        atomic {
#ifdef NO_RECHECK
          again = count;
#else
          again = memory[COUNT];
#endif
          if
          :: again == count ->
             assert(first == second);                  /* whole */
             assert(first >= seen);                    /* never older than before */
             assert(!last || first == memory[JOURNAL]);  /* nothing lost */
             seen = first
          :: else -> assert(changed)
          fi
        }
     fi;
     atomic {
       first = 0; second = 0; again = 0; count = 0; changed = false;
       if
       :: reads < READS -> reads++
       :: else
       fi
     }
  :: last -> break
  od
}

init { atomic { run Processor(0); run Writer(); run Killer(); run Reader() } }
