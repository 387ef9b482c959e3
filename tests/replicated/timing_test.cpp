// SPDX-License-Identifier: Apache-2.0
//
// Rates and delays of the manuals (SC150e Hardware Reference §2.4, §5.5; GT200 Hardware Reference
// App. A) against those that follow from bits, fibre and insertion.
#include <algorithm>

#include "virtual_cards.hpp"

namespace rths::test {
namespace {

constexpr double kTolerance = 0.03;  // of the manuals' figures, which are rounded

class Timing : public VirtualCards {
 protected:
  struct Rate {
    double total = 0, least = 1e9, most = 0;  // [MB/s]
  };

  // Senders write without a pause. The rate counts longwords that left the FIFOs.
  Rate saturate(std::uint32_t senders, std::uint32_t stride = 1, Time length = 4ms) {
    const std::uint32_t step = ring().nodes() / senders;
    std::vector<std::uint32_t> written(senders), before(senders);
    const auto left_fifo = [&](std::uint32_t i) {
      return written[i] - card(i * step).report().transmit_fifo;
    };
    const auto keep_full = [&](Time until) {
      while (ring().now() < until) {
        for (std::uint32_t i = 0; i < senders; ++i)
          while (store(i * step, written[i] * stride % 0x8000, written[i]) == Access::Queued)
            ++written[i];
        pass(10us);
      }
    };
    keep_full(1ms);
    for (std::uint32_t i = 0; i < senders; ++i) before[i] = left_fifo(i);
    keep_full(1ms + length);
    Rate rate;
    for (std::uint32_t i = 0; i < senders; ++i) {
      const double own = 4.0 * (left_fifo(i) - before[i]) / (to_ns(length) * 1e-3);
      rate.total += own;
      rate.least = std::min(rate.least, own);
      rate.most = std::max(rate.most, own);
    }
    return rate;
  }

  // Longest delay of a message of node 0 at node 1, over all phases of an own transmission there.
  double longest_delay(std::uint32_t csr2, std::uint32_t longwords, double own_ns) {
    double longest = 0;
    for (double phase = 0; phase < own_ns + 500; phase += own_ns / 97) {
      use_inserted(3, csr2);
      ring().run_until(100us);
      store(0, 8000, 1);
      ring().run_until(100us + replicated::from_ns(phase));
      for (std::uint32_t i = 0; i < longwords; ++i) store(1, i, i);
      settle();
      longest = std::max(longest, to_ns(card(1).report().longest_delay));
    }
    for (double phase = 0; phase < own_ns + 500; phase += own_ns / 97) {
      use_inserted(3, csr2);
      ring().run_until(100us);
      for (std::uint32_t i = 0; i < longwords; ++i) store(1, i, i);
      ring().run_until(100us + replicated::from_ns(phase));
      store(0, 8000, 1);
      settle();
      longest = std::max(longest, to_ns(card(1).report().longest_delay));
    }
    return longest;
  }
};

TEST_F(Timing, BurstSharesSixAndAHalfMegabytesPerSecondAmongItsSenders) {
  for (const std::uint32_t senders : {1U, 2U, 4U, 8U}) {
    use_inserted(8);
    const Rate rate = saturate(senders);
    EXPECT_NEAR(rate.total, 6.5, 6.5 * kTolerance) << senders;
    EXPECT_NEAR(rate.least, 6.5 / senders, 6.5 / senders * kTolerance) << senders;
    EXPECT_NEAR(rate.most, 6.5 / senders, 6.5 / senders * kTolerance) << senders;
  }
}

TEST_F(Timing, BlocksRaiseTheRateToThatOfTheirLength) {
  use_inserted(4, kBurst256);
  EXPECT_NEAR(saturate(1).total, 16.2, 16.2 * kTolerance);
  use_inserted(4, kBurst1024);
  EXPECT_NEAR(saturate(1).total, 16.7, 16.7 * kTolerance);
}

TEST_F(Timing, BlocksEndWhereAddressesDoNotFollow) {
  use_inserted(4, kBurst256);
  EXPECT_NEAR(saturate(1, 2).total, 6.5, 6.5 * kTolerance);
}

TEST_F(Timing, AnEmptyNodeDelaysAMessageBy247Ns) {
  use_inserted(3);
  store(0, 1, 2);
  settle();
  EXPECT_NEAR(to_ns(card(1).report().longest_delay), 247, 0.5);
}

TEST_F(Timing, AnOwnMessageDelaysOthersByItsLength) {
  const double basic = longest_delay(kBurst, 1, kMessageNs);
  EXPECT_LE(basic, 800);
  EXPECT_GE(basic, 800 * (1 - kTolerance));
  const double block256 = longest_delay(kBurst256, 64, 15'667);
  EXPECT_LE(block256, 16'200);
  EXPECT_GE(block256, 16'200 * (1 - kTolerance));
  const double block1024 = longest_delay(kBurst1024, 256, 61'747);
  EXPECT_LE(block1024, 62'000);
  EXPECT_GE(block1024, 62'000 * (1 - kTolerance));
}

// On a saturated ring a message may also wait for the gap that the inserted message needs.
TEST_F(Timing, NoMessageWaitsLongerThanOneOwnMessageAndItsGap) {
  use_inserted(8);
  static_cast<void>(saturate(8));
  for (std::uint32_t node = 0; node < 8; ++node)
    EXPECT_LE(to_ns(card(node).report().longest_delay), kNodeNs + 92 * kBitNs + kTickNs);
}

TEST_F(Timing, ALateSenderIsNotKeptFromSending) {
  use_inserted(2);
  std::uint32_t written = 0;
  const auto fill = [&](Time until) {
    while (ring().now() < until) {
      while (store(0, written % 64, written) == Access::Queued) ++written;
      pass(10us);
    }
  };
  fill(1ms);
  store(1, 100, 7);
  fill(1ms + 20us);
  EXPECT_EQ(card(1).report().sent, 1U);
  EXPECT_EQ(load(0, 100), 7U);
}

TEST_F(Timing, TheFarthestOf256NodesSeesAStoreAfterTheSumOfDelays) {
  use_inserted(256);
  store(0, 5, 9);
  settle();
  for (const std::uint32_t node : {1U, 2U, 128U, 255U}) {
    const auto stored = hops(Hop::Kind::Stored, node);
    ASSERT_EQ(stored.size(), 1U);
    EXPECT_NEAR(to_ns(stored[0].begin), kMessageNs + (node - 1) * kNodeNs + node * 10 * kMetreNs,
                kTickNs);
  }
}

TEST_F(Timing, Csr13MeasuresTheLoopTimeOf256Nodes) {
  use_inserted(256);
  csr(0, 9, 0x4000);
  csr(0, 13, 0);
  store(0, 5, 9);
  settle();
  const double loop = kMessageNs + 255 * kNodeNs + 256 * 10 * kMetreNs;
  EXPECT_NEAR(csr(0, 13) * 4 * kBitNs, loop, 4 * kBitNs);
}

TEST_F(Timing, PlatinumSendsOneMessagePerLoop) {
  use_inserted(4, kPlatinum);
  csr(0, 5, 0x100);
  const double loop = kMessageNs + 3 * kNodeNs + 4 * 10 * kMetreNs;
  EXPECT_NEAR(saturate(1).total, 4e3 / loop, 4e3 / loop * 0.002);
}

TEST_F(Timing, ASlowNodeAddsItsDelay) {
  RingSetup setup = nodes(3);
  setup.nodes[1].extra_delay = 3us;
  use_inserted(setup);
  store(0, 5, 9);
  settle();
  EXPECT_NEAR(to_ns(hops(Hop::Kind::Stored, 2)[0].begin),
              kMessageNs + kNodeNs + 3000 + 2 * 10 * kMetreNs, kTickNs);
}

TEST_F(Timing, ASlowNodeSendsItsOwnMessageBeforeItHasRecognisedAnother) {
  RingSetup setup = nodes(3);
  setup.nodes[1].extra_delay = 3us;
  use_inserted(setup);
  store(0, 5, 9);
  pass(1us);
  store(1, 6, 9);
  settle();
  EXPECT_EQ(hops(Hop::Kind::Inserted, 1)[0].begin, Time{1us});
}

TEST_F(Timing, AWordThatComesWithin240NsJoinsAnOpenBlock) {
  for (const auto& [pause, messages] : {std::pair{230, 1U}, std::pair{700, 4U}}) {
    use_inserted(2, kBurst256);
    for (std::uint32_t i = 0; i < 4; ++i) {
      store(0, i, i);
      pass(std::chrono::nanoseconds{pause});
    }
    settle();
    EXPECT_EQ(card(0).report().sent, messages) << pause;
    for (std::uint32_t i = 0; i < 4; ++i) EXPECT_EQ(load(1, i), i);
  }
}

class GtTiming : public Timing {
 protected:
  void use_gt(std::uint32_t count) { use(nodes(count, CardType::Gt)); }
};

TEST_F(GtTiming, FramesOf4And128BytesHaveTheManualsRates) {
  use_gt(2);
  EXPECT_NEAR(saturate(1, 2).total, 33, 33 * kTolerance);
  use_gt(2);
  EXPECT_NEAR(saturate(1).total, 210, 210 * kTolerance);
}

TEST_F(GtTiming, ANodeAddsItsPassageAndTheSenderItsInsertion) {
  use_gt(3);
  store(0, 5, 9);
  settle();
  const double frame = 26 * 4;  // [ns] 4 bytes in 22 of delimiters, header and CRC, at 4 ns each
  EXPECT_NEAR(to_ns(hops(Hop::Kind::Inserted, 0)[0].begin), 350, 350 * kTolerance);
  EXPECT_NEAR(to_ns(card(1).report().longest_delay), 450, 450 * kTolerance);
  EXPECT_NEAR(to_ns(hops(Hop::Kind::Stored, 2)[0].begin), 350 + 450 + frame + 2 * 50, 1);
}

}  // namespace
}  // namespace rths::test
