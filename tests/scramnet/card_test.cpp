// SPDX-License-Identifier: Apache-2.0
//
// The layer below the vendor's API: cards, registers, queues and windows. Two boards in one process
// represent two nodes of a ring.
#include <array>
#include <filesystem>
#include <memory>
#include <set>
#include <thread>
#include <vector>

#include <pthread.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include <rths/broker/detail/shared_object.hpp>
#include <rths/card/bits.hpp>
#include <rths/card/fifo.hpp>
#include <rths/card/gt_queue.hpp>

#include "board.hpp"
#include "settings.hpp"
#include "support/files.hpp"
#include "support/ring_maps.hpp"

namespace rths::scramnet {
namespace {

constexpr broker::Claim kDead = 1ULL << 40 | 999'999'999;
const broker::Members kNobody{-1};

class Cards : public testing::Test {
 protected:
  Settings settings(const std::string& node, std::uint64_t card_bytes = 0) const {
    Settings settings;
    settings.ring = name_;
    settings.node = node;
    settings.ring_bytes = 8U << 20U;
    settings.card_bytes = card_bytes;
    return settings;
  }

 private:
  std::string name_ = test::unique_ring("cards");
  test::RingRemoval removal_{name_};
};

Word& word(const Board& board, std::uint32_t longword) {
  return reinterpret_cast<Word*>(board.window())[longword];
}

TEST_F(Cards, OutliveTheirProcesses) {
  std::make_unique<Board>(settings("3"))->write_csr(0, 0x8003);
  const auto ring = broker::Ring::attach(settings("").ring);

  Board again{settings("3")};
  Board other{settings("4")};

  EXPECT_EQ(again.read_csr(0), 0x8003U);
  EXPECT_EQ(other.read_csr(0), 0U);
  EXPECT_NE(&again.plus(), &other.plus());
}

TEST_F(Cards, AreSharedByTheProcessesOfANode) {
  Board first{settings("3")};
  Board second{settings("3")};

  first.write_csr(2, 0x4040);

  EXPECT_EQ(second.read_csr(2), 0x4040U);
}

TEST_F(Cards, ShowOnePageOfALargerRing) {
  constexpr std::uint64_t kCard = 2U << 20U;
  Board whole{settings("1")};
  Board paged{settings("2", kCard)};
  ASSERT_TRUE(whole.map_window() && paged.map_window());
  const std::byte* const address = paged.window();

  paged.write_csr(12, 2U << 14U | 1U);  // page 2 of a card with 2 MB
  word(paged, 5).store(77);

  EXPECT_EQ(word(whole, 2 * kCard / 4 + 5).load(), 77U);
  EXPECT_EQ(paged.window(), address);
  EXPECT_TRUE(paged.has_page(3));
  EXPECT_FALSE(paged.has_page(4));
  paged.write_csr(12, 0);
  EXPECT_EQ(word(paged, 5).load(), 0U);
}

TEST_F(Cards, ReportInterruptsByTheAddressOnTheRing) {
  constexpr std::uint32_t kPage = (2U << 20U) / 4;
  Board sender{settings("1")};
  Board receiver{settings("2", 2U << 20U)};
  ASSERT_TRUE(sender.map_window() && receiver.map_window());
  receiver.write_csr(12, 1U << 14U | 1U);
  receiver.write_acr(9, acr::kReceiveInterrupt);
  receiver.write_csr(0, 0x812B);
  sender.write_acr(kPage + 9, acr::kTransmitInterrupt);
  sender.write_csr(0, 0x8103);

  word(sender, kPage + 9).store(1);

  EXPECT_EQ(receiver.read_csr(5), csr5::kNotEmpty | (kPage + 9) * 4 >> 16);
  EXPECT_EQ(receiver.read_csr(4), (kPage + 9) * 4 & 0xFFFF);
}

struct Rule {
  std::uint32_t sender_csr0, sender_acr, receiver_csr0, receiver_acr;
  bool arrives;
};

// Outgoing: TXEN and NIE and (OTF or TIE). Incoming: RXEN and IMME and (ORF or RIE).
TEST_F(Cards, FollowTheRulesOfInterruptBits) {
  constexpr std::uint32_t kTie = 2, kRie = 1;
  const std::array<Rule, 9> rules{{{0x8103, kTie, 0x8021, kRie, true},
                                   {0x8103, 0, 0x8021, kRie, false},
                                   {0x8303, 0, 0x8021, kRie, true},
                                   {0x8003, kTie, 0x8021, kRie, false},
                                   {0x8101, kTie, 0x8021, kRie, false},
                                   {0x8103, kTie, 0x8021, 0, false},
                                   {0x8103, kTie, 0x8061, 0, true},
                                   {0x8103, kTie, 0x8001, kRie, false},
                                   {0x8103, kTie, 0x8020, kRie, false}}};
  Board sender{settings("1", 4096)};
  Board receiver{settings("2", 4096)};
  ASSERT_TRUE(sender.map_window());
  for (const Rule& rule : rules) {
    sender.write_acr(8, rule.sender_acr);
    receiver.write_acr(8, rule.receiver_acr);
    sender.write_csr(0, rule.sender_csr0);
    receiver.write_csr(0, rule.receiver_csr0);
    word(sender, 8).fetch_add(1);
    receiver.scanner().scan();
    EXPECT_EQ(pop(receiver.plus().fifo).has_value(), rule.arrives) << (&rule - rules.data());
  }
}

// A scan sees the last value only: the bound of interrupts that pointer stores raise.
TEST_F(Cards, CountWritesBetweenTwoScansOnce) {
  Board sender{settings("1", 4096)};
  Board receiver{settings("2", 4096)};
  ASSERT_TRUE(sender.map_window());
  sender.write_acr(8, acr::kTransmitInterrupt);
  receiver.write_acr(8, acr::kReceiveInterrupt);
  sender.write_csr(0, 0x8103);
  receiver.write_csr(0, 0x8021);
  unsigned interrupts = 0;
  for (const unsigned writes : {1U, 2U, 1U}) {
    for (unsigned i = 0; i < writes; ++i) word(sender, 8).fetch_add(1);
    receiver.scanner().scan();
    while (pop(receiver.plus().fifo)) ++interrupts;
  }

  EXPECT_EQ(interrupts, 3U) << "of 4 writes";
}

bool may_have_real_time() {
  bool allowed = false;
  std::thread{[&] {
    const sched_param lowest{1};
    allowed = pthread_setschedparam(pthread_self(), SCHED_FIFO, &lowest) == 0;
  }}.join();
  return allowed;
}

bool has_real_time_thread() {
  for (const auto& task : std::filesystem::directory_iterator{"/proc/self/task"})
    if (sched_getscheduler(std::stoi(task.path().filename())) == SCHED_FIFO) return true;
  return false;
}

TEST_F(Cards, ScanInRealTimeIfTheProcessMay) {
  if (!may_have_real_time()) GTEST_SKIP() << "this process may have no real-time scheduling";
  Board board{settings("1")};

  board.scanner().run_thread(true);

  bool found = false;
  for (int i = 0; i < 5000 && !found; ++i) {
    usleep(1000);
    found = has_real_time_thread();
  }
  EXPECT_TRUE(found);
}

TEST(InterruptFifo, KeepsOrderAndItsOldestEntries) {
  auto fifo = std::make_unique<InterruptFifo>();
  for (std::uint32_t i = 0; i < kFifoEntries; ++i) EXPECT_TRUE(push(*fifo, i * 4));
  EXPECT_FALSE(push(*fifo, 77));
  for (std::uint32_t i = 0; i + 1 < kFifoEntries; ++i) EXPECT_EQ(pop(*fifo), i * 4);
  EXPECT_EQ(pop(*fifo), 77U);
  EXPECT_EQ(pop(*fifo), std::nullopt);
}

TEST(GtQueue, SkipsAWriterThatDied) {
  const auto card = std::make_unique<GtCard>();
  const broker::Claim self = broker::own_claim();
  ASSERT_TRUE(push(*card, {1, 2, 3, 4}, self, kNobody));
  card->queue[1].writer.store(kDead);  // died after it reserved the entry
  ASSERT_TRUE(push(*card, {1, 2, 3, 5}, self, kNobody));
  card->queue[2].writer.store(kDead);  // died after it wrote the entry, before it moved the tail
  card->queue[2].stamp.store(3);
  ASSERT_TRUE(push(*card, {1, 2, 3, 6}, self, kNobody));

  QueuedInterrupt found;
  EXPECT_EQ(card->tail.load(), 4U);
  EXPECT_TRUE(read(*card, 3, found));
  EXPECT_EQ(found.value, 6U);
}

TEST(GtQueue, LosesNothingWithSeveralWriters) {
  constexpr std::uint32_t kThreads = 4, kEach = 250;
  const auto card = std::make_unique<GtCard>();
  const broker::Claim self = broker::own_claim();
  const auto object = broker::SharedObject::create(4096);
  const auto membership = object.enter();
  const broker::Members members = object.members();
  std::vector<std::thread> threads;
  for (std::uint32_t t = 0; t < kThreads; ++t)
    threads.emplace_back([&, t] {
      for (std::uint32_t i = 0; i < kEach; ++i)
        while (!push(*card, {1, t, 0, i}, self, members)) std::this_thread::yield();
    });
  for (auto& thread : threads) thread.join();

  std::array<std::uint32_t, kThreads> next{};
  for (std::uint64_t position = 0; position < kThreads * kEach; ++position) {
    QueuedInterrupt found;
    ASSERT_TRUE(read(*card, position, found));
    EXPECT_EQ(found.value, next[found.source]++) << "in each writer's order";
  }
}

TEST(CardSettings, ComeFromTheEnvironmentThenFromAFile) {
  const test::TemporaryFolder folder;
  const auto file =
      folder.write("card.toml",
                   "[scramnet]\nring = \"lab\"\nnode = \"opf\"\nbypass_switch = false\n"
                   "[scgt]\nring_bytes = 1048576\n");
  setenv("RTHS_SCRAMNET_CONFIG", file.c_str(), 1);
  setenv("RTHS_SCRAMNET_NODE", "xpc", 1);
  unsetenv("RTHS_SCRAMNET_RING");

  EXPECT_EQ(plus_settings().ring, "lab");
  EXPECT_EQ(plus_settings().node, "xpc");
  EXPECT_FALSE(plus_settings().bypass_switch);
  EXPECT_EQ(gt_settings(0).ring, "scgt");
  EXPECT_EQ(gt_settings(2).ring, "scgt2");
  EXPECT_EQ(gt_settings(2).ring_bytes, 1U << 20U);

  unsetenv("RTHS_SCRAMNET_CONFIG");
  unsetenv("RTHS_SCRAMNET_NODE");
}

TEST(CardSettings, ReportErrorsWithTheirPosition) {
  const test::TemporaryFolder folder;
  const auto error_of = [&](const std::string& text) {
    const auto file = folder.write("card.toml", text);
    setenv("RTHS_SCRAMNET_CONFIG", file.c_str(), 1);
    const std::string error = test::error_of([] { static_cast<void>(plus_settings()); });
    unsetenv("RTHS_SCRAMNET_CONFIG");
    return error;
  };
  EXPECT_NE(error_of("[scramnet]\nringg = \"a\"\n").find("card.toml:2:"), std::string::npos);
  EXPECT_NE(error_of("[scramnett]\n").find("card.toml:1:"), std::string::npos);
  EXPECT_NE(error_of("[scramnet]\nring_bytes = 5000\n").find("whole pages"), std::string::npos);
  setenv("RTHS_SCRAMNET_BYTES", "two", 1);
  EXPECT_NE(error_of("").find("RTHS_SCRAMNET_BYTES is 'two'"), std::string::npos);
  unsetenv("RTHS_SCRAMNET_BYTES");
  setenv("RTHS_SCRAMNET_SHARE", "yes", 1);
  EXPECT_EQ(error_of(""), "RTHS_SCRAMNET_SHARE is 'yes', expected 0 or 1");
  unsetenv("RTHS_SCRAMNET_SHARE");
}

}  // namespace
}  // namespace rths::scramnet
