// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace trial {

/// Pseudo-random numbers that are the same on every machine: xoshiro256++ (Blackman & Vigna 2019).
class Random {
 public:
  /// Streams of one seed are independent.
  Random(std::uint64_t seed, std::uint64_t stream);

  std::uint64_t bits();
  double uniform(double low = 0, double high = 1);
  double gaussian();                     ///< mean 0, standard deviation 1
  std::size_t below(std::size_t bound);  ///< 0 … bound - 1
  bool coin() { return below(2) == 1; }

 private:
  std::array<std::uint64_t, 4> state_;
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace trial
