// SPDX-License-Identifier: Apache-2.0
#include "replicated_card.hpp"

namespace rths::test {
namespace {

memmap::Partition words_of(const std::string& node, std::uint32_t base, std::uint32_t longwords) {
  memmap::Partition partition;
  partition.name = node + std::to_string(base);
  partition.node = node;
  partition.base = LongwordOffset{base};
  partition.longwords = longwords;
  return partition;
}

}  // namespace

std::unique_ptr<CarriedImages> ReplicatedCard::images;
std::optional<broker::Ring> ReplicatedCard::controllers_ring, ReplicatedCard::watchers_ring;
std::optional<broker::Node> ReplicatedCard::controller, ReplicatedCard::watcher;
std::vector<int> ReplicatedCard::at_start;

memmap::Map ReplicatedCard::map() {
  memmap::MapDescription description;
  description.name = "four_pages";
  description.size_longwords = 4 * kPage;
  description.nodes = {
      {"controller", NodeId{1}, ""}, {"machine", NodeId{2}, ""}, {"watcher", NodeId{3}, ""}};
  memmap::Partition group = words_of("controller", kGroup, kGroupLongwords);
  group.tear_group = true;
  description.partitions = {words_of("machine", 0, 128),
                            words_of("controller", kOther, kOthers),
                            words_of("watcher", 300, 4),
                            group,
                            words_of("machine", kPage + kWord, 128 - kWord),
                            words_of("controller", kOtherOnPage, 128),
                            words_of("machine", kOwnPage * kPage, kPage)};
  return memmap::Map{description};
}

void ReplicatedCard::SetUpTestSuite() {
  setenv("RTHS_SCRAMNET_RING", name().c_str(), 1);
  setenv("RTHS_SCRAMNET_NODE", "machine", 1);
  setenv("RTHS_SCRAMNET_CARD_BYTES", std::to_string(4 * kPage).c_str(), 1);
  images = std::make_unique<CarriedImages>(name(), map());
  controllers_ring.emplace(broker::Ring::attach(image("controller")));
  controller.emplace(controllers_ring->join("controller", 0));
  watchers_ring.emplace(broker::Ring::attach(image("watcher")));
  watcher.emplace(watchers_ring->join("watcher", 0));
  ASSERT_TRUE(soon([] {
    return card_of("controller").csr[0] == 0x8003 && card_of("watcher").csr[0] == 0x8003;
  }));
  ASSERT_EQ(sp_scram_init(0), 0);
  for (int index = 0; index < 16; ++index) at_start.push_back(csr(index));
}

void ReplicatedCard::TearDownTestSuite() {
  controller.reset();
  watcher.reset();
  controllers_ring.reset();
  watchers_ring.reset();
  images.reset();
}

void ReplicatedCard::SetUp() {
  set_csr(SCR_CSR0, 0xF000);
  set_csr(SCR_CSR2, 0xC040);
  set_csr(SCR_CSR8, 0x0800);
  set_csr(SCR_CSR9, 0x0021);
  set_csr(SCR_CSR3, 0x0200);
  scr_mclr_mm(ACR);
  set_csr(SCR_CSR0, 0x8003);
  static_cast<void>(csr(SCR_CSR1));
  store(1);
  ASSERT_TRUE(arrives(1));
  store(0);
  ASSERT_TRUE(arrives(0));
}

std::string ReplicatedCard::as_node(const std::string& node, std::vector<std::string> arguments) {
  std::vector<std::string> command{"/usr/bin/env", "RTHS_SCRAMNET_NODE=" + node,
                                   "RTHS_SCRAMNET_SHARE=1",
                                   (build_tree() / "bin/scramnet_registers").string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const Finished finished = Running{command}.wait(20);
  EXPECT_EQ(finished.exit_code, 0) << finished.err;
  return finished.out;
}

}  // namespace rths::test
