/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the vendor's tools, built for SCRAMNet+. */
#include <scrplus.h>
#include <stdio.h>

#include "usys.h"

#define HAND uint32

int main(void) {
  HAND board = 0;
  if (sp_scram_init((int)board) < 0 || get_base_mem() == NULL) return 1;
  get_base_mem()[16] = 7;
  if (get_base_mem()[16] != 7) return 2;
  puts("ok");
  return 0;
}
