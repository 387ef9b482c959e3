/* SPDX-License-Identifier: Apache-2.0
 *
 * Modelled on old programs: K&R declarations, no configuration structure, the interrupt device
 * opened by its name. */
#define NO_PROTO
#define NO_CONFIG
#define _WINNT 1
#include <fcntl.h>
#include <scrplus.h>
#include <stdio.h>
#include <unistd.h>

extern void scr_mclr_mm();
extern int scr_reg_mm();
extern void scr_int_mm();

int main(void) {
  struct rd_fifo fifo;
  int device;
  if (scr_reg_mm(MAP) != 0 || scr_mem_mm(MAP) != 0) return 1;
  scr_mclr_mm(ACR);
  device = open(SCR_INT_DEV, O_RDWR);
  if (device < 0) return 2;
  if (ioctl(device, INTSIG, SET_SIG) != 0 || ioctl(device, FLUSHSIG, 0) != 0) return 3;
  if (ioctl(device, RD_FIFO, &fifo) != 0 || fifo.mt_flag != 1) return 4;
  if (close(device) != 0 || ioctl(device, FLUSHSIG, 0) != -1) return 5;
  device = open("/dev/null", O_RDONLY);
  if (device < 0 || ioctl(device, INTSIG, SET_SIG) != -1) return 6;
  if (SCR_MEM_LEN != 0x200000 || sizeof(byte) != 1) return 7;
  puts("ok");
  return 0;
}
