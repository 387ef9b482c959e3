// SPDX-License-Identifier: Apache-2.0
//
// What 50 pages cost the writers of a ring, and the host. A trial of minutes.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <list>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <rths/maths/statistics.hpp>

#include "monitor/laboratory.hpp"
#include "monitor/web_socket.hpp"
#include "support/process.hpp"
#include "support/ring_maps.hpp"

namespace rths::monitor {
namespace {

using test::Laboratory;
using test::unique_ring;

constexpr int kWords = 100, kPages = 50, kRounds = 5;

/// Resident memory of a process [MiB].
double memory_of(int pid) {
  std::ifstream status{"/proc/" + std::to_string(pid) + "/status"};
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmRSS:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

/// Pages that read all that they get, in a thread of their own.
class Pages {
 public:
  Pages(std::uint16_t port, int count, const std::string& watched) {
    for (int i = 0; i < count; ++i) {
      pages_.emplace_back(port);
      EXPECT_TRUE(pages_.back().is_open());
      pages_.back().send("{\"watch\": [" + watched +
                         "], \"width_bits\": 4, \"from\": 0, \"id\": 1}");
    }
    thread_ = std::thread{[this] { read(); }};
  }
  ~Pages() {
    ends_.store(true);
    thread_.join();
  }
  Pages(const Pages&) = delete;
  Pages& operator=(const Pages&) = delete;
  [[nodiscard]] long live_frames() const { return live_frames_.load(); }

 private:
  void read() {
    for (int round = 0; !ends_.load(); ++round) {
      for (auto& page : pages_) {
        while (const auto frame = page.receive(0))
          if (frame->is_binary && frame->bytes[0] == 1) ++live_frames_;
        if (round % 100 == 0) page.send(R"({"alive": 1})");
      }
      std::this_thread::sleep_for(std::chrono::milliseconds{10});
    }
  }
  std::list<test::WebSocket> pages_;
  std::atomic<bool> ends_{false};
  std::atomic<long> live_frames_{0};
  std::thread thread_;
};

/// `rths view` of a ring.
struct View {
  explicit View(const std::string& ring)
      : running{{test::rths_command(), "view", ring, "--port", std::to_string(port)}} {
    for (int i = 0; i < 500 && test::http_get(port, "/").empty(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds{20});
  }
  std::uint16_t port = test::free_port();
  test::Running running;
};

double p99_in(Laboratory& laboratory, double seconds) {
  static_cast<void>(laboratory.durations());
  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
  return maths::quantile(laboratory.durations(), 0.99);
}

// Rounds with and without pages follow each other, so that other work of the host meets both.
TEST(Cost, OfFiftyPagesToAWriter) {
  Laboratory laboratory{unique_ring("cost"), kWords};
  std::vector<double> without, with;
  for (int round = 0; round < kRounds; ++round) {
    without.push_back(p99_in(laboratory, 10));
    const View view{unique_ring("cost")};
    const Pages pages{view.port, kPages, "0,1,2,10,11,12,13,14,15,16"};
    std::this_thread::sleep_for(std::chrono::seconds{1});
    const long frames = pages.live_frames();
    with.push_back(p99_in(laboratory, 10));
    EXPECT_GE(pages.live_frames() - frames, kPages * 10 * 20);
  }

  const double least_without = *std::min_element(without.begin(), without.end());
  const double least_with = *std::min_element(with.begin(), with.end());

  std::printf("p99 of a step: %.2f us alone, %.2f us with %d pages\n", 1e6 * least_without,
              1e6 * least_with, kPages);
  EXPECT_LE(least_with, 1.1 * least_without);
}

TEST(Cost, OfAHundredSignalsIsBounded) {
  const double seconds = std::getenv("RTHS_LONG") != nullptr ? 600 : 60;
  Laboratory laboratory{unique_ring("hundred"), kWords};
  const View view{unique_ring("hundred")};
  std::string words;
  for (int i = 0; i < kWords; ++i) words += (i == 0 ? "" : ",") + std::to_string(11 + i);
  const Pages pages{view.port, 1, words};
  std::this_thread::sleep_for(std::chrono::seconds{5});
  const double memory = memory_of(view.running.pid());
  const double processor = test::processor_time_of(view.running.pid());
  const long frames = pages.live_frames();

  std::this_thread::sleep_for(std::chrono::duration<double>(seconds));

  const double share = (test::processor_time_of(view.running.pid()) - processor) / seconds;
  const double rate = static_cast<double>(pages.live_frames() - frames) / seconds;
  const double growth = memory_of(view.running.pid()) - memory;
  std::printf("%.0f s: %.1f %% of a processor, %.1f frames/s, %.1f MiB, then %+.1f MiB\n", seconds,
              100 * share, rate, memory, growth);
  EXPECT_LE(share, 0.1);
  EXPECT_GE(rate, 25);
  EXPECT_LE(memory, 128 + 32);  // the history, and the rest
  EXPECT_LE(growth, 2);
}

}  // namespace
}  // namespace rths::monitor
