/* SPDX-License-Identifier: Apache-2.0
 *
 * A program whose forked child ends, and which then stores into a word and stays on the ring. */
#define _POSIX_C_SOURCE 200809L
#include <scrplus.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

int main(void) {
  pid_t child;
  if (sp_scram_init(0) < 0) return 1;
  child = fork();
  if (child == 0) exit(0);
  if (waitpid(child, NULL, 0) != child) return 1;
  get_base_mem()[40] = 1;
  sleep(20);
  return 0;
}
