/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on the C side of a Java bridge: calls get_base_mem for every access, and reads and
 * writes several types, including long and double. */
#include <scrplus.h>
#include <stdio.h>

static int initialise(void) {
  if (sp_scram_init() != 0) return 0;
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR2, 0xC040);
  return 1;
}

static void put_int(int index, int value) { ((int*)get_base_mem())[index] = value; }
static int get_int(int index) { return ((int*)get_base_mem())[index]; }
static void put_double(int index, double value) { ((double*)get_base_mem())[index] = value; }
static double get_double(int index) { return ((double*)get_base_mem())[index]; }
static void put_long(int index, long value) { ((long*)get_base_mem())[index] = value; }
static long get_long(int index) { return ((long*)get_base_mem())[index]; }
static void put_byte(int index, byte value) { ((byte*)get_base_mem())[index] = value; }
static byte get_byte(int index) { return ((byte*)get_base_mem())[index]; }

int main(void) {
  if (!initialise()) return 1;
  if (sp_stm_mm(0) != TRUE) return 2;
  scr_mclr_mm(MEM);
  put_int(64, -5);
  put_double(100, 2.5);
  put_long(101, 1L << 40);
  put_byte(3, 200);
  if (get_int(64) != -5 || get_base_mem()[64] != 0xFFFFFFFBU) return 3;
  if (get_double(100) != 2.5 || get_long(101) != 1L << 40 || get_byte(3) != 200) return 4;
  if (get_base_mem()[0] != 200U << 24) return 5;
  if (scr_mem_mm(UNMAP) != 0 || scr_reg_mm(UNMAP) != 0) return 6;
  puts("ok");
  return 0;
}
