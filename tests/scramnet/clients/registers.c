/* SPDX-License-Identifier: Apache-2.0
 *
 * Sets and prints registers, ACR and words of its card, in the order of the arguments:
 *   registers csr0=8003 acr5=2 word5=7 csr0 acr5 word5      (hexadecimal values)
 */
#include <scrplus.h>
#include <stdlib.h>
#include <string.h>

static void set(const char* name, unsigned long number, unsigned value) {
  if (strncmp(name, "csr", 3) == 0) scr_csr_write((int)number, (unsigned short)value);
  if (strncmp(name, "acr", 3) == 0) scr_acr_write(number, (unsigned char)value);
  if (strncmp(name, "word", 4) == 0) get_base_mem()[number] = value;
}

static unsigned value_of(const char* name, unsigned long number) {
  if (strncmp(name, "csr", 3) == 0) return scr_csr_read((int)number);
  return strncmp(name, "acr", 3) == 0 ? scr_acr_read(number) : get_base_mem()[number];
}

int main(int argc, char** argv) {
  int i;
  if (sp_scram_init(0) < 0) return 1;
  for (i = 1; i < argc; ++i) {
    const char* value = strchr(argv[i], '=');
    const unsigned long number = strtoul(argv[i] + strcspn(argv[i], "0123456789"), NULL, 10);
    if (value != NULL)
      set(argv[i], number, (unsigned)strtoul(value + 1, NULL, 16));
    else
      printf("%x\n", value_of(argv[i], number));
  }
  return 0;
}
