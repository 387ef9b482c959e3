// SPDX-License-Identifier: Apache-2.0
//
// Vendor's GT calls: opening, mapping, states, registers, statistics, error texts.
#include <array>
#include <cstring>
#include <string>

#include "gt_unit.hpp"

using namespace rths::scramnet;

namespace {

static_assert(gt_state::kRingSize == SCGT_RING_SIZE && gt_state::kLinkUp == SCGT_LINK_UP &&
              gt_state::kReadBypassEnable == SCGT_READ_BYPASS_ENABLE &&
              gt_interrupt::kUnicast == SCGT_UNICAST_INTR &&
              gt_interrupt::kBroadcast == SCGT_BROADCAST_INTR);

constexpr uint32 kNoValue = 0xFFFF'FFFF;
constexpr uint32 kRegisterBytes = 0x100, kManagementBytes = 0x2000;
constexpr uint32 kSendBroadcast = 0x1000, kSendUnicast = 0x1800;

constexpr const char* kErrors[] = {"Success",
                                   "System Error",
                                   "Bad Parameter",
                                   "Driver Error",
                                   "Timeout",
                                   "Call Unsupported",
                                   "Insufficient Resources",
                                   "Link Error",
                                   "Missed Interrupts",
                                   "Driver Missed Interrupts",
                                   "DMA Unsupported",
                                   "Hardware Error"};

constexpr std::array<const char*, 7> kStatistics{
    "count", "names_length", "interrupts_received", "interrupts_sent", "interrupts_missed",
    "reads", "writes"};
constexpr std::size_t kFirstCounter = 2;

std::string joined(std::size_t first, std::size_t count) {
  std::string names;
  for (std::size_t i = first; i < first + count; ++i)
    names += (names.empty() ? "" : ",") + std::string{kStatistics[i]};
  return names;
}

uint32 statistic(const GtCard& card, std::size_t index) {
  if (index == 0) return kStatistics.size();
  if (index == 1) return static_cast<uint32>(joined(0, kStatistics.size()).size() + 1);
  return card.counts[index - kFirstCounter].load();
}

template <std::size_t N>
void copy_text(char (&to)[N], const char* text) {
  std::strncpy(to, text, N - 1);
  to[N - 1] = '\0';
}

}  // namespace

extern "C" {

const char* scgtapiRevisionStr = "rths 1.0";
const char* scgtGetApiRevStr(void) { return scgtapiRevisionStr; }

const char* scgtGetErrStr(uint32 code) {
  return code < std::size(kErrors) ? kErrors[code] : "Unknown Error";
}

uint32 scgtOpen(uint32 unit, scgtHandle* handle) {
  if (unit >= SCGT_MAX_DEVICES || handle == nullptr) return SCGT_BAD_PARAMETER;
  if (take_unit(unit) == nullptr) return SCGT_SYSTEM_ERROR;
  *handle = {static_cast<int>(unit), unit, nullptr, 0};
  return SCGT_SUCCESS;
}

uint32 scgtClose(scgtHandle* handle) {
  scgtUnmapMem(handle);
  return SCGT_SUCCESS;
}

void* scgtMapMem(scgtHandle* handle) {
  GtUnit* unit = unit_of(handle);
  if (unit == nullptr) return nullptr;
  if (handle->memMapPtr == nullptr) {
    std::byte* memory = unit->session().map_memory(nullptr, 0, unit->memory_bytes());
    handle->memMapPtr = reinterpret_cast<uint32*>(memory);
    handle->memMapSize = memory == nullptr ? 0 : unit->memory_bytes();
  }
  return handle->memMapPtr;
}

void scgtUnmapMem(scgtHandle* handle) {
  if (handle == nullptr || handle->memMapPtr == nullptr) return;
  CardTable::unmap(reinterpret_cast<std::byte*>(handle->memMapPtr), handle->memMapSize);
  handle->memMapPtr = nullptr;
  handle->memMapSize = 0;
}

uint32 scgtGetDeviceInfo(scgtHandle* handle, scgtDeviceInfo* info) {
  const GtUnit* unit = unit_of(handle);
  if (unit == nullptr || info == nullptr) return SCGT_BAD_PARAMETER;
  *info = {};
  copy_text(info->driverRevisionStr, scgtapiRevisionStr);
  copy_text(info->boardLocationStr, "ring in shared memory");
  info->unitNum = handle->unitNum;
  info->popMemSize = unit->memory_bytes();
  info->mappedMemSize = handle->memMapPtr != nullptr ? handle->memMapSize : unit->memory_bytes();
  info->numLinks = 1;
  return SCGT_SUCCESS;
}

uint32 scgtGetState(scgtHandle* handle, uint32 state) {
  const GtUnit* unit = unit_of(handle);
  return unit == nullptr ? kNoValue : get_state(unit->card(), state, unit->ring());
}

uint32 scgtSetState(scgtHandle* handle, uint32 state, uint32 value) {
  const GtUnit* unit = unit_of(handle);
  if (unit == nullptr) return SCGT_BAD_PARAMETER;
  const StateResult result = set_state(unit->card(), state, value);
  if (result == StateResult::Ok) return SCGT_SUCCESS;
  return result == StateResult::Unsupported ? SCGT_CALL_UNSUPPORTED : SCGT_BAD_PARAMETER;
}

uint32 scgtReadCR(scgtHandle* handle, uint32 offset) {
  const GtUnit* unit = unit_of(handle);
  if (unit == nullptr || offset >= kRegisterBytes) return kNoValue;
  return read_cr(unit->card(), offset / 4, unit->ring());
}

uint32 scgtWriteCR(scgtHandle* handle, uint32 offset, uint32 value) {
  const GtUnit* unit = unit_of(handle);
  if (unit == nullptr || offset >= kRegisterBytes) return SCGT_BAD_PARAMETER;
  if (offset / 4 == gt::kUser && (value & gt::kSwaps) != 0) return SCGT_CALL_UNSUPPORTED;
  write_cr(unit->card(), offset / 4, value);
  return SCGT_SUCCESS;
}

// The registers that send interrupts read as 0, and so does the hardware's queue: interrupts go
// directly into the driver's queue.
uint32 scgtReadNMR(scgtHandle* handle, uint32 offset) {
  return unit_of(handle) == nullptr || offset >= kManagementBytes ? kNoValue : 0;
}

uint32 scgtWriteNMR(scgtHandle* handle, uint32 offset, uint32 value) {
  GtUnit* unit = unit_of(handle);
  if (unit == nullptr || offset >= kManagementBytes) return SCGT_BAD_PARAMETER;
  scgtInterrupt interrupt{SCGT_NO_INTR, 0, 0, value, 0};
  if (offset >= kSendBroadcast && offset < kSendBroadcast + 4 * kBroadcasts) {
    interrupt.type = SCGT_BROADCAST_INTR;
    interrupt.id = (offset - kSendBroadcast) / 4;
  } else if (offset >= kSendUnicast && offset < kSendUnicast + 4 * kNodes) {
    interrupt.type = SCGT_UNICAST_INTR;
    interrupt.id = (offset - kSendUnicast) / 4;
  }
  if (interrupt.type == SCGT_NO_INTR || unit->send(interrupt)) return SCGT_SUCCESS;
  return SCGT_DRIVER_ERROR;
}

uint32 scgtGetStats(scgtHandle* handle, uint32* values, char* names, uint32 first, uint32 count) {
  const GtUnit* unit = unit_of(handle);
  if (unit == nullptr || first > kStatistics.size() || count > kStatistics.size() - first)
    return SCGT_BAD_PARAMETER;
  for (uint32 i = 0; values != nullptr && i < count; ++i)
    values[i] = statistic(unit->card(), first + i);
  if (names != nullptr) std::strcpy(names, joined(first, count).c_str());
  return SCGT_SUCCESS;
}
}
