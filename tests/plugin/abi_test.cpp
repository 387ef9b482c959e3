// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths_adapter.h>

#include <rths/plugin/library.hpp>

#include "support/files.hpp"

extern "C" std::size_t size_of_adapter_in_c(void);

namespace rths::plugin {
namespace {

std::filesystem::path broken(const std::string& name) {
  return test::build_tree() / "broken" / (name + ".so");
}

TEST(AdapterAbi, IsTheSameInCAndCpp) { EXPECT_EQ(size_of_adapter_in_c(), sizeof(rths_adapter)); }

TEST(AdapterAbi, LoadsAnEarlierMinorWithoutItsLaterMembers) {
  const Library library{broken("earlier_minor")};

  EXPECT_EQ(library.adapter().abi & 0xFFFF, 0U);
  EXPECT_EQ(library.stop(), nullptr);
  EXPECT_EQ(library.message(), nullptr);
}

TEST(AdapterAbi, LoadsALaterMinor) { EXPECT_NE(Library{broken("later_minor")}.stop(), nullptr); }

TEST(AdapterAbi, RefusesAnotherMajor) {
  EXPECT_EQ(test::error_of([] { Library{broken("wrong_major")}; }),
            broken("wrong_major").string() +
                ": has adapter ABI 2.0, expected 1.x: build it against this version's "
                "rths_adapter.h");
}

TEST(AdapterAbi, RefusesAFileThatIsNoLibrary) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("text.so", "not a library");

  EXPECT_NE(test::error_of([&] { Library{file}; }).find("cannot load the plugin"),
            std::string::npos);
}

}  // namespace
}  // namespace rths::plugin
