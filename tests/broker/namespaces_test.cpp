// SPDX-License-Identifier: Apache-2.0
//
// Processes of several containers on one ring: each container has its own process ids and clocks,
// and all share /dev/shm.
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <rths/broker/detail/process.hpp>
#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using test::RingRemoval;
using test::small_map;
using test::unique_ring;

/// Two ends of a connection that carries lines.
struct Lines {
  int in = -1, out = -1;

  void send(const std::string& line) const {
    const std::string text = line + "\n";
    if (write(out, text.data(), text.size()) != static_cast<ssize_t>(text.size())) std::abort();
  }
  /// Empty at the end of the connection.
  [[nodiscard]] std::string receive() const {
    std::string line;
    for (char c = 0; read(in, &c, 1) == 1 && c != '\n';) line += c;
    return line;
  }
};

std::array<Lines, 2> connected() {
  std::array<int, 2> there{}, back{};
  if (pipe(there.data()) != 0 || pipe(back.data()) != 0) std::abort();
  return {Lines{back[0], there[1]}, Lines{there[0], back[1]}};
}

/// A member of a ring, in a process of its own: says what came of it, then stays until SIGTERM.
template <class Become>
[[noreturn]] void live(const Lines& test, Become become) {
  sigset_t leave;
  sigemptyset(&leave);
  sigaddset(&leave, SIGTERM);
  sigprocmask(SIG_BLOCK, &leave, nullptr);
  try {
    const auto membership = become();
    test.send("ok");
    int signal = 0;
    sigwait(&leave, &signal);
  } catch (const Error& error) {
    test.send(error.what());
  }
  _exit(0);
}

struct Joined {
  Ring ring;
  Node node;
  Joined(const std::string& name, const std::string& as)
      : ring{Ring::attach(name)}, node{ring.join(as, 0)} {}
};

std::string living_nodes(const std::string& ring) {
  const auto report = inspect_ring(ring);
  if (!report) return "none";
  std::string text = report->trouble;
  for (const auto& occupant : report->occupants)
    if (occupant.alive) text += occupant.node + " ";
  return text;
}

/// The first process of a container: carries out what it is told, each in a new process.
class FirstProcess {
 public:
  FirstProcess(std::string ring, const Lines& test) : ring_{std::move(ring)}, test_{test} {}

  [[noreturn]] void run() {
    for (;;) {
      const std::string line = test_.receive();
      if (line.empty() || line == "end") _exit(0);  // its processes end with it
      const auto space = line.find(' ');
      obey(line.substr(0, space), space == std::string::npos ? "" : line.substr(space + 1));
    }
  }

 private:
  void obey(const std::string& command, const std::string& node) {
    if (command == "kill" || command == "leave") return end(node, command == "kill");
    const pid_t child = fork();
    if (child == 0) {
      if (command == "create") live(test_, [&] { return Ring::create(ring_, small_map()); });
      if (command == "join") live(test_, [&] { return std::make_unique<Joined>(ring_, node); });
      if (command == "clean") test_.send(remove_unused_ring(ring_) ? "removed" : "kept");
      if (command == "list") test_.send(living_nodes(ring_));
      _exit(0);
    }
    if (command == "create" || command == "join")
      members_[command == "create" ? "creator" : node] = child;
    else
      waitpid(child, nullptr, 0);
  }
  void end(const std::string& node, bool by_force) {
    const pid_t child = members_.at(node);
    ::kill(child, by_force ? SIGKILL : SIGTERM);
    waitpid(child, nullptr, 0);
    members_.erase(node);
    test_.send("ended");
  }

  std::string ring_;
  Lines test_;
  std::map<std::string, pid_t> members_;
};

class Container {
 public:
  explicit Container(const std::string& ring) {
    const auto ends = connected();
    ours_ = ends[0];
    std::fflush(nullptr);
    process_ = fork();
    if (process_ == 0) {
      close(ours_.in);
      close(ours_.out);
      enter(FirstProcess{ring, ends[1]}, ends[1]);
    }
    close(ends[1].in);
    close(ends[1].out);
    exists_ = ours_.receive() == "begun";
  }
  ~Container() {
    if (exists_) tell("end");
    close(ours_.out);
    waitpid(process_, nullptr, 0);
    close(ours_.in);
  }
  Container(const Container&) = delete;
  Container& operator=(const Container&) = delete;

  [[nodiscard]] bool exists() const { return exists_; }
  void tell(const std::string& command) const { ours_.send(command); }
  [[nodiscard]] std::string answer() const { return ours_.receive(); }
  [[nodiscard]] std::string ask(const std::string& command) const {
    tell(command);
    return answer();
  }

 private:
  [[noreturn]] static void enter(FirstProcess first, const Lines& test) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const bool is_apart = unshare(CLONE_NEWPID | CLONE_NEWNS | CLONE_NEWTIME) == 0;
    const pid_t child = is_apart ? fork() : -1;
    if (child == 0) {
      const bool sees_itself = mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                               mount("proc", "/proc", "proc", 0, nullptr) == 0;
      if (!sees_itself) _exit(0);
      test.send("begun");
      prctl(PR_SET_PDEATHSIG, SIGKILL);
      first.run();
    }
    close(test.in);
    close(test.out);
    waitpid(child, nullptr, 0);
    _exit(0);
  }

  Lines ours_;
  pid_t process_ = -1;
  bool exists_ = false;
};

class Namespaces : public ::testing::Test {
 protected:
  void SetUp() override {
    for (auto& container : containers) container = std::make_unique<Container>(name);
    for (const auto& container : containers)
      if (!container->exists()) GTEST_SKIP() << "SKIPPED: only root can make PID namespaces";
  }
  std::string name = unique_ring("namespaces");
  RingRemoval removal{name};
  std::array<std::unique_ptr<Container>, 3> containers;
};

TEST_F(Namespaces, ANodeOfAnotherContainerIsAliveAndNamedWithItsNamespace) {
  ASSERT_EQ(containers[0]->ask("create"), "ok");
  ASSERT_EQ(containers[0]->ask("join machine"), "ok");

  const std::string refusal = containers[1]->ask("join machine");
  EXPECT_NE(refusal.find("node 'machine' is already on the ring, as process 3 of PID namespace"),
            std::string::npos)
      << refusal;
  EXPECT_NE(containers[1]->ask("create").find("is in use by creator (process 2 of PID namespace"),
            std::string::npos);
  EXPECT_EQ(containers[1]->ask("clean"), "kept");
  EXPECT_EQ(containers[1]->ask("list"), "creator machine ");
  Ring ring = Ring::attach(name);
  EXPECT_EQ(ring.observe().presence_of(NodeId{1}).state, Presence::State::Alive);
}

// A first process that makes another namespace has the id of its child there.
TEST_F(Namespaces, AFirstProcessOfAFirstProcessHasAClaimOfItsOwn) {
  const pid_t outside = fork();
  if (outside == 0) {
    if (unshare(CLONE_NEWPID) != 0) _exit(2);
    const pid_t first = fork();
    if (first == 0) {
      const Claim parents = own_claim();
      if (unshare(CLONE_NEWPID) != 0) _exit(2);
      const pid_t nested = fork();
      if (nested == 0) _exit(getpid() == 1 && own_claim() != parents ? 0 : 1);
      int status = 0;
      waitpid(nested, &status, 0);
      _exit(getpid() == 1 && own_claim() == parents ? WEXITSTATUS(status) : 1);
    }
    int status = 0;
    waitpid(first, &status, 0);
    _exit(WEXITSTATUS(status));
  }
  int status = 0;
  ASSERT_EQ(waitpid(outside, &status, 0), outside);
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(Namespaces, ADeathIsSeenInEveryContainer) {
  ASSERT_EQ(containers[0]->ask("create"), "ok");
  ASSERT_EQ(containers[1]->ask("join machine"), "ok");
  ASSERT_EQ(containers[1]->ask("kill machine"), "ended");

  EXPECT_EQ(containers[2]->ask("list"), "creator ");
  EXPECT_EQ(containers[2]->ask("join machine"), "ok");
  ASSERT_EQ(containers[0]->ask("kill creator"), "ended");
  ASSERT_EQ(containers[2]->ask("leave machine"), "ended");
  EXPECT_EQ(containers[1]->ask("clean"), "removed");
  EXPECT_EQ(containers[1]->ask("list"), "none");
}

/// Orders that several containers carry out at the same time.
class RandomOrders {
 public:
  RandomOrders(std::array<std::unique_ptr<Container>, 3>& containers, std::uint32_t seed)
      : containers_{containers}, random_{seed} {}

  /// Each container gets one order; then the ring must have all that live, each node once.
  void round() {
    std::vector<Order> orders;
    for (std::size_t at = 0; at < containers_.size(); ++at) orders.push_back(order_for(at));
    for (const auto& order : orders) containers_[order.container]->tell(order.text());
    for (const auto& order : orders) note(order, containers_[order.container]->answer());
    check();
  }
  void end_all() {
    for (const auto& [node, at] : living_) EXPECT_EQ(containers_[at]->ask("kill " + node), "ended");
    living_.clear();
  }

 private:
  struct Order {
    std::size_t container;
    std::string verb, node;
    [[nodiscard]] std::string text() const { return node.empty() ? verb : verb + " " + node; }
  };
  static constexpr std::array<const char*, 2> kNodes{"machine", "controller"};

  [[nodiscard]] Order order_for(std::size_t at) {
    const auto choice = random_() % 8;
    const std::string node = kNodes[random_() % kNodes.size()];
    if (choice < 3 && !has(at, node)) return {at, "join", node};
    if (choice == 3 && !has(at, "creator")) return {at, "create", ""};
    for (const std::string& own : {node, std::string{"creator"}})
      if (choice > 5 && has(at, own)) return {at, random_() % 2 == 0 ? "kill" : "leave", own};
    return {at, "clean", ""};
  }
  [[nodiscard]] bool has(std::size_t at, const std::string& node) const {
    return living_.contains({node, at});
  }
  void note(const Order& order, const std::string& answer) {
    const std::string node = order.verb == "create" ? "creator" : order.node;
    if (order.verb == "kill" || order.verb == "leave")
      living_.erase({node, order.container});
    else if (answer == "ok")
      living_.insert({node, order.container});
    history_ += fmt::format("{}: {} -> {}\n", order.container, order.text(), answer);
  }
  void check() {
    std::multiset<std::string> expected, found;
    for (const auto& [node, at] : living_) expected.insert(node);
    const std::string listed = containers_[random_() % containers_.size()]->ask("list");
    for (std::size_t begin = 0; begin < listed.size() && listed != "none";) {
      const auto space = listed.find(' ', begin);
      found.insert(listed.substr(begin, space - begin));
      begin = space + 1;
    }
    EXPECT_EQ(found, expected) << history_;
    for (const auto& node : kNodes) EXPECT_LE(found.count(node), 1U) << history_;
  }

  std::array<std::unique_ptr<Container>, 3>& containers_;
  std::minstd_rand random_;
  std::set<std::pair<std::string, std::size_t>> living_;  ///< node and container
  std::string history_;
};

TEST_F(Namespaces, FiftyRandomOrdersNeverGiveTwoWritersOrRemoveALivingRing) {
  for (std::uint32_t seed = 1; seed <= 50 && !HasFailure(); ++seed) {
    SCOPED_TRACE(fmt::format("seed {}", seed));
    RandomOrders orders{containers, seed};
    for (int round = 0; round < 12 && !HasFailure(); ++round) orders.round();
    orders.end_all();
    static_cast<void>(containers[0]->ask("clean"));
  }
}

}  // namespace
}  // namespace rths::broker
