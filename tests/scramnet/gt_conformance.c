/* SPDX-License-Identifier: Apache-2.0 */
#include <scgtapi.h>

#include "conformance_c.h"

#define CONSTED const

unsigned gt_names_in_c(struct name_check* checks, unsigned capacity);

unsigned gt_names_in_c(struct name_check* checks, unsigned capacity) {
  const struct name_check all[] = {
#include "gt_names.inc"
  };
  const unsigned count = sizeof all / sizeof all[0];
  memcpy(checks, all, (count < capacity ? count : capacity) * sizeof all[0]);
  return count;
}
