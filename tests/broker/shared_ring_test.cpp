// SPDX-License-Identifier: Apache-2.0
//
// Rings shared by processes, and their state after one of them dies.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstring>
#include <functional>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "broker/src/segment.hpp"
#include "support/files.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using test::RingRemoval;
using test::small_map;
using test::unique_ring;

/// A child process that acts, reports ready, and waits to be killed.
class Victim {
 public:
  explicit Victim(const std::function<void()>& act) {
    std::array<int, 2> ready{};
    if (pipe(ready.data()) != 0) std::abort();
    pid_ = fork();
    if (pid_ == 0) {
      act();
      static_cast<void>(!write(ready[1], "r", 1));
      pause();
      _exit(0);
    }
    close(ready[1]);
    char byte = 0;
    static_cast<void>(!read(ready[0], &byte, 1));
    close(ready[0]);
  }
  ~Victim() { die(); }
  Victim(const Victim&) = delete;
  Victim& operator=(const Victim&) = delete;
  void die() {
    if (pid_ < 0) return;
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }
  [[nodiscard]] int pid() const { return pid_; }

 private:
  int pid_ = -1;
};

RingReport report_of(const std::string& name) {
  for (const auto& report : list_rings())
    if (report.name == name) return report;
  return {};
}

TEST(SharedRing, CarriesWordsBetweenProcesses) {
  const std::string name = unique_ring("words");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  const Node observer = ring.observe();

  const Victim machine{[&] {
    Ring attached = Ring::attach(name);
    Node node = attached.join("machine", small_map().hash());
    static_cast<void>(node.write(LongwordOffset{500}, 77));
  }};

  EXPECT_EQ(observer.read(LongwordOffset{500}), 77U);
}

TEST(SharedRing, GivesItsMapToAProcessThatAttaches) {
  const std::string name = unique_ring("map");
  const RingRemoval removal{name};
  const Ring ring = Ring::create(name, small_map());

  const Ring attached = Ring::attach(name);

  EXPECT_EQ(attached.map().to_toml(), small_map().to_toml());
}

TEST(SharedRing, StaysUsableWhenAProcessIsKilled) {
  const std::string name = unique_ring("killed");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  Node controller = ring.join("controller", 0);
  auto* leaked = new Victim{[&] {
    Ring attached = Ring::attach(name);
    new Node{attached.join("machine", 0)};  // held until the process is killed
    static_cast<void>(new Ring{std::move(attached)});
  }};
  ASSERT_EQ(controller.presence_of(NodeId{1}).state, Presence::State::Alive);

  leaked->die();
  delete leaked;

  EXPECT_EQ(controller.presence_of(NodeId{1}).state, Presence::State::Vanished);
  EXPECT_EQ(controller.write(LongwordOffset{512}, 5), Status::Ok);
  Node successor = ring.join("machine", 0);
  EXPECT_EQ(successor.write(LongwordOffset{500}, 6), Status::Ok);
  EXPECT_EQ(controller.read(LongwordOffset{500}), 6U);
}

// A writer that is killed in the middle of a record leaves an odd count and half of the words.
TEST(SharedRing, ReadsTheLastWholeGroupWhenItsWriterDiedInTheMiddle) {
  const std::string name = unique_ring("torn");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  std::array<std::uint32_t, 8> sent{1, 2, 3, 4, 5, 6, 7, 8};
  {
    Node machine = ring.join("machine", 0);
    ASSERT_EQ(machine.write_group(TearGroupId{0}, sent), Status::Ok);
  }
  const auto segment = Segment::attach_shared(name);
  std::uint32_t* record = segment->groups()[0].record;
  record[0] += 1;
  record[1] = 99;
  std::array<std::uint32_t, 8> read{};

  EXPECT_EQ(ring.observe().read_group(TearGroupId{0}, read), Status::Ok);
  EXPECT_EQ(read, sent);
  EXPECT_EQ(report_of(name).torn_groups, std::vector<std::string>{"fbk"});

  const Node successor = ring.join("machine", 0);
  EXPECT_TRUE(report_of(name).torn_groups.empty());
  EXPECT_EQ(record[1], 1U);
  EXPECT_EQ(ring.observe().read_group(TearGroupId{0}, read), Status::Ok);
  EXPECT_EQ(read, sent);
}

TEST(SharedRing, IsListedWithItsProcesses) {
  const std::string name = unique_ring("listed");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  Node controller = ring.join("controller", 0);
  controller.beat();

  const RingReport report = report_of(name);

  EXPECT_TRUE(report.usable);
  EXPECT_TRUE(report.in_use());
  EXPECT_EQ(report.map_name, "small");
  ASSERT_EQ(report.occupants.size(), 2U);
  EXPECT_EQ(report.occupants[0].node, "creator");
  EXPECT_EQ(report.occupants[1].node, "controller");
  for (const auto& occupant : report.occupants) {
    EXPECT_EQ(occupant.pid, getpid());
    EXPECT_TRUE(occupant.alive);
  }
  EXPECT_EQ(report.occupants[1].beats, 1U);
}

// Until the first node joins, a ring has only its creator.
TEST(SharedRing, IsInUseWhileItsCreatorIsOnIt) {
  const std::string name = unique_ring("creator");
  const RingRemoval removal{name};
  {
    const Ring ring = Ring::create(name, small_map());
    EXPECT_NE(test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); }), "");
  }
  ASSERT_FALSE(report_of(name).in_use());

  EXPECT_EQ(test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); }), "");
}

// A node that died must stay visible until its successor joins.
TEST(SharedRing, KeepsADeadNodeVisibleWhenOthersJoin) {
  const std::string name = unique_ring("in_sight");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  Victim machine{[&] {
    auto* attached = new Ring{Ring::attach(name)};
    new Node{attached->join("machine", 0)};
  }};
  machine.die();

  const Node observer = ring.observe();
  const Node controller = ring.join("controller", 0);

  EXPECT_EQ(controller.presence_of(NodeId{1}).state, Presence::State::Vanished);
  const Node successor = ring.join("machine", 0);
  EXPECT_EQ(controller.presence_of(NodeId{1}).state, Presence::State::Alive);
}

// A store through a look would end this process.
TEST(SharedRing, IsLookedAtWithoutATrace) {
  const RingRemoval ring{unique_ring("look")};
  Ring made = Ring::create(ring.name, small_map());
  Node writer = made.join("controller", 0);
  const auto before = made.report().occupants.size();

  Ring look = Ring::look_at(ring.name);
  const Node observer = look.observe();
  Follower follower = look.follow("controller");
  ASSERT_EQ(writer.write(test::kControllerWord, 42), Status::Ok);
  writer.beat();
  Write write;

  EXPECT_EQ(look.report().occupants.size(), before);
  EXPECT_EQ(observer.read(test::kControllerWord), 42U);
  EXPECT_EQ(follower.next(write), Followed::Write);
  EXPECT_EQ(write.value, 42U);
  EXPECT_EQ(observer.beats_of(look.map().node("controller")), 1U);
  EXPECT_EQ(look.last_write(test::kControllerWord).node, "controller");
  EXPECT_THROW(static_cast<void>(look.join("controller", 0)), Error);
  EXPECT_THROW(static_cast<void>(look.wait_for({})), Error);
}

TEST(SharedRing, IsReplacedWhileItIsLookedAt) {
  const RingRemoval ring{unique_ring("replaced")};
  std::optional<Ring> first{Ring::create(ring.name, small_map())};
  const Ring look = Ring::look_at(ring.name);
  EXPECT_TRUE(look.is_current());

  first.reset();
  const Ring second = Ring::create(ring.name, small_map());

  EXPECT_FALSE(look.is_current());
}

TEST(SharedRing, RefusesANameThatIsInUse) {
  const std::string name = unique_ring("in_use");
  const RingRemoval removal{name};
  Ring ring = Ring::create(name, small_map());
  const Node controller = ring.join("controller", 0);

  const std::string error =
      test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); });

  EXPECT_NE(error.find("controller (process " + std::to_string(getpid())), std::string::npos)
      << error;
}

TEST(SharedRing, ReplacesARingWithoutLivingProcesses) {
  const std::string name = unique_ring("abandoned");
  const RingRemoval removal{name};
  Victim creator{[&] {
    auto* ring = new Ring{Ring::create(name, small_map())};
    new Node{ring->join("controller", 0)};
  }};
  creator.die();
  ASSERT_FALSE(report_of(name).in_use());

  Ring ring = Ring::create(name, small_map(16));

  EXPECT_EQ(ring.map().hash(), small_map(16).hash());
}

TEST(SharedRing, IsGoneWhenRemoved) {
  const std::string name = unique_ring("removed");
  const Ring ring = Ring::create(name, small_map());

  EXPECT_TRUE(remove_ring(name));

  EXPECT_FALSE(remove_ring(name));
  EXPECT_NE(test::error_of([&] { static_cast<void>(Ring::attach(name)); }), "");
}

/// A shared-memory object of another program under a ring's name.
class ForeignObject {
 public:
  ForeignObject(std::string ring, const void* bytes, std::size_t count, std::size_t size)
      : ring_{std::move(ring)} {
    const int file = shm_open(("/" + object_name(ring_)).c_str(), O_CREAT | O_RDWR, 0600);
    if (ftruncate(file, static_cast<off_t>(size)) != 0) std::abort();
    if (count > 0 && write(file, bytes, count) < 0) std::abort();
    close(file);
  }
  ~ForeignObject() { remove_ring(ring_); }
  ForeignObject(const ForeignObject&) = delete;
  ForeignObject& operator=(const ForeignObject&) = delete;

 private:
  std::string ring_;
};

TEST(SharedRing, RefusesMemoryThatIsNotARing) {
  const std::string name = unique_ring("foreign");
  Header header{};
  header.magic = 0x1234;
  const ForeignObject foreign{name, &header, sizeof header, 8192};

  EXPECT_NE(
      test::error_of([&] { static_cast<void>(Ring::attach(name)); }).find("it is not an rths ring"),
      std::string::npos);
  EXPECT_FALSE(report_of(name).usable);
}

TEST(SharedRing, RefusesALayoutOfAnotherVersion) {
  const std::string name = unique_ring("version");
  Header header{};
  header.magic = kMagic;
  header.layout_version = kLayoutVersion + 1;
  const ForeignObject foreign{name, &header, sizeof header, 8192};
  const std::string expected = "its layout is version " + std::to_string(kLayoutVersion + 1) +
                               ", this program's is " + std::to_string(kLayoutVersion);

  EXPECT_NE(test::error_of([&] { static_cast<void>(Ring::attach(name)); }).find(expected),
            std::string::npos);
}

TEST(SharedRing, RefusesARingWhoseSizeDiffersFromItsHeader) {
  const std::string name = unique_ring("size");
  Header header = plan_layout(small_map(), "", 6);
  const ForeignObject foreign{name, &header, sizeof header, 8192};

  EXPECT_NE(
      test::error_of([&] { static_cast<void>(Ring::attach(name)); }).find("its size is 8192 bytes"),
      std::string::npos);
}

// Any process may have written the header: every offset, size and count in it is checked.
TEST(SharedRing, RefusesAHeaderThatPointsOutsideItsMemory) {
  const std::string name = unique_ring("points");
  std::uint64_t Header::*const fields[] = {
      &Header::groups_at,   &Header::group_count,    &Header::records_at,   &Header::records_bytes,
      &Header::map_text_at, &Header::map_text_bytes, &Header::memory_at,    &Header::memory_bytes,
      &Header::journals_at, &Header::journal_bits,   &Header::journal_count};
  for (const auto field : fields)
    for (const std::uint64_t value :
         {std::uint64_t{1} << 40, ~std::uint64_t{0}, std::uint64_t{5}}) {
      Header header = plan_layout(small_map(), "", 6);
      const std::uint64_t size = total_bytes(header);
      header.*field = value;
      const ForeignObject foreign{name, &header, sizeof header, size};

      EXPECT_NE(test::error_of([&] { static_cast<void>(Ring::attach(name)); }), "");
      EXPECT_FALSE(report_of(name).usable);
    }
}

TEST(SharedRing, RefusesAMapThatDoesNotMatchItsHeader) {
  const std::string name = unique_ring("other_map");
  const RingRemoval removal{name};
  const Ring ring = Ring::create(name, small_map());
  Segment::attach_shared(name)->header().map_hash ^= 1;

  EXPECT_NE(test::error_of([&] {
              static_cast<void>(Ring::attach(name));
            }).find("does not match the ring's header"),
            std::string::npos);
}

TEST(SharedRing, RefusesATableOfGroupsThatDoesNotMatchItsMap) {
  for (const std::uint32_t value : {0U, 7U, 9U, 1U << 31U, ~0U})
    for (const auto field : {&Group::base, &Group::longwords, &Group::journal, &Group::record_at}) {
      const std::string name = unique_ring("groups");
      const RingRemoval removal{name};
      const Ring ring = Ring::create(name, small_map());
      const auto segment = Segment::attach_shared(name);
      auto* table = reinterpret_cast<Group*>(reinterpret_cast<std::byte*>(&segment->header()) +
                                             segment->layout().groups_at);
      if (table->*field == value) continue;
      table->*field = value;

      EXPECT_NE(test::error_of([&] {
                  static_cast<void>(Ring::attach(name));
                }).find("its table of tear groups does not match its map"),
                std::string::npos);
    }
}

// This process runs and has mapped the ring, but is not on it.
TEST(SharedRing, CountsAProcessOnlyIfItIsOnTheRing) {
  const std::string name = unique_ring("claimed");
  const RingRemoval removal{name};
  { const Ring ring = Ring::create(name, small_map()); }
  const auto segment = Segment::attach_shared(name);
  for (Slot& slot : segment->slots().first(8)) slot = {own_claim(), 1, 0, 1, 0};

  EXPECT_EQ(report_of(name).occupants.size(), 8U);
  EXPECT_FALSE(report_of(name).in_use());
  {
    Ring ring = Ring::attach(name);
    const Node observer = ring.observe();
    EXPECT_TRUE(report_of(name).in_use());
  }
  const Ring replaced = Ring::create(name, small_map());
  EXPECT_TRUE(report_of(name).in_use());
}

class Umask : public ::testing::TestWithParam<mode_t> {};

TEST_P(Umask, LimitsWhoMayUseARing) {
  const std::string name = unique_ring("umask");
  const RingRemoval removal{name};
  const mode_t before = umask(GetParam());
  const Ring ring = Ring::create(name, small_map());
  umask(before);

  struct stat object {};
  ASSERT_EQ(stat(("/dev/shm/" + object_name(name)).c_str(), &object), 0);

  EXPECT_EQ(object.st_mode & 0777U, 0660U & ~GetParam());
}

INSTANTIATE_TEST_SUITE_P(Of, Umask, ::testing::Values(0022, 0077, 0002));

TEST(SharedRing, OfAnotherUserIsNamedAndNotOpened) {
  if (geteuid() != 0) GTEST_SKIP() << "only root can give a ring to another user";
  constexpr uid_t kOther = 54321;
  const std::string name = unique_ring("other_user");
  const RingRemoval removal{name};
  { const Ring ring = Ring::create(name, small_map()); }
  ASSERT_EQ(chown(("/dev/shm/" + object_name(name)).c_str(), kOther, kOther), 0);

  const RingReport report = report_of(name);

  EXPECT_EQ(report.other_user, "54321");
  EXPECT_EQ(report.trouble, "ring '" + name + "' belongs to user 54321");
  EXPECT_TRUE(report.foreign);
  EXPECT_EQ(test::error_of([&] { static_cast<void>(Ring::create(name, small_map())); }),
            report.trouble + "; choose another name");
}

}  // namespace
}  // namespace rths::broker
