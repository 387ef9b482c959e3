// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace rths::adapters {

/// Accelerations of floors that a script sends after each of its steps, through a pipe.
class FloorFeed {
 public:
  /// @throws Error if there is no pipe   @setup
  explicit FloorFeed(std::size_t floors);
  ~FloorFeed();
  FloorFeed(const FloorFeed&) = delete;
  FloorFeed& operator=(const FloorFeed&) = delete;

  /// The end that the script writes to; closed here once it has started.
  [[nodiscard]] int writing_end() const { return writing_; }
  void close_writing_end();
  /// Takes all steps that have arrived.
  void receive();

  /// Of the last step: its time [s], whether accelerations along a degree of freedom, from 1, are
  /// relative to the ground, and these, long and lat of each floor [units of the script].
  [[nodiscard]] double time() const { return step_[kTime]; }
  [[nodiscard]] bool is_relative(int dof) const {
    return (static_cast<unsigned>(step_[kShaken]) >> static_cast<unsigned>(dof) & 1U) != 0;
  }
  [[nodiscard]] std::span<const double> accelerations() const {
    return std::span{step_}.subspan(kFirst);
  }

 private:
  enum Place : std::size_t { kTime, kShaken, kFirst };
  int reading_ = -1, writing_ = -1;
  std::vector<double> step_, next_;
  std::size_t filled_ = 0;  ///< of `next_` [B]
};

}  // namespace rths::adapters
