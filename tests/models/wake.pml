/* SPDX-License-Identifier: Apache-2.0
 *
 * Sleeping and waking: Node::write and wake_all, Waiter::wait and Sleeper, without time-outs. The bit
 * of another slot is set, whose process died while it slept.
 * Claim: no process sleeps forever while there is a write that it has not seen (spin: invalid end
 * state).
 * Errors on purpose: -DNO_MEMBARRIER  -DLOOK_BEFORE  -DCALLS_AFTER  -DNO_SECOND_CALL
 */
#define WRITES 2
#ifndef SLEEPERS
#define SLEEPERS 1
#endif
#ifndef WRITERS
#define WRITERS 2
#endif
/* One journal per writer, as the number of its last entry; waiters do not read memory words. */
#define JOURNAL(writer) (writer)
#define CELLS WRITERS
#define DRAINED(cell, value) skip
#include "memory.pml"

#define DEAD (1 << SLEEPERS)

/* Changed only by locked instructions and by the kernel, so never in a buffer. */
byte calls;
byte sleepers = DEAD;
bool asleep[SLEEPERS];

/* futex(wake.calls, FUTEX_WAKE, INT_MAX) */
inline wake_futex() {
  d_step {
    woken = 0;
    slot = 0;
    do
    :: slot < SLEEPERS -> woken = woken + asleep[slot]; asleep[slot] = false; slot++
    :: else -> break
    od;
    slot = 0
  }
}

/* A locked instruction and a system call wait until the writer's own buffer is empty. */
inline wake_up() {
  atomic { is_drained(me) -> calls++ };  /* at(wake.calls).fetch_add(1) */
  wake_futex()
}

proctype Writer(byte me) {
  byte count, seen, woken, slot;
  do
  :: count < WRITES ->
     count++;
     /* writer->journal.word(offset, word) */
     store(me, JOURNAL(me), count, RELEASE);
     /* if (at(wake.sleepers).load(relaxed) != 0) wake_all(wake) */
     if
     :: sleepers != 0 ->
        seen = sleepers;
        wake_up();
        if
        :: woken == 0 ->
           atomic { sleepers = sleepers & (255 - seen) };  /* at(wake.sleepers).fetch_and(~seen) */
#ifndef NO_SECOND_CALL
           wake_up()
#endif
        :: else
        fi;
        atomic { seen = 0; woken = 0 }
     :: else
     fi
  :: else -> break
  od
}

/* poll: reads the journal of each writer */
inline poll() {
  writer = 0;
  news = false;
  do
  :: writer < WRITERS ->
     atomic {
       if
       :: memory[JOURNAL(writer)] != seen[writer] ->
          seen[writer] = memory[JOURNAL(writer)];
          news = true
       :: else
       fi;
       writer++
     }
  :: else -> break
  od;
  writer = 0
}

proctype Sleeper(byte me) {
  byte seen[WRITERS];
  byte had, writer, all;
  bool news;
  do
  :: /* Sleeper: calls_{at(wake.calls).load()} */
#ifndef CALLS_AFTER
     had = calls;
#endif
#ifdef LOOK_BEFORE
     poll();
#endif
     sleepers = sleepers | (1 << me);  /* at(wake.sleepers).fetch_or(bit_) */
#ifndef NO_MEMBARRIER
     /* membarrier(GLOBAL_EXPEDITED): drains the buffer of each processor in turn */
     do
     :: all < WRITERS -> is_drained(all); all++
     :: else -> break
     od;
     all = 0;
#endif
#ifndef LOOK_BEFORE
     /* const Status status = state_->poll(write) */
     poll();
#endif
#ifdef CALLS_AFTER
     had = calls;
#endif
     /* sleeper.sleep: futex(wake_.calls, FUTEX_WAIT, calls_) */
     if
     :: news
     :: else ->
        atomic { asleep[me] = (calls == had) };
        !asleep[me]
     fi;
     atomic { sleepers = sleepers & (255 - (1 << me)); had = 0; news = false };  /* ~Sleeper */
     /* Waits until it has seen every write. */
     if
     :: seen[0] == WRITES && seen[WRITERS - 1] == WRITES -> break
     :: else
     fi
  od
}

init {
  byte i;
  atomic {
    do
    :: i < WRITERS -> run Processor(i); run Writer(i); i++
    :: else -> break
    od;
    i = 0;
    do
    :: i < SLEEPERS -> run Sleeper(i); i++
    :: else -> break
    od
  }
}
