// SPDX-License-Identifier: Apache-2.0
//
// Compiles the generated headers and compares them with the map.
#include <cstdlib>

#include <gtest/gtest.h>

#include <rths/memmap/codec.hpp>
#include <rths/memmap/generate.hpp>

#include "memmap/srmd.hpp"
#include "support/files.hpp"

namespace rths::memmap {
namespace {

int run(const std::string& command) { return std::system(command.c_str()); }

TEST(GeneratedCHeader, CompilesAsC11AndAgreesWithTheMap) {
  const test::TemporaryFolder folder;
  folder.write("srmd.h", generate_c(srmd()));
  const auto program = folder.write("program.c", R"(
#include "srmd.h"
_Static_assert(SRMD_MAP_VERSION == 1, "version");
_Static_assert(SRMD_OPF_NEWTARGET == 1024, "newTarget");
_Static_assert(SRMD_OPF_NEWTARGET_STOP == -1, "a value's name");
_Static_assert(SRMD_DAQ_7_TIME_FBK == 1096, "last word");
_Static_assert(SRMD_NODE_XPC == 2, "node id");
int main(void) {
  const double error = SRMD_XPC_LONG_DISPL_REF_SCALE - 0.0254; /* an inch, to rounding */
  return error < 1e-17 && error > -1e-17 ? 0 : 1;
}
)");

  const std::string binary = (folder.path() / "program").string();
  ASSERT_EQ(run("cc -std=c11 -Wall -Wextra -Werror -o " + binary + " " + program.string()), 0);
  EXPECT_EQ(run(binary), 0);
}

TEST(GeneratedCppHeader, CompilesAndConvertsAsTheCodecDoes) {
  const Map map = srmd();
  const Codec codec{*map.entry(map.signal("srmd.long.force.fbk")).signal};
  const test::TemporaryFolder folder;
  folder.write("srmd.hpp", generate_cpp(map));
  const auto program = folder.write("program.cpp", R"(
#include "srmd.hpp"
static_assert(srmd_map::kMapVersion == 1);
static_assert(srmd_map::opf_newTarget.offset == 1024);
static_assert(srmd_map::opf_newTarget_stop == -1);
int main() {
  using namespace srmd_map;
  const bool same = srmd_long_force_fbk.encode(1e6) == )" +
                                                       std::to_string(codec.encode(1e6)) + R"(u;
  return same && opf_newTarget.decode(opf_newTarget.encode(-1)) == -1 ? 0 : 1;
}
)");

  const std::string binary = (folder.path() / "program").string();
  ASSERT_EQ(run("c++ -std=c++20 -Wall -Wextra -Wconversion -Werror -o " + binary + " " +
                program.string()),
            0);
  EXPECT_EQ(run(binary), 0);
}

}  // namespace
}  // namespace rths::memmap
