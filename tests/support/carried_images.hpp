// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pthread.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>

#include <rths/core/clock.hpp>
#include <rths/replicated/images.hpp>

namespace rths::test {

/// A replicated ring whose messages a thread of the test carries.
class CarriedImages {
 public:
  CarriedImages(const std::string& ring, const memmap::Map& map)
      : images_{replicated::Images::create(ring, map, {})}, thread_{[this] { carry(); }} {}
  ~CarriedImages() {
    ends_ = true;
    thread_.join();
  }
  CarriedImages(const CarriedImages&) = delete;
  CarriedImages& operator=(const CarriedImages&) = delete;

  /// No message is carried while the lock is held.
  [[nodiscard]] std::unique_lock<std::mutex> pause() { return std::unique_lock{mutex_}; }

 private:
  void carry() {
    // Clients may spin: without real-time scheduling, the scans come once per time slice.
    const sched_param lowest{1};
    static_cast<void>(pthread_setschedparam(pthread_self(), SCHED_FIFO, &lowest));
    WallClock clock;
    const TimePoint start = clock.now();
    while (!ends_) {
      {
        const std::lock_guard lock{mutex_};
        images_.advance(replicated::Time{clock.now() - start});
      }
      clock.sleep_until(clock.now() + std::chrono::microseconds{50});
    }
  }
  replicated::Images images_;
  std::mutex mutex_;
  std::atomic<bool> ends_{false};
  std::thread thread_;  ///< last, because it uses the members above
};

}  // namespace rths::test
