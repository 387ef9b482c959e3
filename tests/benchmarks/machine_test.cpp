// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/load.hpp>
#include <rths/bench/machine.hpp>

#include <gtest/gtest.h>

namespace rths::bench {
namespace {

constexpr double kTicks = 100;  // [1/s]

// user nice system idle iowait irq softirq steal guest guest_nice
constexpr const char* kBefore =
    "cpu  9000 0 9000 9000 0 0 0 0 0 0\n"
    "cpu0 1000 10 100 5000 50 1 2 20 7 0\n"
    "cpu1 1000 0 100 5000 0 0 0 0 0 0\n"
    "cpu10 9000 0 9000 9000 0 0 0 9000 0 0\n"
    "intr 123 4 5\n";
// A second later, both processors busy all the time; the host used a tenth of one processor.
constexpr const char* kAfter =
    "cpu  9000 0 9000 9000 0 0 0 0 0 0\n"
    "cpu0 1080 10 110 5000 50 1 2 30 7 0\n"
    "cpu1 1090 0 110 5000 0 0 0 0 0 0\n"
    "cpu10 9900 0 9000 9000 0 0 0 9900 0 0\n"
    "intr 123 4 5\n";

TEST(CpuTimes, IncludeOnlyTheTwoProcessors) {
  const CpuTimes times = parse_cpu_times(kBefore, {0, 1}, kTicks);

  EXPECT_DOUBLE_EQ(times.busy, 22.13);
  EXPECT_DOUBLE_EQ(times.idle, 100.50);
  EXPECT_DOUBLE_EQ(times.steal, 0.20);
}

TEST(CpuTimes, AreZeroForAnEmptyText) {
  const CpuTimes times = parse_cpu_times("", {0, 1}, kTicks);

  EXPECT_EQ(times.busy + times.idle + times.steal, 0);
}

TEST(CpuTimes, AreReadFromKernelsWithFewerColumns) {
  const CpuTimes times = parse_cpu_times("cpu0 100 0 0 50\ncpu1 0 0 0 50\n", {0, 1}, kTicks);

  EXPECT_DOUBLE_EQ(times.busy, 1);
  EXPECT_DOUBLE_EQ(times.idle, 1);
  EXPECT_DOUBLE_EQ(times.steal, 0);
}

Load load_beside(double own) {
  return load_between(parse_cpu_times(kBefore, {0, 1}, kTicks),
                      parse_cpu_times(kAfter, {0, 1}, kTicks), own);
}

TEST(Load, IsZeroWithoutOtherProcesses) { EXPECT_NEAR(load_beside(1.9).other, 0, 1e-12); }

TEST(Load, IsTheShareOfOtherProcessesInTheProcessorsTime) {
  EXPECT_NEAR(load_beside(1.5).other, 0.4 / 2.0, 1e-12);
}

TEST(Load, IsNeverNegative) { EXPECT_EQ(load_beside(3).other, 0); }

TEST(Load, CountsTheHostsShareSeparately) { EXPECT_NEAR(load_beside(1.9).steal, 0.1 / 2.0, 1e-12); }

TEST(CpuList, IsReadInTheKernelsFormat) {
  EXPECT_EQ(parse_cpu_list("0"), (std::vector<int>{0}));
  EXPECT_EQ(parse_cpu_list("0,4"), (std::vector<int>{0, 4}));
  EXPECT_EQ(parse_cpu_list("2-4,8"), (std::vector<int>{2, 3, 4, 8}));
  EXPECT_EQ(parse_cpu_list(""), std::vector<int>{});
}

TEST(CpuChoice, IsNoneOnASingleProcessor) {
  EXPECT_FALSE(choose_cpus({{0, 0, {0}}}));
  EXPECT_FALSE(choose_cpus({}));
}

TEST(CpuChoice, TakesBothOfTwo) {
  const auto choice = choose_cpus({{0, 0, {0}}, {1, 0, {1}}});

  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->cpus.near, 0);
  EXPECT_EQ(choice->cpus.far, 1);
  EXPECT_FALSE(choice->siblings);
}

TEST(CpuChoice, AvoidsProcessorsThatShareACore) {
  const auto choice = choose_cpus({{2, 0, {2, 3}}, {3, 0, {2, 3}}, {4, 0, {4, 5}}});

  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->cpus.near, 2);
  EXPECT_EQ(choice->cpus.far, 4);
  EXPECT_FALSE(choice->siblings);
}

TEST(CpuChoice, MarksSiblingsIfThereAreNoOthers) {
  const auto choice = choose_cpus({{0, 0, {0, 1}}, {1, 0, {0, 1}}});

  ASSERT_TRUE(choice);
  EXPECT_TRUE(choice->siblings);
}

TEST(CpuChoice, LeavesProcessorZeroToTheInterrupts) {
  const auto choice = choose_cpus({{0, 0, {0}}, {1, 0, {1}}, {2, 0, {2}}});

  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->cpus.near, 1);
  EXPECT_EQ(choice->cpus.far, 2);
}

TEST(CpuChoice, StaysInOnePackageIfItCan) {
  const auto choice = choose_cpus({{1, 0, {1}}, {2, 1, {2}}, {3, 1, {3}}});

  ASSERT_TRUE(choice);
  EXPECT_EQ(choice->cpus.near, 2);
  EXPECT_EQ(choice->cpus.far, 3);
}

TEST(Machine, IsDescribedFromTheKernel) {
  const Machine machine = describe_machine();

  EXPECT_FALSE(machine.cpu.empty());
  EXPECT_GE(machine.processors, 1);
  EXPECT_FALSE(machine.kernel.empty());
}

TEST(Load, IsATroubleIfTheHostTookMoreThanTwoPercent) {
  EXPECT_EQ(steal_trouble(0.02), "");
  EXPECT_EQ(steal_trouble(0.1),
            "the host used 10.0 % of the processors' time, expected at most 2 %");
}

}  // namespace
}  // namespace rths::bench
