/* SPDX-License-Identifier: Apache-2.0
 *
 * What other processors see of a writer's stores, and when. A store goes into its writer's buffer;
 * from there it reaches the memory at any later time:
 *   as on x86-64      in the order of the stores
 *   -DWEAK            as little ordered as C++ allows: a relaxed store overtakes anything but stores
 *                     to its own cell, a release store overtakes nothing
 * Loads are taken in program order, from memory; a writer keeps in variables what it wrote itself.
 * Before the #include: CELLS, WRITERS, DRAINED(cell, value), what a model notes when memory changes.
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

inline store(writer, to, what, order) {
  atomic {
    buffer[writer].length < PENDING ->
    buffer[writer].cell[buffer[writer].length] = to;
    buffer[writer].value[buffer[writer].length] = what;
    buffer[writer].release[buffer[writer].length] = order;
    buffer[writer].length++
  }
}

#define is_drained(writer) (buffer[writer].length == 0)

/* The processor of a writer. It goes on when the writer is stopped or dead. */
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
