/* SPDX-License-Identifier: Apache-2.0
 *
 * The vendor's API of SCRAMNet+: the header that clients include. Programs written for the cards
 * compile with it and run on a ring in software; docs/scramnet.md describes the differences.
 *
 * CONFIG_EXTERN and NO_PROTO are accepted without effect (the prototypes accept every call that a
 * K&R declaration accepts). NO_CONFIG selects constants instead of Scramnet_config; _WINNT adds the
 * functions of the Windows libraries. */
#ifndef __SCRPLUS__
#define __SCRPLUS__

#include "scr.h"
#include "scrhwd.h"

#ifdef __cplusplus
extern "C" {
#endif

#define VP_SET 1
#define VP_RESET 2
#define VP_READ 3

#define CNTR_ERRORS 1
#define CNTR_TRIGS 2
#define CNTR_TRANSIT 3
#define CNTR_NET_EVENTS 4
#define CNTR_FREERUN 5
#define CNTR_FREERUN_T2 6

#define GOLD 1
#define BURST 2
#define PLATINUM 3
#define GOLD_PLUS 4
#define BURST_PLUS 5
#define PLATINUM_PLUS 6

#define TAGE_MASK 0xff
#define TXRX_MASK 0xff00
#define MAX_ID 0xff
#define MAX_AGE 0xff
#define ACR_MASK 0x1f
#define ACR_SHIFT 0

#define ACR_RIE 0x1
#define ACR_TIE 0x2
#define ACR_TRIG1 0x4
#define ACR_TRIG2 0x8
#define ACR_HIPRO 0x10
#define ACR_TRIG3 0x20

/* Clients call it with and without a board number, from C and from C++. The argument is ignored:
 * the configuration selects the ring, and C without prototypes may pass any value. */
#if defined(__cplusplus)
int sp_scram_init(int board = 0);
#elif __STDC_VERSION__ > 201710L && \
    (__STDC_VERSION__ >= 202311L || __GNUC__ >= 13 || __clang_major__ >= 15)
int sp_scram_init(...);
#else
int sp_scram_init();
#endif

unsigned long sp_mem_size(void);
int sp_stm_mm(int mode);
int sp_gtm_mm(void);
int sp_msg_life(unsigned hops);
int sp_net_to(unsigned short timeout);
int sp_protocol(unsigned mode);
int sp_rx_id(unsigned id);
int sp_txrx_id(unsigned char id);
int sp_set_cntr(int mode);
int sp_set_sm_addr(unsigned long address);
int sp_set_vp(int request, unsigned page);
int sp_plus_find(void);
int sp_bist_rd(int* bits);
int sp_cfg_read(int board);
void sp_config_file(char* file);
int is_boardline(char* line);

#ifdef __cplusplus
}
#endif
#endif
