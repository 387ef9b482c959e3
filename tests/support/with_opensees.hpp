// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "support/opensees.hpp"

namespace rths::test {

/// A fixture for tests that need OpenSees; reports and skips them without it.
template <class Fixture = testing::Test>
class WithOpenSees : public Fixture {
 protected:
  void SetUp() override {
    const auto python = opensees_python();
    if (!python)
      GTEST_SKIP()
          << "SKIPPED: OpenSees is not installed; ./lab test installs it in build/opensees";
    python_ = *python;
  }
  std::string python_;
};

}  // namespace rths::test
