/* SPDX-License-Identifier: Apache-2.0
 *
 * Tear groups: Node::write_group and Node::read_group of node.cpp, in a journal of 4 entries that
 * each write overwrites; the writer is killed anywhere, its successor mends, mend_group of mend.cpp.
 * At first the memory holds what a program wrote that takes no part in any of this.
 *   as is  a record of one line, attempts of which fail while its writer is in the middle
 *   -DLATCH
 * Claims: what is read is whole, was written, and is never older than before nor than a write that
 * was complete when the reader came; a reader is turned away only if something was stored meanwhile;
 * in the end record and memory hold the last write that is whole in the journal.
 * Broken: -DMARK_FIRST  -DNO_JOURNAL  -DNO_LAST_ATTEMPT  -DMEMORY_UNCHECKED  -DZERO_IS_A_COUNT
 *         -DMEND_MARKED_ONLY  -DMEND_UNMARKED (with -DDEATHS=2)
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

#define LENGTH 4
#define ENTRIES 3 /* of a group: its head, and a word in each of two more */
#define HEAD 1
#define DATA 2
#define TIME 3
/* An entry in a byte: lap, kind, contents. It is published by one store, see journal.pml. */
#define ENTRY(position, kind, contents) (((position) / LENGTH + 1) * 32 + (kind) * 8 + (contents))

#define MARK 0  /* group.journalled */
#define COUNT 1 /* record[0] */
#define MEMORY 2
#define RECORD 4
#define JOURNAL 8
#define CELLS (JOURNAL + LENGTH)
#ifdef LATCH
#define COPY(count) (RECORD + 2 * ((count) % 2))
#else
#define COPY(count) RECORD
#endif

#define BEFORE 1 /* what the memory holds at first */

bool changed;     /* anything, since the reader came */
byte end_of;      /* the journal, as memory has it; see end.pml */
byte promised = BEFORE; /* last write that is whole in the journal, as memory has it */
byte complete = BEFORE; /* last write that memory has all of */
bool second_word; /* the next DATA is a group's last */

inline note(where, what) {
  changed = true;
  if
  :: where >= JOURNAL && where < JOURNAL + LENGTH ->
     end_of++;
     if
     :: what / 8 % 4 == DATA && second_word -> promised = what % 8; second_word = false
     :: what / 8 % 4 == DATA && !second_word -> second_word = true
     :: else -> second_word = false
     fi
  :: where == MEMORY + 1 -> complete = what
  :: else
  fi
}
#define DRAINED(cell, value) note(cell, value)
#define WRITERS 1
#include "memory.pml"

/* A relaxed store may be seen long before those in front of it. */
#ifdef WEAK
#define ON_ITS_WAY !is_drained(0)
#else
#define ON_ITS_WAY false
#endif

bool killed, finished;

inline append(kind, contents) {
  store(0, JOURNAL + position % LENGTH, ENTRY(position, kind, contents), RELEASE);
  position++
}

inline write_record(value) {
#ifdef LATCH
  store(0, COPY(count + 1), value, RELEASE);
  store(0, COPY(count + 1) + 1, value, RELEASE);
  store(0, COUNT, count + 1, RELEASE);
  count++
#else
  store(0, COUNT, count | 1, RELAXED);
  store(0, RECORD, value, RELEASE);
  store(0, RECORD + 1, value, RELEASE);
  store(0, COUNT, (count | 1) + 1, RELEASE);
  count = (count | 1) + 1
#endif
}

inline store_memory(value) {
  store(0, MEMORY, value, RELEASE);
  store(0, MEMORY + 1, value, RELEASE)
}

/* read_journalled_group, where nobody writes: 0 if there is no whole group */
inline group_at(first, value) {
  value = memory[JOURNAL + (first + 1) % LENGTH] % 8;
  if
  :: memory[JOURNAL + (first) % LENGTH] == ENTRY(first, HEAD, 0) &&
     memory[JOURNAL + (first + 1) % LENGTH] == ENTRY(first + 1, DATA, value) &&
     memory[JOURNAL + (first + 2) % LENGTH] == ENTRY(first + 2, DATA, value)
  :: else -> value = 0
  fi
}

/* What it loads it loads at once: its predecessor is dead, and nobody else writes. */
inline mend_group() {
  atomic {
    marked = memory[MARK];
    newest = 0;
#ifdef MEND_MARKED_ONLY
    /* nothing that is not marked */
#else
    /* A whole group that is not marked is the last thing its writer wrote. */
    if
    :: position >= marked + ENTRIES -> group_at(position - ENTRIES, newest)
    :: else
    fi;
#endif
    if
    :: newest != 0 -> marked = position - ENTRIES + 1
    :: newest == 0 && marked != 0 -> group_at(marked - 1, newest)
    :: else
    fi;
    if
    :: newest != 0 && memory[COUNT] != 0 && memory[MEMORY] == newest &&
       memory[MEMORY + 1] == newest && memory[COPY(count)] == newest &&
       memory[COPY(count) + 1] == newest ->
#ifndef LATCH
       newest = (count % 2 == 0 -> 0 : newest)
#else
       newest = 0
#endif
    :: else
    fi
  };
  if
  :: newest != 0 ->
#ifndef MEND_UNMARKED
     store(0, MARK, marked, RELEASE);
#endif
     write_record(newest);
     store_memory(newest)
  :: else
  fi;
  newest = 0; marked = 0
}

proctype Writer() {
  byte count, position, marked, newest;
  byte value = BEFORE;
life:
  {
    atomic { count = memory[COUNT]; position = end_of };
    mend_group();
    append(TIME, 0);  /* journal_->time(now()) */
    do
    :: value < BEFORE + WRITES ->
       value++;
#ifdef MARK_FIRST
       store(0, MARK, position + 1, RELEASE);
#endif
       /* const std::uint64_t position = journal_->group(access.group->base, words) */
       append(HEAD, 0);
       append(DATA, value);
       append(DATA, value);
#ifndef MARK_FIRST
       /* shared(access.group->journalled).store(position + 1, release) */
       store(0, MARK, position - ENTRIES + 1, RELEASE);
#endif
       write_record(value);
       store_memory(value)
    :: else -> break
    od;
    goto done
  } unless { killed };
  atomic { is_drained(0) -> count = 0; position = 0; marked = 0; newest = 0; killed = false };
  goto life;
done:
  is_drained(0);
  assert(memory[MEMORY] == promised && memory[MEMORY + 1] == promised);
  assert(promised == BEFORE || (memory[COPY(count)] == promised && memory[COPY(count) + 1] == promised));
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

/* One attempt, see latch.pml and record.pml. A count of 0 is that of a record never written. */
inline read_record() {
  atomic {
    count = memory[COUNT];
    ok = true;
#ifndef ZERO_IS_A_COUNT
    ok = ok && count != 0;
#endif
#ifndef LATCH
    ok = ok && count % 2 == 0
#endif
  };
  if
  :: ok ->
     first = memory[COPY(count)];
     second = memory[COPY(count) + 1];
     atomic { ok = (memory[COUNT] == count); count = 0 }
  :: else -> count = 0
  fi
}

proctype Reader() {
  byte reads, mark, count, first, second, seen, oldest;
  bool ok;
  do
  :: reads < READS ->
     /* if (journalled.load(acquire) == 0) { load_words(words, access.words); … */
     atomic { changed = false; oldest = complete; mark = memory[MARK] };
     if
     :: mark == 0 ->
        first = memory[MEMORY];
        second = memory[MEMORY + 1];
#ifdef MEMORY_UNCHECKED
        ok = true
#else
        /* … if (journalled.load(relaxed) == 0) return Ok; } */
        ok = (memory[MARK] == 0)
#endif
     :: else
     fi;
     /* for (int attempt = 0; attempt < kRecordAttempts; ++attempt) */
     if
     :: !ok -> read_record()
     :: else
     fi;
     if
     :: !ok ->
        /* position = journalled.load(acquire) - 1 */
        mark = memory[MARK];
#ifndef NO_LAST_ATTEMPT
        read_record();
#endif
        if
#ifndef NO_JOURNAL
        :: !ok ->
           /* read_journalled_group(access.journal, position, access.group->base, words) */
           ok = (memory[JOURNAL + (mark - 1) % LENGTH] == ENTRY(mark - 1, HEAD, 0));
           atomic {
             first = memory[JOURNAL + mark % LENGTH];
             ok = ok && first / 8 == ENTRY(mark, DATA, 0) / 8;
             first = first % 8
           };
           atomic {
             second = memory[JOURNAL + (mark + 1) % LENGTH];
             ok = ok && second / 8 == ENTRY(mark + 1, DATA, 0) / 8;
             second = second % 8
           }
#endif
        :: else
        fi
     :: else
     fi;
     atomic {
       if
       :: ok ->
          assert(first == second);  /* whole */
          assert(first >= BEFORE);  /* written by somebody */
          assert(first >= seen);    /* never older than before */
          assert(first >= oldest);  /* nothing complete is lost */
          seen = first
       :: else -> assert(changed || ON_ITS_WAY)  /* Stale */
       fi;
       first = 0; second = 0; mark = 0; oldest = 0; ok = false; changed = false;
       reads++
     }
  :: else -> break
  od
}

init {
  atomic {
    memory[MEMORY] = BEFORE; memory[MEMORY + 1] = BEFORE;
    run Processor(0); run Writer(); run Killer(); run Reader()
  }
}
