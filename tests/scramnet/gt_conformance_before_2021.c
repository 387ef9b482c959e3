/* SPDX-License-Identifier: Apache-2.0 */
#define SCGT_API_BEFORE_2021
#include <scgtapi.h>

#include "conformance_c.h"

#define CONSTED

unsigned old_gt_names_in_c(struct name_check* checks, unsigned capacity);

unsigned old_gt_names_in_c(struct name_check* checks, unsigned capacity) {
  const struct name_check all[] = {
#include "gt_names.inc"
  };
  const unsigned count = sizeof all / sizeof all[0];
  memcpy(checks, all, (count < capacity ? count : capacity) * sizeof all[0]);
  return count;
}
