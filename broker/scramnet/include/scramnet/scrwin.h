/* SPDX-License-Identifier: Apache-2.0
 *
 * Functions of the vendor's Windows libraries only. On this system they return the values of a card
 * without that feature. */
#ifndef __SCRWIN__
#define __SCRWIN__

#ifdef __cplusplus
extern "C" {
#endif

unsigned long get_scr_phy_csr_addr(void);
unsigned long get_scr_phy_mem_addr(void);
unsigned long get_scr_node_id(void);
unsigned long get_scr_time_out(void);
unsigned long get_scr_user_mem_size(void);
unsigned long sw_mem_addr(void);
unsigned long sw_reg_addr(void);
unsigned long sw_user_size(void);
int sw_cfg_fill(void);
unsigned long sw_net_to(void);
int sw_set_size(unsigned long size);
int sw_get_int(void);
int sw_set_int(int interrupt);
int sw_int_connect(void);
int sw_int_disconnect(void);
int sw_int_flush(void);
int sw_int_snapicon(void);
int sw_int_snapidis(void);
void sw_set_debugLevel(int level);
int sw_get_debugLevel(void);
void SetScrTransactionType(int type);
int GetScrTransactionType(void);
int scr_brd_select(int board);
int scr_board_status(void* window);
void scr_delay(unsigned long milliseconds);
int scr_long_mem_exist(void* address);
int scr_short_mem_exist(void* address);
int scr_byte_mem_exist(void* address);
int scr_mem_read(void* user, unsigned long offset, unsigned long length);
int scr_mem_write(void* user, unsigned long offset, unsigned long length);
void PciIsrCallback(void);
int FindCSRSet(void);
int ScrConfigured(void);
int ScrFound(void);
unsigned long GetBIOSInfo(void);
unsigned long GetBIOSVersion(void);
unsigned long GetSysVersion(void);
void* GetApp0MemPtr(void);
void* GetApp1MemPtr(void);

#ifdef __cplusplus
}
#endif
#endif
