// SPDX-License-Identifier: Apache-2.0
#include <sys/stat.h>

#include <array>
#include <cstring>

#include "vendor_ring.hpp"

#include <scgtapi.h>

namespace {

using rths::test::Running;

constexpr uint32 kFresh = 0xFFFFFFFF;

class Gt : public rths::test::VendorRing {
 protected:
  void SetUp() override {
    ASSERT_EQ(scgtOpen(0, &handle_), uint32{SCGT_SUCCESS});
    set(SCGT_NODE_ID, 3);
    set(SCGT_BROADCAST_INT_MASK, 0);
    set(SCGT_UNICAST_INT_MASK, 0);
    set(SCGT_INT_SELF_ENABLE, 0);
    set(SCGT_TRANSMIT_ENABLE, 1);
    set(SCGT_RECEIVE_ENABLE, 1);
  }
  void TearDown() override { scgtClose(&handle_); }

  void set(uint32 state, uint32 value) {
    EXPECT_EQ(scgtSetState(&handle_, state, value), uint32{SCGT_SUCCESS}) << state;
  }
  uint32 get(uint32 state) { return scgtGetState(&handle_, state); }
  static void sender(const std::string& type, uint32 id, uint32 count) {
    const auto done =
        Running{client("gt_sender", {type, std::to_string(id), std::to_string(count)})}.wait();
    ASSERT_EQ(done.exit_code, 0) << done.err;
  }
  uint32 receive(scgtIntrHandle& cursor, uint32 timeout_ms = 0) {
    return scgtGetInterrupt(&handle_, &cursor, got_.data(), static_cast<uint32>(got_.size()),
                            timeout_ms, &count_);
  }

  scgtHandle handle_{};
  std::array<scgtInterrupt, 2000> got_{};
  uint32 count_ = 0;
};

TEST_F(Gt, RefusesWrongParameters) {
  scgtHandle handle{};
  EXPECT_EQ(scgtOpen(16, &handle), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtOpen(0, nullptr), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtClose(nullptr), uint32{SCGT_SUCCESS});
  uint32 word = 1;
  const scgtInterrupt wrong{SCGT_BROADCAST_INTR, 0, 32, 0, 0};
  const scgtInterrupt none{SCGT_NO_INTR, 0, 0, 0, 0};
  const scgtInterrupt error{SCGT_ERROR_INTR, 0, 0, 0, 0};
  EXPECT_EQ(scgtWrite(&handle_, 0, &word, 4, SCGT_RW_PIO, nullptr, nullptr),
            uint32{SCGT_BAD_PARAMETER})
      << "not mapped yet";
  EXPECT_EQ(scgtWrite(&handle_, 0, &word, 4, 0, nullptr, &wrong), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtWrite(&handle_, 0, &word, 4, 0, nullptr, &error), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtWrite(&handle_, 0, nullptr, 0, 0, nullptr, nullptr), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtWrite(&handle_, 0, nullptr, 0, 0, nullptr, &none), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtRead(&handle_, 128U << 20U, &word, 4, 0, nullptr), uint32{SCGT_BAD_PARAMETER});
  EXPECT_EQ(scgtWrite(&handle_, 0, &word, 4, SCGT_RW_DMA_PHYS_ADDR, nullptr, nullptr),
            uint32{SCGT_DMA_UNSUPPORTED});
}

TEST_F(Gt, MapsASparseMemoryOf128Mb) {
  auto* memory = static_cast<uint32*>(scgtMapMem(&handle_));
  ASSERT_NE(memory, nullptr);
  EXPECT_EQ(scgtMapMem(&handle_), memory);
  EXPECT_EQ(handle_.memMapSize, 128U << 20U);
  memory[(64U << 20U) / 4] = 5;
  EXPECT_EQ(memory[(64U << 20U) / 4], 5U);
  struct stat object {};
  ASSERT_EQ(stat(("/dev/shm/rths." + ring() + "_gt").c_str(), &object), 0);
  EXPECT_LT(object.st_blocks * 512, 1 << 20);
  scgtDeviceInfo info{};
  EXPECT_EQ(scgtGetDeviceInfo(&handle_, &info), uint32{SCGT_SUCCESS});
  EXPECT_EQ(info.mappedMemSize, 128U << 20U);
  scgtUnmapMem(&handle_);
  scgtUnmapMem(&handle_);
  EXPECT_EQ(handle_.memMapPtr, nullptr);
}

TEST_F(Gt, RoundsTransfersDownToTheirWidth) {
  auto* memory = static_cast<unsigned char*>(scgtMapMem(&handle_));
  const std::array<unsigned char, 8> data{1, 2, 3, 4, 5, 6, 7, 8};
  uint32 done = 0;
  std::memset(memory, 0, 32);
  EXPECT_EQ(scgtWrite(&handle_, 5, data.data(), 7, SCGT_RW_PIO, &done, nullptr), 0U);
  EXPECT_EQ(done, 4U);
  EXPECT_EQ(memory[4], 1);
  EXPECT_EQ(memory[8], 0);
  EXPECT_EQ(
      scgtWrite(&handle_, 9, data.data(), 3, SCGT_RW_PIO | SCGR_RW_PIO_16_BIT, &done, nullptr), 0U);
  EXPECT_EQ(done, 2U);
  EXPECT_EQ(memory[8], 1);
  EXPECT_EQ(
      scgtWrite(&handle_, 13, data.data(), 3, SCGT_RW_PIO | SCGR_RW_PIO_8_BIT, &done, nullptr), 0U);
  EXPECT_EQ(done, 3U);
  EXPECT_EQ(memory[13], 1);
  std::array<unsigned char, 8> back{};
  EXPECT_EQ(scgtRead(&handle_, 4, back.data(), 8, 0, &done), 0U);
  EXPECT_EQ(back[3], 4);
  EXPECT_EQ(scgtWrite(&handle_, 64, data.data(), 8, SCGT_RW_DMA_BYTE_SWAP, &done, nullptr), 0U);
  EXPECT_EQ(memory[64], 4);
  EXPECT_EQ(scgtWrite(&handle_, 64, data.data(), 8, SCGT_RW_DMA_WORD_SWAP, &done, nullptr), 0U);
  EXPECT_EQ(memory[64], 5);
}

TEST_F(Gt, KeepsStatesAndRefusesToSetReadOnlyOnes) {
  EXPECT_EQ(get(SCGT_NODE_ID), 3U);
  set(SCGT_NODE_ID, 0x1FF);
  EXPECT_EQ(get(SCGT_NODE_ID), 0xFFU);
  set(SCGT_TRANSMIT_ENABLE, 55);
  EXPECT_EQ(get(SCGT_TRANSMIT_ENABLE), 1U);
  set(SCGT_NUM_LINK_ERRS, 9);
  EXPECT_EQ(get(SCGT_NUM_LINK_ERRS), 0U);
  set(SCGT_UNICAST_INT_MASK, 2);
  EXPECT_EQ(get(SCGT_UNICAST_INT_MASK), 0U);
  set(SCGT_D64_ENABLE, 0);
  EXPECT_EQ(get(SCGT_D64_ENABLE), 0U);
  EXPECT_EQ(get(SCGT_LINK_UP), 1U);
  EXPECT_EQ(get(SCGT_LASER_0_SIGNAL_DET), 1U);
  EXPECT_GE(get(SCGT_RING_SIZE), 1U);
  EXPECT_LE(get(SCGT_RING_SIZE), 255U);
  for (const uint32 state : {SCGT_RING_SIZE, SCGT_UPSTREAM_NODE_ID, SCGT_LINK_UP,
                             SCGT_LASER_0_SIGNAL_DET, SCGT_LASER_1_SIGNAL_DET, 28, 1000})
    EXPECT_EQ(scgtSetState(&handle_, state, 1), uint32{SCGT_BAD_PARAMETER}) << state;
  EXPECT_EQ(get(28), kFresh);
  set(SCGT_WORD_SWAP_ENABLE, 0);
  EXPECT_EQ(scgtSetState(&handle_, SCGT_BYTE_SWAP_ENABLE, 1), uint32{SCGT_CALL_UNSUPPORTED});
}

TEST_F(Gt, HasRegistersBehindItsStates) {
  EXPECT_EQ(scgtReadCR(&handle_, 0x10) >> 8 & 0xFF, 3U);
  EXPECT_EQ(scgtWriteCR(&handle_, 0x1B, 0xF0), uint32{SCGT_SUCCESS});
  EXPECT_EQ(get(SCGT_BROADCAST_INT_MASK), 0xF0U);
  EXPECT_EQ(scgtReadCR(&handle_, 0x14) & 0xE0000, 0xE0000U);
  EXPECT_EQ(scgtReadCR(&handle_, 0x100), kFresh);
  EXPECT_EQ(scgtReadNMR(&handle_, 0x2000), kFresh);
  EXPECT_EQ(scgtWriteNMR(&handle_, 0x2000, 0), uint32{SCGT_BAD_PARAMETER});
  const uint32 begun = get(SCGT_NET_TIMER_VAL);
  while (get(SCGT_NET_TIMER_VAL) == begun) {
  }
}

TEST_F(Gt, ReceivesTheBroadcastsOfItsMaskAfterTheirData) {
  scgtIntrHandle cursor = kFresh;
  EXPECT_EQ(receive(cursor), uint32{SCGT_TIMEOUT});
  set(SCGT_BROADCAST_INT_MASK, 1U << 5U);
  sender("broadcast", 4, 2);
  EXPECT_EQ(receive(cursor), uint32{SCGT_TIMEOUT});
  EXPECT_EQ(count_, 0U);

  sender("broadcast", 5, 3);

  EXPECT_EQ(receive(cursor), uint32{SCGT_SUCCESS});
  ASSERT_EQ(count_, 3U);
  for (uint32 i = 0; i < 3; ++i) {
    EXPECT_EQ(got_[i].type, uint32{SCGT_BROADCAST_INTR});
    EXPECT_EQ(got_[i].id, 5U);
    EXPECT_EQ(got_[i].sourceNodeID, 7U);
    EXPECT_EQ(got_[i].val, i + 1);
    EXPECT_EQ(got_[i].seqNum, got_[0].seqNum + i);
  }
  uint32 word = 0;
  EXPECT_EQ(scgtRead(&handle_, 64, &word, 4, 0, nullptr), 0U);
  EXPECT_EQ(word, 3U);
  EXPECT_GE(get(SCGT_RING_SIZE), 2U);
  EXPECT_EQ(get(SCGT_UPSTREAM_NODE_ID), 7U);
}

TEST_F(Gt, ReceivesUnicastsOnlyForItsIdAndOnlyIfEnabled) {
  scgtIntrHandle cursor = kFresh;
  static_cast<void>(receive(cursor));
  sender("unicast", 3, 1);
  EXPECT_EQ(receive(cursor), uint32{SCGT_TIMEOUT});
  set(SCGT_UNICAST_INT_MASK, 1);
  sender("unicast", 4, 1);
  EXPECT_EQ(receive(cursor), uint32{SCGT_TIMEOUT});
  sender("unicast", 3, 1);
  EXPECT_EQ(receive(cursor), uint32{SCGT_SUCCESS});
  EXPECT_EQ(got_[0].type, uint32{SCGT_UNICAST_INTR});
  EXPECT_EQ(got_[0].id, 0U);
}

TEST_F(Gt, InterruptsItselfOnlyIfEnabled) {
  scgtIntrHandle cursor = kFresh;
  static_cast<void>(receive(cursor));
  set(SCGT_BROADCAST_INT_MASK, kFresh);
  const scgtInterrupt interrupt{SCGT_BROADCAST_INTR, 0, 9, 77, 0};
  EXPECT_EQ(scgtWrite(&handle_, 0, nullptr, 0, 0, nullptr, &interrupt), 0U);
  EXPECT_EQ(receive(cursor), uint32{SCGT_TIMEOUT});
  set(SCGT_INT_SELF_ENABLE, 1);
  EXPECT_EQ(scgtWriteNMR(&handle_, 0x1000 + 4 * 9, 78), 0U);
  EXPECT_EQ(receive(cursor, 1000), uint32{SCGT_SUCCESS});
  EXPECT_EQ(got_[0].val, 78U);
}

TEST_F(Gt, GivesEveryReaderEveryInterruptOrReportsMissedOnes) {
  set(SCGT_BROADCAST_INT_MASK, 1);
  scgtIntrHandle first = kFresh;
  scgtIntrHandle second = kFresh;
  static_cast<void>(receive(first));
  static_cast<void>(receive(second));
  sender("broadcast", 0, 1023);
  EXPECT_EQ(receive(first), uint32{SCGT_SUCCESS});
  EXPECT_EQ(count_, 1023U);
  sender("broadcast", 0, 1);

  EXPECT_EQ(receive(second), uint32{SCGT_MISSED_INTERRUPTS});
  EXPECT_EQ(count_, 1023U);
  EXPECT_EQ(got_[0].val, 2U);
  EXPECT_EQ(receive(second), uint32{SCGT_TIMEOUT});
  scgtIntrHandle wrong = 0x10000000;
  EXPECT_EQ(receive(wrong), uint32{SCGT_BAD_PARAMETER});
}

TEST_F(Gt, WakesASleepingReader) {
  set(SCGT_BROADCAST_INT_MASK, 1);
  scgtIntrHandle cursor = kFresh;
  Running later{client("gt_sender", {"broadcast", "0", "1"})};
  EXPECT_EQ(receive(cursor, 10'000), uint32{SCGT_SUCCESS});
  EXPECT_EQ(later.wait().exit_code, 0);
}

TEST_F(Gt, HasErrorTextsAndStatistics) {
  EXPECT_STREQ(scgtGetErrStr(SCGT_MISSED_INTERRUPTS), "Missed Interrupts");
  EXPECT_STREQ(scgtGetErrStr(SCGT_HARDWARE_ERROR), "Hardware Error");
  EXPECT_STREQ(scgtGetErrStr(12), "Unknown Error");
  EXPECT_STREQ(scgtGetApiRevStr(), scgtapiRevisionStr);
  uint32 head[2];
  ASSERT_EQ(scgtGetStats(&handle_, head, nullptr, 0, 2), 0U);
  std::vector<uint32> values(head[0]);
  std::string names(head[1], '\0');
  ASSERT_EQ(scgtGetStats(&handle_, values.data(), names.data(), 0, head[0]), 0U);
  EXPECT_EQ(std::strlen(names.c_str()) + 1, head[1]);
  EXPECT_EQ(scgtGetStats(&handle_, values.data(), nullptr, 1, head[0]), uint32{SCGT_BAD_PARAMETER});
}

TEST_F(Gt, RunsABenchmarkWithABarrierOfBytes) {
  Running first{client("ptest", {"0", "60"})};
  Running second{client("ptest", {"1", "60"})};
  EXPECT_EQ(first.wait().exit_code, 0);
  EXPECT_EQ(second.wait().exit_code, 0);
}

}  // namespace
