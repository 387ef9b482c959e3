// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <random>
#include <string>

#include <gtest/gtest.h>

#include <rths/broker/detail/shared_object.hpp>
#include <rths/card/bits.hpp>
#include <rths/card/gt_queue.hpp>
#include <rths/card/gt_registers.hpp>

#include "broker/dds/src/cards.hpp"
#include "support/files.hpp"
#include "support/ring_maps.hpp"

namespace rths::dds {
namespace {

constexpr std::uint32_t kTie = scramnet::acr::kTransmitInterrupt;

/// Two hosts with the same map. The node's card is on the first one; the second has the copy.
class CardsTest : public ::testing::Test {
 protected:
  struct Side {
    explicit Side(const std::string& name)
        : removal{test::unique_ring(name)},
          ring{broker::Ring::create(removal.name, test::small_map(8))},
          table{ring, removal.name},
          cards{ring, removal.name} {}
    /// The card of a node, which this process takes.
    scramnet::CardTable::CardView card(NodeId node) {
      const auto index = table.take(scramnet::kNamed | node.value(), broker::own_claim());
      return *table.at(index.value());
    }
    test::RingRemoval removal;
    broker::Ring ring;
    scramnet::CardTable table;
    Cards cards;
  };
  [[nodiscard]] NodeId node(std::size_t index) const {
    return first_.ring.map().description().nodes.at(index).id;
  }
  Side first_{"cards_first"}, second_{"cards_second"};
};

TEST_F(CardsTest, CopyTheInterruptingWords) {
  const auto card = first_.card(node(0));
  const auto longwords = static_cast<std::uint32_t>(first_.table.memory_bytes() / 4);
  std::mt19937 random{7};
  for (int round = 0; round < 3; ++round) {
    for (std::uint32_t word = 0; word < longwords; ++word)
      card.acr[word].store(random() % 4 == 0 ? kTie : 0);
    card.card->plus.acr_changes.fetch_add(1);
    card.card->plus.csr[0].store(random() & 0xFFFF);
    for (const auto& message : first_.cards.changes_of(node(0)))
      ASSERT_TRUE(second_.cards.apply(node(0), message));
    const auto copy = second_.card(node(0));
    for (std::uint32_t word = 0; word < longwords; ++word)
      ASSERT_EQ(copy.acr[word].load(), card.acr[word].load()) << word;
    EXPECT_EQ(copy.card->plus.csr[0].load(), card.card->plus.csr[0].load());
  }
  EXPECT_TRUE(first_.cards.changes_of(node(0)).empty()) << "nothing has changed";
}

/// A child process with a card of a ring, until it is killed.
class CardHolder {
 public:
  explicit CardHolder(const std::function<void()>& take) {
    std::array<int, 2> ready{};
    if (pipe(ready.data()) != 0) std::abort();
    pid_ = fork();
    if (pid_ == 0) {
      take();
      static_cast<void>(!write(ready[1], "r", 1));
      pause();
      _exit(0);
    }
    close(ready[1]);
    char byte = 0;
    static_cast<void>(!::read(ready[0], &byte, 1));
    close(ready[0]);
  }
  ~CardHolder() { die(); }
  CardHolder(const CardHolder&) = delete;
  CardHolder& operator=(const CardHolder&) = delete;
  void die() {
    if (pid_ > 0) kill(pid_, SIGKILL), waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  [[nodiscard]] int pid() const { return pid_; }

 private:
  pid_t pid_ = -1;
};

// A program may have taken the card by the number of the other host's node.
TEST_F(CardsTest, LeaveTheCardOfALivingProcessOfThisHost) {
  first_.card(node(0)).card->plus.csr[0].store(0x8003);
  const auto messages = first_.cards.state_of(node(0));
  CardHolder holder{[&] {
    static const broker::Node member = second_.ring.observe();  // until the child ends
    second_.card(node(0)).card->plus.csr[0].store(0x1234);
  }};

  for (const auto& message : messages)
    EXPECT_EQ(test::error_of([&] { static_cast<void>(second_.cards.apply(node(0), message)); }),
              "process " + std::to_string(holder.pid()) + " has the card");
  EXPECT_EQ(second_.card(node(0)).card->plus.csr[0].load(), 0x1234U);

  holder.die();
  for (const auto& message : messages) EXPECT_TRUE(second_.cards.apply(node(0), message));
  EXPECT_EQ(second_.card(node(0)).card->plus.csr[0].load(), 0x8003U);
}

// Otherwise SIGBUS ends the process.
TEST_F(CardsTest, ReactToLostMemoryAsTheirRingDoes) {
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    broker::on_lost_memory(broker::OnLostMemory::Continue);
    Side lost{"cards_lost"};
    const auto card = lost.card(node(0));
    auto* const window = lost.table.map_memory(nullptr, 0, lost.table.memory_bytes());
    std::filesystem::resize_file("/dev/shm/" + broker::object_name(lost.removal.name), 0);
    const bool are_zero = card.card->key.load() == 0 && card.acr[0].load() == 0 &&
                          reinterpret_cast<scramnet::Word*>(window)->load() == 0 &&
                          lost.table.in_use() == 0;
    scramnet::CardTable::unmap(window, lost.table.memory_bytes());
    broker::remove_ring(lost.removal.name);
    _exit(are_zero ? 0 : 1);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST_F(CardsTest, RefuseMalformedMessages) {
  const auto longwords = static_cast<std::uint32_t>(first_.table.memory_bytes() / 4);
  const std::vector<CardMessage> malformed{
      {},
      {0},
      {4, 1, 2},
      {1, 2, 3},                            // too few registers
      {2, 0},                               // no range
      {2, 0, longwords + 1},                // behind the memory
      {2, 5, 4},                            // a negative range
      {2, 0, longwords, longwords, 1},      // a run behind it
      {2, 0, longwords, 0, longwords + 1},  // too long a run
      {2, 0, longwords, 8, 1, 7, 1},        // runs out of order
      {2, 0, longwords, 8},                 // half a run
      {3, 1, 1},
      {3, 0x10000, 1, 0, 0, 0},
  };
  for (const auto& message : malformed) EXPECT_FALSE(second_.cards.apply(node(0), message));
}

TEST_F(CardsTest, SendInterruptsOfAQueueOnceAndCountOverwrittenOnes) {
  const auto sender = first_.card(node(0));
  sender.card->gt.cr[scramnet::gt::kLinkControl].fetch_or(7U << scramnet::gt::kNodeIdShift);
  const auto receiver = second_.card(node(1));
  receiver.card->gt.cr[scramnet::gt::kBroadcastMask].store(1U << 5U);
  for (const auto& message : second_.cards.state_of(node(1)))
    ASSERT_TRUE(first_.cards.apply(node(1), message));
  auto& copy = first_.card(node(1)).card->gt;

  const auto self = broker::own_claim();
  for (std::uint32_t i = 0; i < 1200; ++i)
    ASSERT_TRUE(push(copy, {1, 7, i % 2 == 0 ? 5U : 6U, i}, self, broker::Members{-1}));
  std::vector<Cards::Interrupt> taken;
  EXPECT_EQ(first_.cards.take_interrupts(TimePoint{1}, taken), 1200U - 1023U);
  ASSERT_EQ(taken.size(), 1023U);
  for (const auto& interrupt : taken) {
    EXPECT_EQ(interrupt.from, node(0));
    EXPECT_EQ(interrupt.to, node(1));
    ASSERT_TRUE(second_.cards.apply(node(0), interrupt.message));
  }
  taken.clear();
  EXPECT_EQ(first_.cards.take_interrupts(TimePoint{2}, taken), 0U);
  EXPECT_TRUE(taken.empty());
  // The receiver's mask has number 5 only.
  EXPECT_EQ(receiver.card->gt.tail.load(), 511U);
  scramnet::QueuedInterrupt last;
  ASSERT_TRUE(read(receiver.card->gt, 510, last));
  EXPECT_EQ(last.value, 1198U);
}

TEST_F(CardsTest, ResetACopyWhenItsNodeLeaves) {
  const auto receiver = second_.card(node(1));
  receiver.acr[5].store(kTie);
  for (const auto& message : second_.cards.state_of(node(1)))
    ASSERT_TRUE(first_.cards.apply(node(1), message));
  const auto copy = first_.card(node(1));
  EXPECT_EQ(copy.acr[5].load(), kTie);
  ASSERT_TRUE(push(copy.card->gt, {1, 7, 5, 1}, broker::own_claim(), broker::Members{-1}));
  first_.cards.release(node(1));
  EXPECT_EQ(copy.acr[5].load(), 0U);
  EXPECT_EQ(copy.card->gt.cr[scramnet::gt::kBroadcastMask].load(), 0U);
  EXPECT_EQ(copy.card->gt.cr[scramnet::gt::kUnicastMask].load(), 0U);
  std::vector<Cards::Interrupt> taken;
  EXPECT_EQ(first_.cards.take_interrupts(TimePoint{1}, taken), 1U) << "is lost";
  EXPECT_TRUE(taken.empty());
}

// Other processes may overwrite a queue or the bits of the cards in use.
TEST_F(CardsTest, SurviveDamagedSharedMemory) {
  static_cast<void>(second_.card(node(1)));
  for (const auto& message : second_.cards.state_of(node(1)))
    ASSERT_TRUE(first_.cards.apply(node(1), message));
  auto& queue = first_.card(node(1)).card->gt;
  std::vector<Cards::Interrupt> taken;
  for (const std::uint64_t tail : {std::uint64_t{1} << 62U, std::uint64_t{3}, ~std::uint64_t{0}}) {
    queue.tail.store(tail);
    static_cast<void>(first_.cards.take_interrupts(TimePoint{1}, taken));
  }
  EXPECT_TRUE(taken.empty());
  const auto object = broker::SharedObject::open(first_.removal.name);
  const auto mapping = object.map(0, object.size());
  auto* const header = reinterpret_cast<broker::Header*>(mapping.address());
  std::atomic_ref{header->cards_in_use}.store(~std::uint64_t{0});
  EXPECT_TRUE(first_.cards.state_of(NodeId{9}).empty());
}

}  // namespace
}  // namespace rths::dds
