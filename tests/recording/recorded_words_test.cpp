// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/recorded_words.hpp>

#include <bit>
#include <functional>
#include <limits>

#include <gtest/gtest.h>

#include <rths/core/config.hpp>

#include "sample_recording.hpp"
#include "support/files.hpp"

namespace rths::recording {
namespace {

using rths::test::error_of;

constexpr int kWordRows = 10;

/// Rows at every millisecond whose displacement is that of `row` and a half.
class WordsOfARecording : public testing::Test {
 protected:
  [[nodiscard]] Reader recorded(
      const std::function<void(int, std::vector<double>&)>& change = {}) const {
    const auto file = folder_.path() / "run.h5";
    std::filesystem::remove(file);
    Writer writer = open_writer(file);
    for (int i = 0; i < kWordRows; ++i) {
      auto values = row(i);
      values[0] += 0.0005;
      if (change) change(i, values);
      writer.append(time_of(i), values);
    }
    writer.close();
    return Reader{file};
  }
  [[nodiscard]] static double millimetres(std::uint32_t word) { return std::bit_cast<float>(word); }
  [[nodiscard]] static MessageFault fault(const Reader& run, const std::string& toml) {
    return read_message_fault(Config::parse(toml, "fault"), run.map());
  }

  const test::TemporaryFolder folder_;
};

TEST_F(WordsOfARecording, AreThoseOnTheRing) {
  const Reader run = recorded();
  const auto words = words_of(run, "machine");

  ASSERT_EQ(words.size(), 4U);
  EXPECT_EQ(words[0].entry.name, "fbk.long.displ");
  for (int i = 0; i < kWordRows; ++i)
    EXPECT_EQ(millimetres(words[0].words[static_cast<std::size_t>(i)]),
              static_cast<float>(1000 * i + 0.5));
}

TEST_F(WordsOfARecording, HaveFlagsAndCountersLast) {
  const Reader run = recorded([](int i, std::vector<double>& values) { values[1] = i % 2; });
  const auto words = words_of(run, "machine");

  EXPECT_EQ(words[0].entry.name, "fbk.long.displ");
  EXPECT_EQ(words[1].entry.name, "fbk.lat.displ");
  EXPECT_EQ(words[3].entry.name, "monitor.machine.host.status");
}

TEST_F(WordsOfARecording, KeepTheLastOneInARowWithoutANumber) {
  const Reader run = recorded([](int i, std::vector<double>& values) {
    if (i == 0 || i == 4) values[0] = std::numeric_limits<double>::quiet_NaN();
  });
  const auto word = words_of(run, "machine")[0].words;

  EXPECT_EQ(millimetres(word[0]), 0);
  EXPECT_EQ(word[4], word[3]);
  EXPECT_NE(word[5], word[4]);
}

TEST_F(WordsOfARecording, LackDroppedWritesAlone) {
  const Reader run = recorded();
  const auto sent = words_of(run, "machine");
  auto words = sent;
  apply(fault(run, "kind = 'drop'\nsignal = 'fbk.long.displ'\nat_s = 0.004\nfor_s = 0.0015"),
        run.time(), words);

  EXPECT_EQ(words[0].words[4], sent[0].words[3]);
  EXPECT_EQ(words[0].words[5], sent[0].words[3]);
  EXPECT_EQ(words[0].words[6], sent[0].words[6]);
  EXPECT_EQ(words[1].words, sent[1].words);
}

TEST_F(WordsOfARecording, HaveABitInverted) {
  const Reader run = recorded();
  const auto sent = words_of(run, "machine");
  auto words = sent;
  apply(
      fault(run, "kind = 'flip'\nsignal = 'fbk.long.displ'\nbit = 31\nat_s = 0.004\nfor_s = 0.001"),
      run.time(), words);

  EXPECT_EQ(millimetres(words[0].words[4]), -millimetres(sent[0].words[4]));
  EXPECT_EQ(words[0].words[3], sent[0].words[3]);
  EXPECT_EQ(words[0].words[5], sent[0].words[5]);
}

TEST_F(WordsOfARecording, ArriveLaterInTheirOrder) {
  const Reader run = recorded();
  const auto sent = words_of(run, "machine");
  auto words = sent;
  apply(fault(run, "kind = 'delay'\nnode = 'machine'\ndelay_s = 0.0025\nat_s = 0.003"), run.time(),
        words);

  EXPECT_EQ(words[0].words[2], sent[0].words[2]);
  EXPECT_EQ(words[0].words[3], sent[0].words[2]);
  EXPECT_EQ(words[0].words[5], sent[0].words[2]);
  EXPECT_EQ(words[0].words[6], sent[0].words[3]);
  EXPECT_EQ(words[0].words[9], sent[0].words[6]);
}

TEST_F(WordsOfARecording, BelongToANodeOfTheMap) {
  const Reader run = recorded();

  EXPECT_EQ(error_of([&] { static_cast<void>(words_of(run, "solver")); }),
            "map 'sample' has no node 'solver', expected one of machine");
}

}  // namespace
}  // namespace rths::recording
