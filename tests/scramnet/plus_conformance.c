/* SPDX-License-Identifier: Apache-2.0 */
#define _WINNT 1 /* the names of the Windows libraries too */
#include <scrplus.h>

#include "conformance_c.h"

/* Fills `checks` as far as it goes; returns how many there are. */
unsigned plus_names_in_c(struct name_check* checks, unsigned room);

unsigned plus_names_in_c(struct name_check* checks, unsigned room) {
  const struct name_check all[] = {
#include "plus_names.inc"
  };
  const unsigned count = sizeof all / sizeof all[0];
  memcpy(checks, all, (count < room ? count : room) * sizeof all[0]);
  return count;
}
