// SPDX-License-Identifier: Apache-2.0
//
// Every call that moves a block moves each longword by one access, against a thread that writes or
// reads the same words through a pointer. Blocks, offsets and buffers have all alignments.
#include <array>
#include <functional>
#include <vector>

#include "support/whole_longwords.hpp"
#include "vendor_ring.hpp"

#include <scgtapi.h>
#include <scrplus.h>
#include <scrwin.h>

namespace {

using rths::test::LongwordReader;
using rths::test::LongwordWriter;
using rths::test::Seen;
using rths::test::StressEnd;
using rths::test::whole_longword;

constexpr unsigned kBlock = 16'384;  // [B]
constexpr unsigned kAt = 4096;       // begin of the block on the ring [B]

/// A call with the arguments of scr_dma_read: user's buffer, byte offset and byte count.
using Call = std::function<int(void*, unsigned, unsigned)>;
struct NamedCall {
  const char* name;
  Call call;
};

/// Alignments of one call, which follow from its number: of the buffer, the offset and the count.
struct Case {
  unsigned buffer, begin, cut;
  explicit Case(std::uint64_t number)
      : buffer{static_cast<unsigned>(number % 4)},
        begin{static_cast<unsigned>(number / 4 % 4)},
        cut{static_cast<unsigned>(number / 16 % 4)} {}
  /// Bytes before the first longword of the ring that is inside the block.
  [[nodiscard]] unsigned ragged() const { return (4 - begin) % 4; }
  [[nodiscard]] unsigned bytes() const { return kBlock - begin - cut; }
};

class BlockCopies : public rths::test::VendorRing {
 protected:
  void SetUp() override {
    ASSERT_EQ(sp_scram_init(0), 0);
    ASSERT_EQ(scgtOpen(0, &handle_), uint32{SCGT_SUCCESS});
    ASSERT_NE(scgtMapMem(&handle_), nullptr);
  }
  void TearDown() override { scgtClose(&handle_); }

  static std::span<std::uint32_t> plus_words() {
    return {const_cast<unsigned*>(get_base_mem()) + kAt / 4, kBlock / 4};
  }
  std::span<std::uint32_t> gt_words() const { return {handle_.memMapPtr + kAt / 4, kBlock / 4}; }
  [[nodiscard]] std::vector<NamedCall> gt_reads() {
    std::vector<NamedCall> calls;
    for (const auto& [name, flags] : kGtFlags)
      calls.push_back({name, [this, how = flags](void* user, unsigned offset, unsigned bytes) {
                         return static_cast<int>(
                             scgtRead(&handle_, offset, user, bytes, how, nullptr));
                       }});
    return calls;
  }
  [[nodiscard]] std::vector<NamedCall> gt_writes() {
    std::vector<NamedCall> calls;
    for (const auto& [name, flags] : kGtFlags)
      calls.push_back({name, [this, how = flags](void* user, unsigned offset, unsigned bytes) {
                         return static_cast<int>(
                             scgtWrite(&handle_, offset, user, bytes, how, nullptr, nullptr));
                       }});
    return calls;
  }

  /// Reads blocks while a thread writes them.
  static void expect_whole_reads(const NamedCall& read, std::span<std::uint32_t> words,
                                 bool rounds) {
    std::vector<std::byte> buffer(kBlock + 4);
    const LongwordWriter writer{words};
    Seen seen;
    const StressEnd end;
    for (std::uint64_t number = 0; !end.reached(seen.longwords, seen.changes); ++number) {
      const Case c{number};
      ASSERT_EQ(read.call(buffer.data() + c.buffer, kAt + c.begin, c.bytes()), 0) << read.name;
      const unsigned ragged = rounds ? 0 : c.ragged();
      seen.add_block(buffer.data() + c.buffer + ragged, (c.bytes() - ragged) / 4 * 4);
    }
    EXPECT_EQ(seen.torn, 0U) << read.name << ", of " << seen.longwords;
    EXPECT_GE(seen.longwords, end.longwords()) << read.name;
    EXPECT_GE(seen.changes, StressEnd::kChanges) << read.name << ": the writer did not run";
  }
  /// Writes blocks while a thread reads them. Bytes that a call leaves at the ends do not change.
  static void expect_whole_writes(const NamedCall& write, std::span<std::uint32_t> words) {
    std::vector<std::byte> buffer(kBlock + 4);
    LongwordReader reader{words.subspan(1, words.size() - 2)};
    std::uint64_t written = 0;
    const StressEnd end;
    for (std::uint64_t number = 0; !end.reached(written, reader.changes()); ++number) {
      const Case c{number};
      std::fill(buffer.begin(), buffer.end(), static_cast<std::byte>(number));
      ASSERT_EQ(write.call(buffer.data() + c.buffer, kAt + c.begin, c.bytes()), 0) << write.name;
      written += c.bytes() / 4;
    }
    const Seen seen = reader.stop();
    EXPECT_EQ(seen.torn, 0U) << write.name << ", of " << written << " written, " << seen.longwords
                             << " read";
    EXPECT_GE(written, end.longwords()) << write.name;
    EXPECT_GE(seen.changes, StressEnd::kChanges) << write.name << ": the reader did not run";
  }

  static constexpr std::array<std::pair<const char*, uint32>, 4> kGtFlags{
      {{"PIO", SCGT_RW_PIO},
       {"DMA", 0},
       {"DMA with bytes swapped", SCGT_RW_DMA_BYTE_SWAP},
       {"DMA with words swapped", SCGT_RW_DMA_WORD_SWAP}}};
  scgtHandle handle_{};
};

TEST_F(BlockCopies, ReadNoTornLongword) {
  expect_whole_reads({"scr_dma_read", scr_dma_read}, plus_words(), false);
  expect_whole_reads({"scr_mem_read", scr_mem_read}, plus_words(), false);
  for (const NamedCall& read : gt_reads()) expect_whole_reads(read, gt_words(), true);
}

TEST_F(BlockCopies, WriteNoTornLongword) {
  expect_whole_writes({"scr_dma_write", scr_dma_write}, plus_words());
  expect_whole_writes({"scr_mem_write", scr_mem_write}, plus_words());
  for (const NamedCall& write : gt_writes()) expect_whole_writes(write, gt_words());
}

TEST_F(BlockCopies, FillNoTornLongword) {
  LongwordReader reader{plus_words()};
  std::uint64_t written = 0;
  const StressEnd end;
  for (unsigned number = 1; !end.reached(written, reader.changes()); ++number) {
    scr_smem_mm(MEM, whole_longword(number));
    written += sp_mem_size() / 4;
  }
  const Seen seen = reader.stop();
  EXPECT_EQ(seen.torn, 0U) << "of " << seen.longwords;
  EXPECT_GE(written, end.longwords());
  EXPECT_GE(seen.changes, StressEnd::kChanges);
}

// A block that begins or ends inside a longword leaves the longword's other bytes unchanged.
TEST_F(BlockCopies, MoveExactlyTheBytesOfTheBlock) {
  for (std::uint64_t number = 0; number < 64; ++number) {
    const Case c{number};
    for (const unsigned bytes : {0U, 1U, 2U, 3U, 5U, 20U - c.cut}) {
      std::array<unsigned char, 40> before{};
      before.fill(0xEE);
      ASSERT_EQ(scr_dma_write(before.data(), kAt, before.size()), 0);
      std::array<unsigned char, 40> out{};
      for (unsigned i = 0; i < out.size(); ++i) out[i] = static_cast<unsigned char>(i + 1);
      ASSERT_EQ(scr_dma_write(out.data() + c.buffer, kAt + c.begin, bytes), 0);
      for (unsigned i = 0; i < before.size(); ++i) {
        const bool inside = i >= c.begin && i < c.begin + bytes;
        ASSERT_EQ(ReadSCRByte(kAt + i, nullptr), inside ? out[i - c.begin + c.buffer] : 0xEE)
            << number << ", " << bytes << " bytes, byte " << i;
      }
      std::array<unsigned char, 40> in{};
      ASSERT_EQ(scr_dma_read(in.data() + c.buffer, kAt + c.begin, bytes), 0);
      for (unsigned i = 0; i < in.size(); ++i) {
        const bool inside = i >= c.buffer && i < c.buffer + bytes;
        ASSERT_EQ(in[i], inside ? out[i] : 0) << number << ", " << bytes << " bytes, byte " << i;
      }
    }
  }
}

}  // namespace
