// SPDX-License-Identifier: Apache-2.0
#include "follower.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <pybind11/pybind11.h>

#include <rths/core/clock.hpp>

namespace rths::python {
namespace {

constexpr double kLongestTimeout = 1e6;                            // [s]
constexpr Duration kSignalPeriod = std::chrono::milliseconds{50};  // between checks for Ctrl-C

TimePoint deadline_after(double timeout_s) {
  if (!(timeout_s >= 0 && timeout_s <= kLongestTimeout))
    throw Error{fmt::format("timeout_s is {}, expected 0 to {} s", timeout_s, kLongestTimeout)};
  return WallClock{}.now() + from_seconds(timeout_s);
}

/// Marks a follower as waiting. Changed only while the global lock is held.
class Waiting {
 public:
  explicit Waiting(bool& flag) : flag_{flag} {
    if (flag) throw Error{"another thread waits for this follower, expected one for each thread"};
    flag = true;
  }
  ~Waiting() { flag_ = false; }
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

 private:
  bool& flag_;
};

}  // namespace

std::optional<testkit::Change> Follower::wait(double timeout_s) {
  const TimePoint deadline = deadline_after(timeout_s);
  const Waiting waiting{is_waiting_};
  const WallClock clock;
  for (;;) {
    broker::Write write;
    Status status = Status::Late;
    {
      const pybind11::gil_scoped_release release;
      status = follower_->wait(std::min(deadline, clock.now() + kSignalPeriod), write);
    }
    if (status == Status::Ok) return follower_->change_of(write);
    if (status == Status::LimitExceeded)
      throw LostWrites{"this follower was more than a journal behind: some writes were lost"};
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set{};
    if (clock.now() >= deadline) return std::nullopt;
  }
}

}  // namespace rths::python
