// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <rths/recording/roles.hpp>

#include "support/files.hpp"

namespace rths::recording {
namespace {

Roles roles_in(const std::string& text) { return read_roles(Config::parse(text, "x.toml")); }

memmap::Map map_of_a_target() {
  return memmap::parse_map(
      "ringmap = 1\n[ring]\nname = 'x'\nversion = 1\nsize_bytes = 4096\n[nodes]\na = 1\n"
      "[[partition]]\nname = 'a'\nnode = 'a'\noffset = 0\nlongwords = 1\n"
      "[[partition.signal]]\nname = 'displ'\noffset = 0\ntype = 'f32'\nunit = 'm'\n",
      "x");
}

TEST(Roles, AreTheWordsOfTheSrmdByDefault) {
  const Roles roles = roles_in("");

  EXPECT_EQ(roles.new_target, "opf.newTarget");
  ASSERT_EQ(roles.axes.size(), 2U);
  EXPECT_EQ(roles.axes[1].command, "monitor.xpc.pc.command.lat");
  EXPECT_EQ(roles.axes[1].machine_force, "srmd.lat.force.fbk");
}

TEST(Roles, FollowTheAdaptersOfTheNodes) {
  const Roles roles = roles_in("[node.target]\nadapter = 'simulink_like'\n");

  EXPECT_EQ(roles.controller, "target");
  EXPECT_EQ(roles.axes[0].command, "monitor.target.pc.command.long");
  EXPECT_EQ(roles.vertical_command, "monitor.target.vertical_load.out");
}

TEST(Roles, AreBoundToWordsOfAnyMap) {
  const Roles roles =
      roles_in("axes = ['long']\n[roles]\nnew_target = 'a.go'\n[roles.long]\ntarget = 'a.displ'\n");

  EXPECT_EQ(roles.new_target, "a.go");
  ASSERT_EQ(roles.axes.size(), 1U);
  EXPECT_EQ(roles.axes[0].target, "a.displ");
}

TEST(Roles, AreThoseOfTheMapUnlessTheExperimentStatesOthers) {
  const auto experiment =
      Config::parse("axes = ['long']\n[roles]\nnew_target = 'a.go'\n", "x.toml");
  const auto map = Config::parse("new_target = 'b.go'\nmachine = 'b'\n[long]\ntarget = 'b.displ'\n",
                                 "b.ringmap.toml");

  const Roles roles = read_roles(with_map_roles(experiment, map));

  EXPECT_EQ(roles.new_target, "a.go");
  EXPECT_EQ(roles.machine, "b");
  EXPECT_EQ(roles.axes.at(0).target, "b.displ");
}

TEST(Roles, RefuseAnUnknownRoleAndAnUnknownWord) {
  EXPECT_NE(test::error_of([] {
              static_cast<void>(roles_in("[roles.long]\ntarger = 'a'\n"));
            }).find("did you mean 'target'"),
            std::string::npos);

  const auto roles = Config::parse("[long]\ntarget = 'a.dipsl'\n", "x.toml");
  const std::string error = test::error_of([&] { check_roles(roles, map_of_a_target()); });
  EXPECT_NE(error.find("x.toml:2"), std::string::npos) << error;
  EXPECT_NE(error.find("a.displ"), std::string::npos) << error;
}

}  // namespace
}  // namespace rths::recording
