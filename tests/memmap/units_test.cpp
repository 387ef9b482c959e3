// SPDX-License-Identifier: Apache-2.0
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <ostream>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/memmap/units.hpp>

#include "support/files.hpp"

namespace rths::memmap {
namespace {

struct Known {
  const char* text;
  const char* si;
  double scale;
  friend std::ostream& operator<<(std::ostream& out, const Known& known) {
    return out << known.text;
  }
};

class KnownUnit : public ::testing::TestWithParam<Known> {};

TEST_P(KnownUnit, ConvertsToItsSiUnit) {
  const Unit unit = parse_unit(GetParam().text);

  EXPECT_EQ(unit.si, GetParam().si);
  EXPECT_NEAR(unit.scale, GetParam().scale, 1e-9 * GetParam().scale);
  EXPECT_EQ(unit.offset, 0);
}

// Exact by definition: the inch (1959), the pound-force and standard gravity (CGPM 1901).
INSTANTIATE_TEST_SUITE_P(
    Units, KnownUnit,
    ::testing::Values(
        Known{"mm", "m", 1e-3}, Known{"inch", "m", 0.0254}, Known{"kip", "N", 4448.2216152605},
        Known{"kN", "N", 1e3}, Known{"gravity", "m/s2", 9.80665},
        Known{"kN/gravity", "kg", 1e3 / 9.80665}, Known{"kN.s/cm", "N.s/m", 1e5},
        Known{"degree", "rad", 0.017453292519943}, Known{"rpm", "rad/s", 0.10471975511966},
        Known{"turn", "rad", 6.2831853071796}, Known{"degree/s2", "rad/s2", 0.017453292519943},
        Known{"kip.inch", "N.m", 112.98482902762}, Known{"psi", "Pa", 6894.757293168},
        Known{"ms", "s", 1e-3}, Known{"percent", "1", 0.01}, Known{"V", "V", 1}, Known{"1", "1", 1},
        Known{"Hz", "Hz", 1}, Known{"s2", "s2", 1}, Known{"kN/mm", "N/m", 1e6},
        Known{"litre/s", "m3/s", 1e-3}, Known{"kN/s", "N/s", 1e3}, Known{"bar", "Pa", 1e5}));

TEST(Unit, ShiftsCelsius) {
  const Unit unit = parse_unit("degC");

  EXPECT_EQ(unit.si, "K");
  EXPECT_NEAR(unit.offset, 273.15, 1e-9);
}

TEST(Unit, RefusesTheAmbiguousG) {
  EXPECT_EQ(test::error_of([] { static_cast<void>(parse_unit("g")); }),
            "unit 'g' is ambiguous, expected 'gravity' (acceleration) or 'gram' (mass)");
}

TEST(Unit, IsReadByManyThreadsAtOnce) {
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&wrong] {
      for (int k = 0; k < 25; ++k)
        if (std::abs(parse_unit("kN/mm").scale - 1e6) > 1e-6) ++wrong;
    });
  for (auto& thread : threads) thread.join();

  EXPECT_EQ(wrong.load(), 0);
}

// A child of a fork would wait for ever for a lock that a thread of its parent held.
TEST(Units, CanBeReadInTheChildOfAProcessWhoseThreadsReadUnits) {
  std::atomic<bool> ends{false};
  std::thread other{[&] {
    while (!ends.load()) static_cast<void>(parse_unit("kN/mm"));
  }};
  int failed = 0;
  for (int i = 0; i < 200; ++i) {
    const pid_t child = fork();
    if (child == 0) {
      alarm(5);
      _exit(parse_unit("mm").scale == 1e-3 ? 0 : 1);
    }
    int status = 0;
    waitpid(child, &status, 0);
    failed += status == 0 ? 0 : 1;
  }
  ends.store(true);
  other.join();
  EXPECT_EQ(failed, 0);
}

}  // namespace
}  // namespace rths::memmap
