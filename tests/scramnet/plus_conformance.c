/* SPDX-License-Identifier: Apache-2.0 */
#define _WINNT 1 /* includes the names of the Windows libraries */
#include <scrplus.h>

#include "conformance_c.h"

/* Fills `checks` up to its capacity; returns the number of checks. */
unsigned plus_names_in_c(struct name_check* checks, unsigned capacity);

unsigned plus_names_in_c(struct name_check* checks, unsigned capacity) {
  const struct name_check all[] = {
#include "plus_names.inc"
  };
  const unsigned count = sizeof all / sizeof all[0];
  memcpy(checks, all, (count < capacity ? count : capacity) * sizeof all[0]);
  return count;
}
