/* SPDX-License-Identifier: Apache-2.0
 *
 * Tear groups: Node::write_group and Node::read_group of node.cpp; write_record, read_record and
 * read_memory of record.hpp. The writer is killed anywhere; its successor repairs the group by
 * repair_group of repair.cpp. At first, the memory has the words of a plain client.
 *   as written  a record of one line: reading it fails while its writer is in the middle of a write
 *   -DLATCH     a latch
 * Claims: every read is whole, was written, and is not older than the last read nor than a write that
 * was complete when the read began; a read fails only if something was stored meanwhile; the journal
 * has a write before the record is written again, and gets every write once; at the end record,
 * memory and journal have the last complete write.
 * Errors on purpose: -DNO_ODD  -DNO_RECHECK  -DEVEN_FIRST  -DCOUNT_ANEW (with -DDEATHS=2)  -DMEMORY_FIRST
 *         -DMEMORY_UNCHECKED  -DPLAIN_IS_A_COUNT  -DNO_REPAIR  -DNO_FINISH  -DNO_JOURNAL
 *         -DJOURNAL_TORN  -DJOURNAL_AGAIN  -DRELAXED_WORDS  -DRELAXED_ODD (both with -DWEAK)
 */
#ifndef WRITES
#define WRITES 2
#endif
#ifndef READS
#define READS 2
#endif
#ifndef DEATHS
#define DEATHS 1
#endif
#define PENDING 4

#define MARK 0    /* group.journalled */
#define COUNT 1   /* record[0] */
#define JOURNAL 2 /* last whole group only; journal.pml and follow.pml model journals */
#define MEMORY 3
#define RECORD 5
#define CELLS (RECORD + 4)
#define PLAIN 128
#ifdef LATCH
#define COPY(count) (RECORD + 2 * ((count) % 2))
#define IS_ODD(count) false
#else
#define COPY(count) RECORD
#define IS_ODD(count) ((count) % 2 != 0)
#endif
#ifdef RELAXED_WORDS
#define WORDS RELAXED
#else
#define WORDS RELEASE
#endif
#ifdef RELAXED_ODD
#define ODD RELAXED
#else
#define ODD RELEASE
#endif

#define BEFORE 1 /* initial value of the memory */

bool changed;           /* a store since the read began */
byte complete = BEFORE; /* last complete write of the record */
byte recorded;          /* last words of the record */
byte journalled;        /* last write of the journal */

inline note(where, stored) {
  changed = true;
  if
  :: where == JOURNAL -> assert(stored > journalled); journalled = stored
#ifdef LATCH
  :: where == RECORD || where == RECORD + 2 -> recorded = stored
  :: where == COUNT && complete != BEFORE -> assert(memory[JOURNAL] == complete); complete = recorded
  :: where == COUNT && complete == BEFORE -> complete = recorded
#else
  :: where == RECORD + 1 -> recorded = stored
  :: where == COUNT && stored % 2 == 0 -> complete = recorded
  :: where == COUNT && stored % 2 != 0 -> assert(complete == BEFORE || memory[JOURNAL] == complete)
#endif
  :: else
  fi
}
#define DRAINED(cell, value) note(cell, value)
#define WRITERS 1
#include "memory.pml"

/* A relaxed store may be visible long before earlier stores. */
#ifdef WEAK
#define BUFFERED !is_drained(0)
#else
#define BUFFERED false
#endif

bool killed, finished;

inline write_record(value) {
#ifdef LATCH
  count = (count + 1) % PLAIN;
  store(0, COPY(count), value, WORDS);
  store(0, COPY(count) + 1, value, WORDS);
  store(0, COUNT, count, RELEASE)
#else
#ifdef COUNT_ANEW
  count = (count + 1) % PLAIN;
#else
  count = (count | 1) % PLAIN;
#endif
#ifndef NO_ODD
  store(0, COUNT, count, ODD);
#endif
  count++;
#ifdef EVEN_FIRST
  store(0, COUNT, count, RELEASE);
#endif
  store(0, RECORD, value, WORDS);
  store(0, RECORD + 1, value, WORDS);
#ifndef EVEN_FIRST
  store(0, COUNT, count, RELEASE)
#endif
#endif
}

inline store_memory(value) {
  store(0, MEMORY, value, WORDS);
  store(0, MEMORY + 1, value, WORDS)
}

/* journal.group(...), group.journalled = count_of(record) */
inline write_journal(value) {
#ifdef NO_JOURNAL
  skip
#else
  store(0, JOURNAL, value, RELEASE);
  store(0, MARK, count, RELEASE)
#endif
}

/* Its loads are atomic: its predecessor is dead, and no other process writes. */
inline repair_group() {
  repaired = IS_ODD(count);
#ifdef NO_REPAIR
  skip
#else
  if
  :: count < PLAIN ->
     if
     :: IS_ODD(count) ->
#ifndef JOURNAL_TORN
        store(0, MARK, count + 1, RELEASE);
#endif
        newest = memory[MEMORY];
        write_record(newest);
#ifdef JOURNAL_TORN
        write_journal(newest)
#endif
     :: else ->
        newest = memory[COPY(count)];
#ifndef NO_FINISH
        store_memory(newest)
#endif
     fi;
     /* is_last_entry: the journal has this write already, but its writer did not mark it */
     if
#ifdef JOURNAL_AGAIN
     :: memory[MARK] != count -> write_journal(newest)
#else
     :: memory[MARK] != count && !repaired && memory[JOURNAL] != newest -> write_journal(newest)
#endif
     :: else
     fi
  :: else
  fi;
  newest = 0
#endif
}

proctype Writer() {
  byte count, newest;
  byte value = BEFORE;
  bool repaired;
life:
  {
    count = memory[COUNT];
    repair_group();
    do
    :: value < BEFORE + WRITES ->
       value++;
#ifdef MEMORY_FIRST
       store_memory(value);
       write_record(value);
#else
       write_record(value);
       store_memory(value);
#endif
       write_journal(value)
    :: else -> break
    od;
    goto done
  } unless { killed };
  /* The kernel reports a death only after the last store is in memory. */
  atomic { is_drained(0) -> count = 0; newest = 0; repaired = false; killed = false };
  goto life;
done:
  is_drained(0);
  assert(memory[MEMORY] == complete && memory[MEMORY + 1] == complete);
  assert(complete == BEFORE ||
         (memory[COPY(count)] == complete && memory[COPY(count) + 1] == complete &&
          memory[JOURNAL] == complete));
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

inline read_record() {
  atomic {
    count = memory[COUNT];
    ok = !IS_ODD(count);
#ifdef PLAIN_IS_A_COUNT
    count = count % PLAIN
#else
    ok = ok && count < PLAIN
#endif
  };
  if
  :: ok ->
     first = memory[COPY(count)];
     second = memory[COPY(count) + 1];
#ifndef NO_RECHECK
#ifdef PLAIN_IS_A_COUNT
     atomic { ok = (memory[COUNT] % PLAIN == count); count = 0 }
#else
     atomic { ok = (memory[COUNT] == count); count = 0 }
#endif
#endif
  :: else -> count = 0
  fi
}

inline read_memory() {
  atomic { count = memory[COUNT]; ok = IS_ODD(count) || count >= PLAIN };
  if
  :: ok ->
     first = memory[MEMORY];
     second = memory[MEMORY + 1];
#ifndef MEMORY_UNCHECKED
     atomic { ok = (memory[COUNT] == count); count = 0 }
#endif
  :: else -> count = 0
  fi
}

proctype Reader() {
  byte reads, count, first, second, seen, oldest;
  bool ok;
  do
  :: reads < READS ->
     atomic { changed = false; oldest = complete };
     read_record();
     if
     :: !ok -> read_memory()
     :: else
     fi;
     if
     :: !ok -> read_record()
     :: else
     fi;
     atomic {
       if
       :: ok ->
          assert(first == second);  /* whole */
          assert(first >= BEFORE);  /* was written */
          assert(first >= seen);    /* not older than the last read */
          assert(first >= oldest);  /* no complete write is lost */
          seen = first
       :: else -> assert(changed || BUFFERED)  /* Stale */
       fi;
       first = 0; second = 0; count = 0; oldest = 0; ok = false; changed = false;
       reads++
     }
  :: else -> break
  od
}

init {
  atomic {
    memory[MEMORY] = BEFORE; memory[MEMORY + 1] = BEFORE; memory[COUNT] = PLAIN;
    run Processor(0); run Writer(); run Killer(); run Reader()
  }
}
