/* SPDX-License-Identifier: Apache-2.0
 *
 * Following a journal: Follower::State::next of follow.cpp. Groups of a head and two more entries;
 * the writer is killed once, anywhere; its successor begins with a time. The journal does not wrap.
 * Claim: the follower returns every whole group once and in order, and does not wait for the rest of
 * a group whose writer is dead (spin: invalid end state).
 * Errors on purpose: -DLAST_ONLY  -DFIRST_ONLY
 */
#define WRITES 2
#define DEATHS 1
#define HEAD 1
#define DATA 2
#define TIME 3
#define ENTRY(kind, contents) ((kind) * 8 + (contents))
#define KIND(entry) ((entry) / 8)

byte end_of;       /* end of the journal in memory */
byte data;         /* entries behind the last head in memory */
byte whole[8];     /* whole groups of the journal in memory */
byte groups;
inline note(entry) {
  end_of++;
  if
  :: KIND(entry) == DATA && data == 0 -> data = 1
  :: KIND(entry) == DATA && data == 1 -> whole[groups] = entry % 8; groups++; data = 0
  :: else -> data = 0
  fi
}
#define DRAINED(cell, value) note(value)
#define PENDING 4
#define CELLS 12
#define WRITERS 1
#include "memory.pml"

bool killed, finished;

inline append(kind, contents) {
  store(0, position, ENTRY(kind, contents), RELEASE);
  position++
}

proctype Writer() {
  byte position, value;
life:
  {
    position = end_of;
    append(TIME, 0);
    do
    :: value < WRITES -> value++; append(HEAD, 0); append(DATA, value); append(DATA, value)
    :: else -> break
    od;
    goto done
  } unless { killed };
  atomic { is_drained(0) -> position = 0; killed = false };
  goto life;
done:
  append(TIME, 0);
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

proctype Follower() {
  byte position, given, first, second;
  do
  :: /* switch (fetch_at(journal, position, entry)) */
     if
     :: memory[position] == 0 ->  /* NotYet: called again when there is more */
end_nothing:
        memory[position] != 0
     :: else
     fi;
     position++;
     if
     :: KIND(memory[position - 1]) != HEAD
     :: else ->
        /* read_group: read_journalled_group */
        first = memory[position];
        second = memory[position + 1];
        if
        :: KIND(first) == DATA && KIND(second) == DATA ->
           atomic {
             assert(first == second);                                 /* whole */
             assert(given < groups && whole[given] == first % 8);  /* once and in order */
             given++;
             position = position + 2
           }
        :: else ->
#ifdef LAST_ONLY
           /* if (fetch_at(place, end - 1, last) != Fetched::NotYet) continue; */
           second = memory[position + 1];
           if
           :: second != 0
           :: else ->
              first = memory[position];
              if
              :: first != 0 && KIND(first) != DATA
              :: else -> position--; memory[position + 2] != 0
              fi
           fi
#else
           /* state_of: the next entries, up to one that is missing or not of this group */
           first = memory[position];
           if
           :: first == 0 -> position--; memory[position + 1] != 0  /* Pending */
           :: first != 0 && KIND(first) != DATA                    /* Cut */
           :: else ->
#ifdef FIRST_ONLY
              position--; memory[position + 2] == ENTRY(DATA, first % 8)
#else
              second = memory[position + 1];
              if
              :: second == 0 -> position--; memory[position + 2] != 0  /* Pending */
              :: second != 0 && KIND(second) != DATA                   /* Cut */
              :: else -> position--                                    /* Complete */
              fi
#endif
           fi
#endif
        fi
     fi;
     first = 0; second = 0
  :: atomic { finished && position == end_of -> assert(given == groups); break }
  od
}

init { atomic { run Processor(0); run Writer(); run Killer(); run Follower() } }
