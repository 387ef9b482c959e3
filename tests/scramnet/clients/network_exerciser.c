/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the vendor's network exerciser: all members store into the same random places of a
 * common area, whose every word shows its member, and into a sequence of their own. Each checks the
 * common area and the sequences of the others. Arguments: its number, the time [s]. */
#define _POSIX_C_SOURCE 200809L
#include <scrplus.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

enum {
  MEMBERS = 256,
  REPORTS = 0x1000, /* longwords from here on: a counter per member */
  SEQUENCES = 0x2000,
  SEQUENCE = 128,
  COMMON = SEQUENCES + SEQUENCE * MEMBERS,
  SEGMENT = 1024,
  SEGMENTS = 8,
  PACKET = 256
};

static volatile unsigned int* memory;
static unsigned int pattern[SEGMENT + SEGMENTS + MEMBERS];
static unsigned int errors, checks;

static void fail(const char* what, int at, unsigned int found, unsigned int expected) {
  if (++errors < 10) printf("%s: word %d is %08x, expected %08x\n", what, at, found, expected);
}

/* A sequence is stored from its begin on, with a number that grows by one each time. A reader who
 * is overtaken finds a higher number, but never one that is lower by more than one. */
static void check_sequence(int member) {
  const volatile unsigned int* words = memory + SEQUENCES + member * SEQUENCE;
  unsigned int before = words[0];
  int i;
  for (i = 1; i < SEQUENCE; ++i) {
    const unsigned int now = words[i];
    if (now > before) {
      before = words[i - 1];
      if (now > before) fail("sequence", i, now, before);
    } else if (now < before) {
      if (before - now != 1) fail("sequence", i, now, before - 1);
    }
    before = now;
  }
  ++checks;
}

static void check_common(int place, int offset, int length, int by_block) {
  static unsigned int words[PACKET];
  int i;
  if (by_block)
    scr_dma_read(words, (unsigned long)place * 4, (unsigned long)length * 4);
  else
    for (i = 0; i < length; ++i) words[i] = memory[place + i];
  for (i = 0; i < length; ++i) {
    const unsigned int member = words[i] & 0xFF;
    const unsigned int expected = pattern[offset + i + (int)member] | member;
    if (words[i] != expected) fail("common area", place + i, words[i], expected);
  }
  ++checks;
}

int main(int argc, char** argv) {
  const int self = argc > 1 ? atoi(argv[1]) : 0;
  const double seconds = argc > 2 ? atof(argv[2]) : 1;
  unsigned int seen[MEMBERS] = {0}, random = 1, round;
  int i, others = 0;
  struct timespec begin, now;
  if (sp_scram_init(0) < 0) return 1;
  sp_stm_mm(Long_mode);
  scr_csr_write(SCR_CSR8, (unsigned short)(scr_csr_read(SCR_CSR8) & 0xf800));
  scr_csr_write(SCR_CSR9, 0x01a8);
  scr_csr_write(SCR_CSR13, 0);
  scr_csr_write(SCR_CSR2, 0xd040);
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR10, (unsigned short)(scr_csr_read(SCR_CSR10) | 0x11));
  scr_csr_write(SCR_CSR3, (unsigned short)(self << 8));
  memory = (volatile unsigned int*)get_base_mem();
  for (i = 0; i < SEGMENT + SEGMENTS + MEMBERS; ++i) {
    random = random * 1664525u + 1013904223u;
    pattern[i] = random & ~0xFFu;
  }
  for (i = 0; i < SEGMENT * SEGMENTS; ++i) memory[COMMON + i] = pattern[i % SEGMENT + i / SEGMENT];
  for (i = 0; i < SEQUENCE; ++i) memory[SEQUENCES + self * SEQUENCE + i] = 0;
  random = (unsigned int)self;
  clock_gettime(CLOCK_MONOTONIC, &begin);
  for (round = 1;; ++round) {
    int segment, offset, length, place;
    random = random * 1664525u + 1013904223u;
    segment = (int)(random >> 8) % SEGMENTS;
    offset = (int)(random >> 12 & 0xFFFF) % (SEGMENT - PACKET);
    length = 1 + (int)(random >> 20) % (PACKET - 1);
    place = COMMON + segment * SEGMENT + offset;
    memory[REPORTS + self] = round;
    for (i = 0; i < MEMBERS; ++i) {
      const int is_new = seen[i] == 0;
      if (i == self || memory[REPORTS + i] == seen[i]) continue;
      seen[i] = memory[REPORTS + i];
      if (is_new)
        ++others; /* the words of a sequence from before this member came are not here */
      else
        check_sequence(i);
    }
    for (i = 0; i < SEQUENCE; ++i) memory[SEQUENCES + self * SEQUENCE + i] = round;
    check_common(place, segment + offset, length, (round & 1) != 0 && length >= 32);
    for (i = 0; i < length; ++i)
      memory[place + i] = pattern[segment + offset + i + self] | (unsigned int)self;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if ((double)(now.tv_sec - begin.tv_sec) + 1e-9 * (double)(now.tv_nsec - begin.tv_nsec) >
        seconds)
      break;
  }
  printf("%u rounds, %u checks, %d others, %u errors, %u link errors\n", round, checks, others,
         errors, scr_csr_read(SCR_CSR13));
  return errors != 0 || scr_csr_read(SCR_CSR13) != 0;
}
