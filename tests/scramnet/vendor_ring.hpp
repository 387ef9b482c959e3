// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdlib>
#include <string>
#include <vector>

#include <unistd.h>

#include <gtest/gtest.h>

#include <rths/broker/ring.hpp>

#include "support/files.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths::test {

/// A separate ring for the vendor's calls of this process and of its child processes.
class VendorRing : public testing::Test {
 protected:
  static std::string ring() { return "test_scramnet_" + std::to_string(getpid()); }

  static void SetUpTestSuite() { use(ring()); }

  static void use(const std::string& name) {
    static const RingRemoval plus{ring()};
    static const RingRemoval gt{ring() + "_gt"};
    setenv("RTHS_SCRAMNET_RING", name.c_str(), 1);
    setenv("RTHS_SCGT_RING", (ring() + "_gt").c_str(), 1);
  }

  /// A client program of this folder.
  static std::vector<std::string> client(const std::string& name,
                                         const std::vector<std::string>& arguments = {}) {
    std::vector<std::string> command{(build_tree() / "bin" / ("scramnet_" + name)).string()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }
};

}  // namespace rths::test
