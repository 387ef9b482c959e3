// SPDX-License-Identifier: Apache-2.0
//
// A laboratory in a test by GoogleTest, which the program links itself.
//
//     class SpringMachine : public rths::testkit::LaboratoryTest {};
//     TEST_F(SpringMachine, AnswersWithItsForce) {
//       auto& lab = laboratory("two_signals.ringmap.toml");
//       lab.start({"machine", {"python3", "spring_machine.py", "{ring}"}});
//       lab.join("solver")->write("solver.displacement", 0.1);
//       expect_within(1, "machine.force", {1e5, 10});
//     }
#pragma once

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include <rths/testkit/laboratory.hpp>

namespace rths::testkit {

/// Gives a test a laboratory of its own. Of a failed test, logs and recording stay in the folder
/// that RTHS_KEEP names, out/failed_tests by default; otherwise nothing stays.
///
/// Functions of the laboratory throw NotMet, which ends the test as failed. Those of this class add
/// a failure at the line of the call, and the test continues.
class LaboratoryTest : public ::testing::Test {
 protected:
  /// The laboratory of this test, created by the first call. @see Laboratory
  Laboratory& laboratory(const std::string& map, double deadline_s = 60) {
    if (lab_) throw Error{"this test has its laboratory already"};
    const char* const kept = std::getenv("RTHS_KEEP");
    const auto* const info = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ =
        make_test_folder(std::filesystem::absolute(kept == nullptr ? "out/failed_tests" : kept),
                         std::string{info->test_suite_name()} + "." + info->name());
    lab_ = std::make_unique<Laboratory>(folder_, map, deadline_s);
    return *lab_;
  }

  void expect_within(double seconds, const std::string& signal, const Condition& condition,
                     const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    reported(file, line, [&] { lab_->expect_within(seconds, signal, condition); });
  }
  void eventually(const std::string& signal, const Condition& condition,
                  const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    reported(file, line, [&] { lab_->eventually(signal, condition); });
  }
  void never(double seconds, const std::string& signal, const Condition& condition,
             const char* file = __builtin_FILE(), int line = __builtin_LINE()) {
    reported(file, line, [&] { lab_->never(seconds, signal, condition); });
  }

  void TearDown() override {
    if (folder_.empty()) return;
    if (lab_ && !HasFailure()) reported(__FILE__, __LINE__, [&] { lab_->check_owners(); });
    if (lab_ && HasFailure()) {
      lab_->keep();
      std::printf("logs and recording: %s\n", folder_.c_str());
    }
    lab_.reset();
    if (!HasFailure()) remove_test_folder(folder_);
  }

 private:
  template <class Call>
  static void reported(const char* file, int line, Call call) {
    try {
      call();
    } catch (const NotMet& failure) {
      ADD_FAILURE_AT(file, line) << failure.what();
    }
  }

  std::filesystem::path folder_;
  std::unique_ptr<Laboratory> lab_;
};

}  // namespace rths::testkit
