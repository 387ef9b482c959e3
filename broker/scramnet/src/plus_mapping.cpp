// SPDX-License-Identifier: Apache-2.0
//
// Vendor's calls: taking a card, mapping its registers and its memory.
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <string_view>

#include "plus_state.hpp"

#include <scrplus.h>

namespace {

char csr_device[] = SCR_CSR_DEV_DEF;
char memory_device[] = SCR_MEM_DEV_DEF;
char interrupt_device[] = SCR_INT_DEV_DEF;

}  // namespace

extern "C" {
SCRAM_CFG Scramnet_config = {SCR_REG_BASE_DEF, SCR_MEM_BASE_DEF, SCR_MEM_LEN_DEF, SCR_VECTOR_DEF,
                             SCR_VECTOR_DEF,   SCR_NODE_ID_DEF,  SCR_NET_TO_DEF,  memory_device,
                             csr_device,       interrupt_device};
int scr_csr_fd = -1;
int scr_registers_mapped = 0;
int scr_memory_mapped = 0;
int sp_plus_flag = 1;
}

namespace rths::scramnet {
namespace {

constexpr unsigned short kTimeout = 100;  // default of the vendor's library [240 ns]
unsigned long memory_size = 0;            // when the registers were mapped [B]

int map_registers() noexcept {
  BoardError error{};
  Board* card = take_board(error);
  if (card == nullptr) return static_cast<int>(error);
  if (scr_csr_fd < 0) scr_csr_fd = open_descriptor();
  scr_registers_mapped = 1;
  memory_size = card->card_bytes();
  return 0;
}

int map_memory() noexcept {
  BoardError error{};
  Board* card = take_board(error);
  if (card == nullptr) return static_cast<int>(error);
  if (!card->map_window()) return static_cast<int>(BoardError::Memory);
  Scramnet_config.scram_mem_size = card->window_bytes();
  scr_memory_mapped = 1;
  return 0;
}

// Like the vendor's library: sets id and time-out, does not change CSR0 and CSR2.
int initialise() noexcept {
  if (scr_registers_mapped != 0 && scr_memory_mapped != 0) return 0;
  if (const int error = map_registers(); error != 0) return error;
  Board& card = *board();
  const std::uint32_t key = card.session().card().key.load();
  const std::uint32_t id = (key & kNamed) != 0 ? key & 0xFF : default_id(card.session().index());
  card.write_csr(3, id << 8);
  card.write_csr(5, kTimeout);
  Scramnet_config.scram_node_id = static_cast<unsigned short>(id);
  Scramnet_config.scram_net_to = kTimeout;
  sp_set_sm_addr(0);
  return map_memory();
}

}  // namespace

Board* card_with_registers() noexcept { return scr_registers_mapped != 0 ? board() : nullptr; }
Board* card_with_memory() noexcept { return scr_memory_mapped != 0 ? board() : nullptr; }

}  // namespace rths::scramnet

using namespace rths::scramnet;

extern "C" {

int sp_scram_init(int) { return initialise(); }

int scr_reg_mm(int command) {
  if (command == MAP) return map_registers() == 0 ? 0 : -1;
  scr_registers_mapped = 0;
  return 0;
}

int scr_mem_mm(int command) {
  if (command == MAP) return map_memory() == 0 ? 0 : -1;
  if (Board* card = board()) card->unmap_window();
  scr_memory_mapped = 0;
  return 0;
}

SCR_LONG_PTR get_base_mem(void) {
  const Board* card = card_with_memory();
  return card == nullptr ? nullptr : reinterpret_cast<SCR_LONG_PTR>(card->window());
}

unsigned long sp_mem_size(void) { return memory_size; }

// On hardware the other two modes swap bytes in the bus bridge. A memory mapping cannot swap, and
// accepting the mode would give wrong values.
int sp_stm_mm(int mode) {
  if (mode != Word_mode && mode != Byte_mode) return TRUE;
  warn_once("swap", "byte-swapped windows are not supported; the mode stays Long_mode");
  return FALSE;
}

int sp_gtm_mm(void) { return Long_mode; }
void scr_bswp_mm(void) {}

int scr_probe_mm(void* address, unsigned short size) {
  if (size != 1 && size != 2 && size != 4) return -1;
  const auto page = static_cast<std::uintptr_t>(sysconf(_SC_PAGESIZE));
  unsigned char resident = 0;
  for (const int last : {0, size - 1}) {
    auto* byte = static_cast<unsigned char*>(address) + last;
    byte -= reinterpret_cast<std::uintptr_t>(byte) % page;
    if (mincore(byte, 1, &resident) != 0) return -1;
  }
  return 0;
}

void sp_config_file(char* file) { set_config_file(file); }
int sp_cfg_read(int) { return 0; }
int is_boardline(char* line) {
  constexpr std::string_view kTable = "[scramnet]";
  return line != nullptr && std::string_view{line}.substr(0, kTable.size()) == kTable ? 1 : 0;
}
}
