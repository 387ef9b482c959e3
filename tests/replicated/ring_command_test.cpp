// SPDX-License-Identifier: Apache-2.0
//
// `rths ring` as a user runs it.
#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <rths/replicated/images.hpp>

#include "scramnet/vendor_ring.hpp"

#include <scrplus.h>

namespace {

using rths::test::run_rths;

std::string example(const std::string& name) {
  return (rths::test::source_tree() / "examples/cards" / name).string();
}

TEST(RingCommand, WritesATraceThatIsJson) {
  const rths::test::TemporaryFolder folder;
  const auto out = folder.path() / "trace.json";
  const auto run = run_rths({"ring", "trace", example("two_writers.toml"), "--out", out.string()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("4 nodes, seed 1"), std::string::npos) << run.out;
  const auto trace = nlohmann::json::parse(rths::test::content_of(out));
  EXPECT_GT(trace["traceEvents"].size(), 16U);
}

TEST(RingCommand, DrawsAScenarioAtATime) {
  const auto early = run_rths({"ring", "show", example("dead_node.toml"), "--at-us", "50"});
  ASSERT_EQ(early.exit_code, 0) << early.err;
  EXPECT_NE(early.out.find("50.000 µs, 4 SCRAMNet+ cards"), std::string::npos) << early.out;
  EXPECT_EQ(early.out.find("repeated after a time-out"), std::string::npos);
  const auto open = run_rths({"ring", "show", example("dead_node.toml"), "--at-us", "250"});
  EXPECT_NE(open.out.find("repeated after a time-out"), std::string::npos) << open.out;
  EXPECT_NE(open.out.find("xpc\n  no power\n"), std::string::npos) << open.out;
}

TEST(RingCommand, NamesASourceThatIsNeitherScenarioNorRing) {
  const auto run = run_rths({"ring", "show", "no_such_ring_or_file"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_NE(run.err.find("neither a scenario file nor a ring"), std::string::npos) << run.err;
  EXPECT_EQ(run_rths({"ring", "trace", "no_such_file"}).exit_code, 3);
}

class SharedCards : public rths::test::VendorRing {};

TEST_F(SharedCards, AreShownWithTheirRegistersInWords) {
  ASSERT_EQ(sp_scram_init(0), 0);
  scr_reset_mm();
  scr_csr_write(SCR_CSR3, 0x2A00);
  scr_csr_write(SCR_CSR0, 0x8003);
  scr_csr_write(SCR_CSR1, 0);
  const auto run = run_rths({"ring", "show", ring()});
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("id 42, of process " + std::to_string(getpid())), std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("CSR0 8003  receive, transmit, inserted"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("CSR1 4000  armed"), std::string::npos) << run.out;
  EXPECT_EQ(scr_csr_read(SCR_CSR1) & CSR1_IARM, CSR1_IARM);
  EXPECT_EQ(run_rths({"ring", "show", ring(), "--at-us", "5"}).exit_code, 2);
}

TEST(ReplicatedRing, IsShownNodeByNode) {
  const std::string name = rths::test::unique_ring("shown");
  auto images = rths::replicated::Images::create(name, rths::test::small_map(), {});
  auto machine = images.of("machine").join("machine", 0);
  ASSERT_EQ(machine.write(rths::test::kMachineWord, 1), rths::Status::Ok);
  for (int ms : {0, 10, 20}) images.advance(std::chrono::milliseconds{ms});

  const auto run = run_rths({"ring", "show", name});

  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_NE(run.out.find("machine, image '" + name + ".machine', id 1"), std::string::npos)
      << run.out;
  EXPECT_NE(run.out.find("CSR0 8003  receive, transmit, inserted"), std::string::npos) << run.out;
  EXPECT_NE(run.out.find("messages sent 1, stored 0, rejected 0"), std::string::npos) << run.out;
}

TEST(FaultCommand, SaysWhyItCausesNoFault) {
  const std::string name = rths::test::unique_ring("faultless");
  const auto shared = rths::broker::Ring::create(name, rths::test::small_map());
  const rths::test::RingRemoval removal{name};

  const auto of_shared = run_rths({"fault", name, "kind=power_off", "node=machine"});
  EXPECT_EQ(of_shared.exit_code, 2);
  EXPECT_NE(of_shared.err.find("is shared, expected a replicated one"), std::string::npos);
  const auto of_nobody = run_rths({"fault", name, "kind=power_off", "node=machin"});
  EXPECT_EQ(of_nobody.exit_code, 2);
  EXPECT_NE(of_nobody.err.find("'machin' is no node (did you mean 'machine'?); the nodes are "
                               "machine, controller"),
            std::string::npos)
      << of_nobody.err;
  EXPECT_EQ(run_rths({"fault", name, "power_off"}).exit_code, 2);
}

}  // namespace
