// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "support/opensees.hpp"

namespace rths::test {

/// A fixture of tests that need OpenSees: says so where there is none, and skips them.
template <class Fixture = testing::Test>
class WithOpenSees : public Fixture {
 protected:
  void SetUp() override {
    const auto python = opensees_python();
    if (!python)
      GTEST_SKIP()
          << "SKIPPED: there is no OpenSees here; ./lab test installs it in build/opensees";
    python_ = *python;
  }
  std::string python_;
};

}  // namespace rths::test
