// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <thread>

#include <rths/core/clock.hpp>
#include <rths/replicated/images.hpp>

namespace rths::launch {

/// Carries the messages of a replicated ring in real time, in a thread of this process.
class CardCarrier {
 public:
  /// @param images  used by the thread alone until this object is destroyed
  explicit CardCarrier(replicated::Images& images);
  ~CardCarrier();
  CardCarrier(const CardCarrier&) = delete;
  CardCarrier& operator=(const CardCarrier&) = delete;

  /// Sets the common time zero of the run, from which the faults count.
  void begin(TimePoint epoch) { epoch_.store(epoch.count()); }

 private:
  void run();
  replicated::Images& images_;
  std::atomic<bool> ends_{false};
  std::atomic<TimePoint::rep> epoch_{0};  ///< 0: not known yet
  std::thread thread_;                    ///< last, because it uses the members above
};

}  // namespace rths::launch
