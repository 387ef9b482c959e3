// SPDX-License-Identifier: Apache-2.0
//
// Functions of the vendor's Windows libraries. Those without a meaning here return the values of a
// card without that feature.

#include <ctime>

#include "plus_state.hpp"

#include <scrplus.h>
#include <scrwin.h>

using namespace rths::scramnet;

namespace {

constexpr unsigned long kNoAddress = 0;
int debug_level = 0;
int transaction_type = 0;

}  // namespace

extern "C" {

unsigned long get_scr_phy_csr_addr(void) { return kNoAddress; }
unsigned long get_scr_phy_mem_addr(void) { return kNoAddress; }
unsigned long get_scr_node_id(void) { return Scramnet_config.scram_node_id; }
unsigned long get_scr_time_out(void) { return Scramnet_config.scram_net_to; }
unsigned long get_scr_user_mem_size(void) { return Scramnet_config.scram_mem_size; }
unsigned long sw_mem_addr(void) { return kNoAddress; }
unsigned long sw_reg_addr(void) { return kNoAddress; }
unsigned long sw_user_size(void) { return Scramnet_config.scram_mem_size; }
int sw_cfg_fill(void) { return 0; }
unsigned long sw_net_to(void) { return Scramnet_config.scram_net_to; }
int sw_set_size(unsigned long) { return -1; }
int sw_get_int(void) { return 0; }
int sw_set_int(int) { return -1; }
int sw_int_connect(void) { return -1; }
int sw_int_disconnect(void) { return 0; }
int sw_int_flush(void) { return 0; }
int sw_int_snapicon(void) { return 0; }
int sw_int_snapidis(void) { return 0; }
void sw_set_debugLevel(int level) { debug_level = level; }
int sw_get_debugLevel(void) { return debug_level; }
void SetScrTransactionType(int type) { transaction_type = type; }
int GetScrTransactionType(void) { return transaction_type; }
int scr_brd_select(int board) { return board == 0 ? 0 : -1; }
int scr_board_status(void*) { return 0; }

void scr_delay(unsigned long milliseconds) {
  const timespec duration{static_cast<time_t>(milliseconds / 1000),
                          static_cast<long>(milliseconds % 1000 * 1'000'000)};
  clock_nanosleep(CLOCK_MONOTONIC, 0, &duration, nullptr);
}

int scr_long_mem_exist(void* address) { return scr_probe_mm(address, 4) == 0 ? TRUE : FALSE; }
int scr_short_mem_exist(void* address) { return scr_probe_mm(address, 2) == 0 ? TRUE : FALSE; }
int scr_byte_mem_exist(void* address) { return scr_probe_mm(address, 1) == 0 ? TRUE : FALSE; }
int scr_mem_read(void* user, unsigned long offset, unsigned long length) {
  return scr_dma_read(user, offset, length);
}
int scr_mem_write(void* user, unsigned long offset, unsigned long length) {
  return scr_dma_write(user, offset, length);
}
void PciIsrCallback(void) {}
int FindCSRSet(void) { return board() != nullptr ? TRUE : FALSE; }
int ScrConfigured(void) { return board() != nullptr ? TRUE : FALSE; }
int ScrFound(void) { return board() != nullptr ? TRUE : FALSE; }
unsigned long GetBIOSInfo(void) { return 0; }
unsigned long GetBIOSVersion(void) { return 0; }
unsigned long GetSysVersion(void) { return 0; }
void* GetApp0MemPtr(void) { return nullptr; }
void* GetApp1MemPtr(void) { return nullptr; }
}
