// SPDX-License-Identifier: Apache-2.0
//
// The commands on rings that another program has damaged; tests/broker has many more of these.
#include <algorithm>

#include <gtest/gtest.h>

#include "broker/damage.hpp"
#include "support/long_run.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths {
namespace {

TEST(DamagedRingCommands, EndWithAtMostOneLineOfError) {
  const std::string name = test::unique_ring("damaged_command");
  const test::RingRemoval removal{name};
  const broker::RingImage image = broker::ring_to_damage();
  const std::uint64_t seeds = test::is_long() ? 300 : 10;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    broker::install(broker::damaged(image, seed), name);
    for (const std::vector<std::string>& command : {std::vector<std::string>{"doctor"},
                                                    {"dump", name, "--once"},
                                                    {"who", name},
                                                    {"watch", name, "-T", "10"},
                                                    {"send", name, "p3.long=1"},
                                                    {"clean"}}) {
      const test::Finished finished = test::run_rths(command);

      EXPECT_EQ(finished.signal, 0) << command[0] << " with seed " << seed;
      EXPECT_LE(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
      EXPECT_LT(finished.host_seconds, 10) << command[0] << " with seed " << seed;
    }
  }
}

}  // namespace
}  // namespace rths
