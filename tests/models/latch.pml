/* SPDX-License-Identifier: Apache-2.0
 *
 * A latch: write_record and read_record of record.hpp for up to 7 words, here 2. The writer may stop
 * forever after any store.
 * Claims: every read is whole and not older than the last one; an attempt fails only if the writer
 * published a write meanwhile.
 * Errors on purpose: -DONE_COPY  -DCOUNT_FIRST  -DNO_RECHECK  -DRELAXED_WORDS (with -DWEAK)
 */
#define WRITES 4
#define READS 3
#define COUNT 0
#define COPY(count) (1 + 2 * ((count) % 2))

bool published;  /* since the attempt began */
#define DRAINED(cell, value) published = published || cell == COUNT
#define CELLS 5
#define WRITERS 1
#include "memory.pml"

#ifdef RELAXED_WORDS
#define WORDS RELAXED
#else
#define WORDS RELEASE
#endif
#ifdef ONE_COPY
#define NEXT_COPY COPY(0)
#define COPY_OF(count) COPY(0)
#else
#define NEXT_COPY COPY(count + 1)
#define COPY_OF(count) COPY(count)
#endif

proctype Writer() {
  byte count;
  do
  :: count < WRITES ->
#ifdef COUNT_FIRST
     store(0, COUNT, count + 1, RELEASE);
#endif
     /* at(copy[i]).store(words[i], release) */
     store(0, NEXT_COPY, count + 1, WORDS);
     store(0, NEXT_COPY + 1, count + 1, WORDS);
#ifndef COUNT_FIRST
     /* at(record[0]).store(count + 1, release) */
     store(0, COUNT, count + 1, RELEASE);
#endif
     count++
  :: break  /* stopped or dead; its last stores may remain in the buffer */
  od
}

proctype Reader() {
  byte reads, count, again, first, second, seen;
  do
  :: reads < READS ->
     /* count = at(record[0]).load(acquire) */
     atomic { count = memory[COUNT]; published = false };
     /* words[i] = at(copy[i]).load(acquire) */
     first = memory[COPY_OF(count)];
     second = memory[COPY_OF(count) + 1];
     /* return at(record[0]).load(relaxed) == count */
     atomic {
#ifdef NO_RECHECK
       again = count;
#else
       again = memory[COUNT];
#endif
       if
       :: again == count ->
          assert(first == second);  /* whole */
          assert(first >= seen);    /* not older than the last read */
          assert(first == count);   /* the last one published */
          seen = first
       :: else -> assert(published)  /* never blocked by a stopped writer */
       fi;
       first = 0; second = 0; again = 0; count = 0; published = false
     };
     reads++
  :: else -> break
  od
}

init { atomic { run Processor(0); run Writer(); run Reader() } }
