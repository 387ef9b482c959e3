// SPDX-License-Identifier: Apache-2.0
//
// The bytes of a frame: what is written is read, and nothing else is.
#include <random>

#include <gtest/gtest.h>

#include "broker/dds/src/frame.hpp"
#include "broker/dds/src/hello.hpp"
#include "support/long_run.hpp"

namespace rths::dds {
namespace {

using Words = std::vector<std::uint32_t>;

FrameHeader header() {
  FrameHeader header;
  header.kind = FrameKind::Updates;
  header.host = 0x1234567890abcdef;
  header.map_hash = 77;
  header.node = 3;
  header.first = 1'000'000'000'000;
  header.sent = 5;
  return header;
}

std::vector<std::byte> example() {
  FrameWriter writer{header()};
  writer.add_word(LongwordOffset{7}, 42);
  writer.add_group(LongwordOffset{33'554'431}, Words{1, 2, 3});
  writer.add_word(LongwordOffset{0}, 0xffffffff);
  return writer.finish();
}

TEST(Frame, IsReadAsItWasWritten) {
  FrameDefect defect{};
  const auto bytes = example();
  const auto frame = decode(bytes, defect);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->header.host, header().host);
  EXPECT_EQ(frame->header.first, header().first);
  EXPECT_EQ(frame->header.sent, 5);
  EXPECT_EQ(frame->header.node, 3);
  EXPECT_EQ(frame->header.count, 3);

  UpdateReader reader{frame->payload};
  Update update;
  ASSERT_TRUE(reader.next(update));
  EXPECT_EQ(update.offset, LongwordOffset{7});
  EXPECT_EQ(update.value, 42U);
  ASSERT_TRUE(reader.next(update));
  EXPECT_EQ(update.offset, LongwordOffset{33'554'431});
  EXPECT_EQ(update.words, (Words{1, 2, 3}));
  ASSERT_TRUE(reader.next(update));
  EXPECT_EQ(update.value, 0xffffffffU);
  EXPECT_FALSE(reader.next(update));
  EXPECT_FALSE(reader.malformed());
}

TEST(Frame, IsRefusedWithEachByteChanged) {
  const auto bytes = example();
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    auto changed = bytes;
    changed[i] ^= std::byte{0x10};
    FrameDefect defect{};
    EXPECT_FALSE(decode(changed, defect)) << i;
  }
}

TEST(Frame, IsRefusedWithEachLengthButItsOwn) {
  const auto bytes = example();
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    FrameDefect defect{};
    EXPECT_FALSE(decode(std::span{bytes}.first(size), defect)) << size;
  }
  auto longer = bytes;
  longer.push_back(std::byte{0});
  FrameDefect defect{};
  EXPECT_FALSE(decode(longer, defect));
  EXPECT_EQ(defect, FrameDefect::Length);
}

TEST(Frame, TellsMalformedUpdatesFromTheEnd) {
  const auto reads = [](const Words& words, std::size_t bytes) {
    UpdateReader reader{std::as_bytes(std::span{words}).first(bytes)};
    for (Update update; reader.next(update);) {
    }
    return !reader.malformed();
  };
  EXPECT_TRUE(reads({1, 2}, 8));
  EXPECT_FALSE(reads({1, 2}, 7));
  EXPECT_FALSE(reads({1, 2}, 4));
  EXPECT_FALSE(reads({0x80000001, 0, 5}, 12)) << "a group of no words";
  EXPECT_FALSE(reads({0x80000001, 2, 5}, 12)) << "a group longer than the frame";
  EXPECT_FALSE(reads({0x80000001, 0xffffffff, 5}, 12));
}

// Payloads behind a correct checksum, as a hostile participant makes them.
TEST(Frame, SurvivesRandomPayloads) {
  const long cases = test::is_long() ? 10'000'000 : 100'000;
  std::mt19937_64 random{20261123};
  std::vector<std::uint64_t> noise(64);
  std::uint64_t read = 0;
  for (long i = 0; i < cases; ++i) {
    for (auto& word : noise) word = random() >> (random() % 64);
    const auto payload = std::as_bytes(std::span{noise}).first(random() % (8 * noise.size()));
    UpdateReader reader{payload};
    std::size_t bytes = 0;
    for (Update update; reader.next(update); ++read)
      bytes += FrameWriter::size_of(update.words.size());
    ASSERT_LE(bytes, payload.size());
    if (const auto hello = hello_from(payload)) {
      ASSERT_LE(hello->host.size(), payload.size());
      ASSERT_LE((hello->nodes.size() + hello->echoes.size()) * 24, payload.size());
    }
  }
  EXPECT_GT(read, static_cast<std::uint64_t>(cases) / 2);
}

TEST(Frame, TakesNoMoreMemoryThanItsBytes) {
  FrameWriter writer{FrameHeader{}};
  writer.add_word(LongwordOffset{1}, 2);
  const auto bytes = writer.finish();
  EXPECT_EQ(bytes.capacity(), bytes.size());
}

TEST(Frame, AnnouncesNodesWithPrintableNames) {
  Hello sent;
  sent.host = "lab\n2";
  sent.real_time = Duration{4};
  sent.nodes = {{5, 6, 7}, {8, 9, 10}};
  sent.received = {{14, 15, 16}};
  sent.echoes = {{11, TimePoint{12}, TimePoint{13}}};
  sent.missed = {{"a", Duration{17}}, {"b\t", Duration{18}}};
  sent.is_last = true;
  const auto hello = hello_from(to_bytes(sent));
  ASSERT_TRUE(hello);
  EXPECT_EQ(hello->host, "lab?2");
  ASSERT_EQ(hello->received.size(), 1U);
  EXPECT_EQ(hello->received[0].host, 14U);
  EXPECT_EQ(hello->received[0].node, 15U);
  EXPECT_EQ(hello->received[0].expected, 16U);
  ASSERT_EQ(hello->nodes.size(), 2U);
  EXPECT_EQ(hello->nodes[1].beats, 10U);
  EXPECT_EQ(hello->real_time, Duration{4});
  ASSERT_EQ(hello->echoes.size(), 1U);
  EXPECT_EQ(hello->echoes[0].received, TimePoint{13});
  ASSERT_EQ(hello->missed.size(), 2U);
  EXPECT_EQ(hello->missed[1].host, "b?");
  EXPECT_EQ(hello->missed[1].silence, Duration{18});
  EXPECT_TRUE(hello->is_last);
}

}  // namespace
}  // namespace rths::dds
