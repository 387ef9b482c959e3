// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include <rths/replicated/scenario.hpp>

#include "support/files.hpp"
#include "virtual_cards.hpp"

namespace rths::test {
namespace {

using replicated::Course;
using replicated::load_scenario;

const std::string kThreeNodes = R"(
format = 1
duration_us = 100
[[node]]
name = "a"
[[node]]
name = "b"
[[node]]
name = "c"
)";

class Scenarios : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& text) {
    return folder_.write("scenario.toml", text);
  }
  Course course(const std::string& more) { return Course{load_scenario(file(kThreeNodes + more))}; }
  std::string mistake(const std::string& text) {
    return error_of([&] { static_cast<void>(load_scenario(file(text))); });
  }
  static std::uint32_t word(Course& course, std::uint32_t node, std::uint32_t longword) {
    return course.ring().card(node).read(ByteOffset{4 * longword});
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Scenarios, WriteWordsAtTheirTime) {
  Course run = course("[[write]]\nat_us = 10\nnode = \"a\"\nlongword = 5\nvalue = 0xFFFFFFFF\n");
  run.run_until(9us);
  EXPECT_EQ(word(run, 0, 5), 0U);
  run.run_until(20us);
  EXPECT_EQ(word(run, 2, 5), 0xFFFF'FFFFU);
}

TEST_F(Scenarios, HaveTrafficOfTheirPeriodAndRange) {
  Course run = course(
      "[[traffic]]\nnode = \"b\"\nperiod_ns = 1000\nlongword = 7\nlongwords = 3\nfrom_us = 10\n"
      "until_us = 20\n");
  run.run_until(100us);
  EXPECT_EQ(run.ring().card(1).report().sent, 10U);
  EXPECT_EQ(word(run, 0, 7), 10U);
  EXPECT_EQ(word(run, 0, 8), 8U);
  EXPECT_EQ(word(run, 0, 9), 9U);
}

TEST_F(Scenarios, RepeatStoresThatAreHeldOff) {
  Course run = course("[[traffic]]\nnode = \"a\"\nperiod_ns = 50\nlongword = 0\n");
  run.run_until(100us);
  // The FIFO is full once 1024 stores, at 50 ns, are ahead of messages of 92 bits; then a store is
  // held off for each message.
  const double full_ns = 1024 / (1 / 50.0 - 1 / (92 * kBitNs));
  EXPECT_NEAR(static_cast<double>(run.stalls()), (100'000 - full_ns) / (92 * kBitNs), 2);
  EXPECT_GE(run.ring().card(0).report().transmit_fifo, 1020U);
}

TEST_F(Scenarios, HaveEachKindOfFault) {
  const auto with = [&](const std::string& fault) {
    Course run = course("[[fault]]\nat_us = 1\n" + fault +
                        "\n[[write]]\nat_us = 2\nnode = \"a\"\nlongword = 5\nvalue = 9\n");
    run.run_until(50us);
    return run;
  };
  Course off = with("kind = \"power_off\"\nnode = \"b\"");
  EXPECT_EQ(word(off, 2, 5), 9U);
  EXPECT_EQ(off.ring().card(1).report().stored, 0U);
  Course cut = with("kind = \"cut_fibre\"\nnode = \"b\"");
  EXPECT_EQ(word(cut, 1, 5), 9U);
  EXPECT_EQ(word(cut, 2, 5), 0U);
  Course noisy = with("kind = \"bit_error_rate\"\nrate = 1");
  EXPECT_EQ(word(noisy, 1, 5), 0U);
  EXPECT_EQ(noisy.ring().card(1).report().rejected, 1U);
  Course slow = with("kind = \"delay\"\nnode = \"b\"\ndelay_ns = 5000");
  EXPECT_NEAR(to_ns(slow.ring().card(1).report().longest_delay), 5000 + kNodeNs, 0.1);
  Course same = with("kind = \"id\"\nnode = \"b\"\nid = 1");
  EXPECT_EQ(same.ring().card(1).report().same_id, 1U);
  Course repaired = with(
      "kind = \"cut_fibre\"\nnode = \"b\"\n[[fault]]\nat_us = 1.5\nkind = \"repair_fibre\"\n"
      "node = \"b\"");
  EXPECT_EQ(word(repaired, 2, 5), 9U);
  Course back = with(
      "kind = \"power_off\"\nnode = \"b\"\n[[fault]]\nat_us = 1.5\n"
      "kind = \"power_on\"\nnode = \"b\"");
  EXPECT_EQ(back.ring().card(1).read_csr(0), 0U);
}

TEST_F(Scenarios, SetRegistersAndOptionsOfNodes) {
  Course run{load_scenario(file(R"(
format = 1
duration_us = 10
protocol = "platinum_1024"
strict_ids = true
[[node]]
name = "n"
count = 3
id = 254
fibre_m = 1.5
memory_bytes = 4096
extra_delay_ns = 10
bypass_switch = false
inserted = false
csr = [[0, 0x8001], [5, 7]]
)"))};
  run.run_until(1us);
  EXPECT_EQ(run.scenario().names, (std::vector<std::string>{"n1", "n2", "n3"}));
  EXPECT_EQ(run.ring().card(2).read_csr(3) >> 8, 0U);  // 254, 255, 0
  EXPECT_EQ(run.ring().card(1).read_csr(0), 0x8001U);
  EXPECT_EQ(run.ring().card(1).read_csr(2), 0x5840U);
  EXPECT_EQ(run.ring().card(1).read_csr(8) >> 12 & 7, 7U);
  EXPECT_EQ(run.ring().card(1).peek_csr(1) & 0x8000, 0x8000U);
  EXPECT_TRUE(run.scenario().setup.strict_ids);
  EXPECT_EQ(run.scenario().setup.nodes[0].extra_delay, Time{150});
}

TEST_F(Scenarios, SendInterruptsOfGtCards) {
  Course run{load_scenario(file(R"(
format = 1
cards = "gt"
duration_us = 10
[[node]]
name = "a"
[[node]]
name = "b"
[[write]]
at_us = 1
node = "a"
interrupt = 3
value = 77
)"))};
  run.ring().card(1).set_gt_state(6, 0xFF);
  run.run_until(10us);
  EXPECT_EQ(run.ring().card(1).take_interrupt()->value, 77U);
}

TEST_F(Scenarios, NameThePlaceOfAMistake) {
  EXPECT_NE(mistake(kThreeNodes + "[[write]]\nat_us = 1\nnode = \"aa\"\nlongword = 1\nvalue = 1\n")
                .find("scenario.toml:12:8"),
            std::string::npos);
  EXPECT_NE(mistake(kThreeNodes + "[[fault]]\nat_us = 1\nkind = \"cut_fiber\"\nnode = \"a\"\n")
                .find("cut_fibre"),
            std::string::npos);
  EXPECT_NE(mistake("format = 1\nduration_us = 1\n").find("no node"), std::string::npos);
  EXPECT_NE(mistake("protokoll = \"burst\"\n" + kThreeNodes).find("protokoll"), std::string::npos);
  EXPECT_NE(mistake(kThreeNodes + "[[traffic]]\nnode = \"a\"\nperiod_ns = 0\nlongword = 1\n"), "");
  EXPECT_NE(mistake("protocol = \"gold\"\n" + kThreeNodes).find("platinum"), std::string::npos);
}

TEST_F(Scenarios, GiveTraceEventsOfEveryHop) {
  const auto scenario = load_scenario(
      file(kThreeNodes + "[[write]]\nat_us = 10\nnode = \"a\"\nlongword = 5\nvalue = 1\n"));
  const auto trace = nlohmann::json::parse(replicated::trace_of(scenario));
  std::vector<nlohmann::json> slices;
  int stored = 0, starts = 0, steps = 0;
  for (const auto& event : trace["traceEvents"]) {
    if (event["ph"] == "X") slices.push_back(event);
    if (event["ph"] == "i" && event["args"]["event"] == "stored") ++stored;
    if (event["ph"] == "s") ++starts;
    if (event["ph"] == "t") ++steps;
  }
  ASSERT_EQ(slices.size(), 3U);
  EXPECT_EQ(stored, 2);
  EXPECT_EQ(starts, 1);
  EXPECT_EQ(steps, 2);
  for (std::size_t hop = 0; hop < 3; ++hop) {
    EXPECT_EQ(slices[hop]["tid"], hop);
    EXPECT_NEAR(slices[hop]["ts"], 10 + static_cast<double>(hop) * 1e-3 * (kNodeNs + 50), 1e-4);
    EXPECT_NEAR(slices[hop]["dur"], 1e-3 * kMessageNs, 1e-4);
    EXPECT_EQ(slices[hop]["args"]["age"], hop);
    EXPECT_EQ(slices[hop]["args"]["byte_offset"], 20);
  }
}

TEST_F(Scenarios, GiveTheSameTraceEachTime) {
  const auto scenario = load_scenario(file("bit_error_rate = 1e-4\n" + kThreeNodes +
                                           "[[traffic]]\nnode = \"a\"\nperiod_ns = 700\nlongword = "
                                           "5\nlongwords = 100\norder = \"random\"\n"));
  EXPECT_EQ(replicated::trace_of(scenario), replicated::trace_of(scenario));
}

TEST_F(Scenarios, AreShownWithRegistersInWordsAndLevels) {
  Course run = course("[[traffic]]\nnode = \"a\"\nperiod_ns = 50\nlongword = 0\n");
  run.run_until(100us);
  const std::string text = replicated::show(run);
  EXPECT_NE(text.find("a --10 m--> b --10 m--> c --10 m--> a"), std::string::npos) << text;
  EXPECT_NE(text.find("CSR0 8003  receive, transmit, inserted"), std::string::npos) << text;
  EXPECT_NE(
      text.find("CSR1 0007  transmit FIFO full, transmit FIFO not empty, transmit FIFO at 7/8"),
      std::string::npos)
      << text;
  EXPECT_NE(text.find("[####################] 102"), std::string::npos) << text;
  EXPECT_NE(text.find("ring of 3 nodes"), std::string::npos) << text;
  EXPECT_EQ(text, replicated::show(run));  // showing changes nothing
}

TEST_F(Scenarios, OfTheExamplesRun) {
  for (const auto& entry : std::filesystem::directory_iterator{source_tree() / "examples/cards"}) {
    if (entry.path().extension() != ".toml") continue;
    Course run{load_scenario(entry.path())};
    run.run_until(run.scenario().duration);
    EXPECT_GT(run.ring().hops(), 3U) << entry.path();
  }
  Course two{load_scenario(source_tree() / "examples/cards/two_writers.toml")};
  two.run_until(20us);
  EXPECT_EQ(word(two, 0, 100), 0x22U);
  EXPECT_EQ(word(two, 2, 100), 0x11U);
}

}  // namespace
}  // namespace rths::test
