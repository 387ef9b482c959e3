// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace rths::scramnet {

// The register bits that this software acts on. The vendor's macros for them are not used here:
// names like MAP or ACR would replace names in our own code.
namespace csr0 {
inline constexpr std::uint32_t kReceive = 0x1, kTransmit = 0x2, kHostInterrupts = 0x8,
                               kAcrWindow = 0x10, kMemoryInterrupts = 0x20,
                               kAllReceiveInterrupts = 0x40, kErrorInterrupts = 0x80,
                               kSendInterrupts = 0x100, kAllSendInterrupts = 0x200, kFilter = 0x400,
                               kFilterAlsoLow = 0x800, kResetInterruptFifo = 0x2000,
                               kResetTransmitFifo = 0x4000, kInsert = 0x8000;
}
namespace csr1 {
inline constexpr std::uint32_t kTransmitFifoFull = 0x1, kTransmitFifoNotEmpty = 0x2,
                               kTransmitFifoSevenEighths = 0x4, kInterruptFifoFull = 0x10,
                               kNoCarrier = 0x40, kBadMessage = 0x80, kRepeatedAfterError = 0x200,
                               kRepeatedAfterTimeout = 0x400, kCounterOverflow = 0x1000,
                               kArmed = 0x4000, kNoBypassSwitch = 0x8000;
}
namespace csr2 {
inline constexpr std::uint32_t kNoFibreLoopback = 0x40, kWireLoopback = 0x80, kNoHostWrite = 0x100,
                               kReceiveOwn = 0x200, kInterruptOwn = 0x400, kLongBlocks = 0x800,
                               kBlocks = 0x1000, kHiPro = 0x2000, kNoCorrection = 0x8000;
inline constexpr std::uint32_t kWriteMeLast = kNoHostWrite | kReceiveOwn;
}  // namespace csr2
namespace csr5 {
inline constexpr std::uint32_t kNotEmpty = 0x8000, kRepeated = 0x4000;
}
namespace csr8 {
inline constexpr std::uint32_t kIdMux = 0x1, kNoHoldoff = 0x2, kResetAll = 0x100, kFreeRun = 0x200,
                               kAllInterrupt = 0x400, kNoSwitchLoopback = 0x800, kSizeMask = 0x7000,
                               kAlwaysSet = 0x8000;
inline constexpr std::uint32_t kSizeShift = 12;
}  // namespace csr8
namespace csr9 {
inline constexpr std::uint32_t kSelfTest = 0x8, kCountTriggers = 0x2000, kCountErrors = 0x4000;
}
namespace csr12 {
inline constexpr std::uint32_t kPaging = 0x1, kPageMask = 0xFFE0;
inline constexpr std::uint32_t kPageShift = 7;  // bit 5 is address bit 12
}  // namespace csr12
namespace acr {
inline constexpr std::uint32_t kReceiveInterrupt = 0x1, kTransmitInterrupt = 0x2,
                               kTriggerOnHostWrite = 0x4, kTriggerOnMessage = 0x8, kHiPro = 0x10,
                               kBits = 0x1f;
}

}  // namespace rths::scramnet
