/* SPDX-License-Identifier: Apache-2.0
 *
 * Order in which other processors see a writer's stores. A store goes into its writer's buffer and
 * reaches the memory at any later time:
 *   as written        in the order of the stores, as on x86-64
 *   -DWEAK            as weakly ordered as C++ allows: a relaxed store overtakes all stores but those
 *                     to its own cell, a release store overtakes none
 * Loads read the memory in program order; a writer keeps its own values in variables.
 * Defined before the #include: CELLS, WRITERS, and DRAINED(cell, value), which a model executes when
 * memory changes.
 */
#ifndef PENDING
#define PENDING 6
#endif
#define RELAXED false
#define RELEASE true

typedef Buffer {
  byte length;
  byte cell[PENDING];
  byte value[PENDING];
  bool release[PENDING]
}
byte memory[CELLS];
Buffer buffer[WRITERS];

inline store(writer, to, word, order) {
  atomic {
    buffer[writer].length < PENDING ->
    buffer[writer].cell[buffer[writer].length] = to;
    buffer[writer].value[buffer[writer].length] = word;
    buffer[writer].release[buffer[writer].length] = order;
    buffer[writer].length++
  }
}

#define is_drained(writer) (buffer[writer].length == 0)

/* The processor of a writer. It continues after the writer is stopped or dead. */
proctype Processor(byte writer) {
  byte i, j;
  bool may = true;
end:
  do
  :: atomic {
       !is_drained(writer) ->
#ifdef WEAK
       do
       :: i + 1 < buffer[writer].length -> i++
       :: break
       od;
       j = 0;
       do
       :: j < i ->
          may = may && !buffer[writer].release[i] &&
                buffer[writer].cell[j] != buffer[writer].cell[i];
          j++
       :: else -> break
       od;
#endif
       if
       :: may ->
          memory[buffer[writer].cell[i]] = buffer[writer].value[i];
          DRAINED(buffer[writer].cell[i], buffer[writer].value[i]);
          buffer[writer].length--;
          do
          :: i < buffer[writer].length ->
             buffer[writer].cell[i] = buffer[writer].cell[i + 1];
             buffer[writer].value[i] = buffer[writer].value[i + 1];
             buffer[writer].release[i] = buffer[writer].release[i + 1];
             i++
          :: else -> break
          od;
          buffer[writer].cell[i] = 0;
          buffer[writer].value[i] = 0;
          buffer[writer].release[i] = false
       :: else
       fi;
       i = 0; j = 0; may = true
     }
  od
}
