// SPDX-License-Identifier: Apache-2.0
//
// Rings that another program has damaged, or damages while they are used. No function that the
// commands use may crash, or take longer than two seconds.
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <ctime>
#include <list>
#include <new>
#include <thread>

#include <gtest/gtest.h>

#include <rths/broker/follow.hpp>
#include <rths/broker/watch.hpp>

#include "broker/src/segment.hpp"
#include "damage.hpp"
#include "support/long_run.hpp"
#include "support/ring_maps.hpp"

namespace rths::broker {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using std::chrono::steady_clock;

/// Calls the functions of the commands with a ring of this name.
class Commands {
 public:
  explicit Commands(std::string name) : name_{std::move(name)} {}

  void run_all() const {
    for (const auto command : {&Commands::doctor, &Commands::dump, &Commands::who, &Commands::watch,
                               &Commands::follow, &Commands::send, &Commands::run}) {
      try {
        (this->*command)();
      } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch)
        // An error is the right answer to most damage.
      }
    }
  }

 private:
  void doctor() const { static_cast<void>(inspect_ring(name_)); }
  void dump() const {
    Ring ring = Ring::attach(name_);
    const Node node = ring.observe();
    for (const auto& entry : ring.map().signals())
      static_cast<void>(node.read(entry.signal->offset));
    for (const auto& partition : ring.map().partitions()) {
      std::vector<std::uint32_t> words(partition.longwords);
      if (partition.tear_group)
        static_cast<void>(node.read_group(ring.tear_group(partition.name), words));
    }
  }
  void who() const {
    Ring ring = Ring::attach(name_);
    for (const auto& entry : ring.map().signals())
      static_cast<void>(ring.last_write(entry.signal->offset));
  }
  void watch() const {
    Ring ring = Ring::attach(name_);
    Watch watch{ring};
    for (int look = 0; look < 3; ++look) static_cast<void>(watch.look());
  }
  void follow() const {
    Ring ring = Ring::attach(name_);
    Waiter waiter = ring.wait_for({});
    Write write;
    for (int i = 0; i < 100; ++i) static_cast<void>(waiter.wait(TimePoint{0}, write));
  }
  void send() const {
    Ring ring = Ring::attach(name_);
    for (const auto& node : ring.map().description().nodes) {
      Node writer = ring.join(node.name, 0);
      for (const auto& partition : ring.map().partitions()) {
        const std::vector<std::uint32_t> words(partition.longwords, 7);
        static_cast<void>(partition.tear_group
                              ? writer.write_group(ring.tear_group(partition.name), words)
                              : writer.write(partition.base, 7));
      }
      writer.beat();
    }
  }
  void run() const {
    const Ring ring = Ring::create(name_, test::small_map());
    static_cast<void>(remove_ring(name_));
  }
  std::string name_;
};

/// Overwrites bytes of a ring's object, and changes its size, until it is destroyed.
class Disturber {
 public:
  Disturber(const std::string& ring, const RingImage& image, std::uint64_t seed)
      : thread_{[this, ring, image, seed] { disturb(ring, image, seed); }} {}
  ~Disturber() {
    done_.store(true);
    thread_.join();
  }
  Disturber(const Disturber&) = delete;
  Disturber& operator=(const Disturber&) = delete;

 private:
  void disturb(const std::string& ring, const RingImage& image, std::uint64_t seed) const {
    std::mt19937_64 random{seed};
    const int file = shm_open(("/" + object_name(ring)).c_str(), O_RDWR | O_CLOEXEC, 0);
    while (file >= 0 && !done_.load()) {
      const std::uint64_t bits = random();
      const auto at = static_cast<off_t>(random() % image.bytes.size());
      if (bits % 64 == 0)
        static_cast<void>(!ftruncate(file, at));
      else if (bits % 64 < 16)
        static_cast<void>(!ftruncate(file, static_cast<off_t>(image.size)));
      else if (bits % 64 < 24)
        static_cast<void>(!pwrite(file, image.bytes.data(), image.bytes.size(), 0));
      else
        static_cast<void>(!pwrite(file, &bits, bits % 8 + 1, at));
    }
    if (file >= 0) close(file);
  }
  std::atomic<bool> done_{false};
  std::thread thread_;
};

/// Progress of a process that tries seeds, in memory that it shares with the test.
struct Progress {
  std::atomic<std::uint64_t> seed{0};
  std::atomic<std::int64_t> processor_time{0};  ///< at the begin of the seed [ns]
};

std::int64_t processor_time_of_process(clockid_t clock) {
  timespec time{};
  clock_gettime(clock, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

// Some commands wait for a creator, so several processes try seeds at once.
constexpr std::uint64_t kProcesses = 8;

[[noreturn]] void try_seeds(const RingImage& image, const std::string& name, std::uint64_t end,
                            Progress& progress) {
  on_lost_memory(OnLostMemory::Continue);
  const Commands commands{name};
  for (; progress.seed.load() < end; progress.seed.fetch_add(kProcesses)) {
    progress.processor_time.store(processor_time_of_process(CLOCK_PROCESS_CPUTIME_ID));
    const std::uint64_t seed = progress.seed.load();
    install(damaged(image, seed), name);
    if (seed / kProcesses % 8 == 0) {
      const Disturber disturber{name, image, seed};
      commands.run_all();
    } else {
      commands.run_all();
    }
  }
  _exit(0);
}

struct Outcome {
  std::uint64_t tried = 0;
  std::vector<std::uint64_t> crashed, hung;
};

/// Tries every kProcesses-th seed in a child process: a new one after each that crashed or hung.
class Tester {
 public:
  Tester(const RingImage& image, std::uint64_t first, std::uint64_t end, Outcome& outcome)
      : image_{image},
        removal_{test::unique_ring("damaged") + "_" + std::to_string(first)},
        first_{first},
        end_{end},
        outcome_{outcome} {
    progress_->seed.store(first);
    start();
  }
  Tester(const Tester&) = delete;
  Tester& operator=(const Tester&) = delete;

  /// @returns false if all seeds are tried
  [[nodiscard]] bool look() {
    int status = 0;
    if (waitpid(child_, &status, WNOHANG) != 0) {
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) {
        outcome_.tried += (progress_->seed.load() - first_) / kProcesses;
        return false;
      }
      outcome_.crashed.push_back(progress_->seed.load());
      return start_next();
    }
    count();
    if (!is_hanging()) return true;
    outcome_.hung.push_back(seed_);
    kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    return start_next();
  }

 private:
  static constexpr std::size_t kMostFailures = 10;

  void start() {
    progress_->processor_time.store(0);
    seed_ = progress_->seed.load();
    since_ = steady_clock::now();
    child_ = fork();
    if (child_ == 0) try_seeds(image_, removal_.name, end_, *progress_);
    clock_getcpuclockid(child_, &clock_);
  }
  [[nodiscard]] bool start_next() {
    progress_->seed.fetch_add(kProcesses);
    if (outcome_.crashed.size() + outcome_.hung.size() >= kMostFailures) return false;
    start();
    return true;
  }
  void count() {
    const std::uint64_t seed = progress_->seed.load();
    if (seed == seed_) return;
    seed_ = seed;
    since_ = steady_clock::now();
  }
  // A loaded host delays a process, so time counts as its own if it computes.
  [[nodiscard]] bool is_hanging() const {
    const auto computed = processor_time_of_process(clock_) - progress_->processor_time.load();
    return computed > std::chrono::nanoseconds{seconds{2}}.count() ||
           steady_clock::now() - since_ > seconds{60};
  }

  const RingImage& image_;
  test::RingRemoval removal_;
  std::uint64_t first_, end_;
  Outcome& outcome_;
  Progress* progress_ = new (mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE,
                                  MAP_SHARED | MAP_ANONYMOUS, -1, 0)) Progress;
  pid_t child_ = -1;
  clockid_t clock_{};
  std::uint64_t seed_ = 0;
  steady_clock::time_point since_;
};

Outcome try_all(std::uint64_t count) {
  Outcome outcome;
  const RingImage image = ring_to_damage();
  std::list<Tester> testers;
  for (std::uint64_t first = 0; first < kProcesses; ++first)
    testers.emplace_back(image, first, count, outcome);
  while (!testers.empty()) {
    std::this_thread::sleep_for(milliseconds{5});
    testers.remove_if([](Tester& tester) { return !tester.look(); });
  }
  return outcome;
}

std::string listed(const std::vector<std::uint64_t>& seeds) {
  std::string text = "seeds";
  for (const auto seed : seeds) text += " " + std::to_string(seed);
  return text;
}

TEST(DamagedRing, CrashesNoCommandAndDelaysNone) {
  const std::uint64_t count = test::is_long() ? 100'000 : 400;

  const Outcome outcome = try_all(count);

  EXPECT_TRUE(outcome.crashed.empty()) << listed(outcome.crashed);
  EXPECT_TRUE(outcome.hung.empty()) << listed(outcome.hung);
  EXPECT_EQ(outcome.tried, count);
}

// Without damage, the trials' functions find nothing wrong: they reach all code behind the checks.
TEST(DamagedRing, IsUsableBeforeTheDamage) {
  const std::string name = test::unique_ring("undamaged");
  const test::RingRemoval removal{name};
  install(ring_to_damage(), name);

  const auto report = inspect_ring(name);

  ASSERT_TRUE(report.has_value());
  EXPECT_TRUE(report->usable) << report->trouble;
  EXPECT_FALSE(report->in_use());
  ASSERT_EQ(report->occupants.size(), 1U);
  EXPECT_EQ(Ring::attach(name).last_write(LongwordOffset{1}).node, "machine");
}

}  // namespace
}  // namespace rths::broker
