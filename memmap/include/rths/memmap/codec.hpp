// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include <rths/core/realtime.hpp>
#include <rths/memmap/map.hpp>

namespace rths::memmap {

/// Converts between the 32 bits of a longword and a value in SI units. Units convert only here.
class Codec {
 public:
  /// @throws Error if the signal's unit does not parse   @setup
  explicit Codec(const Signal& signal);

  /// Value of a longword [SI unit of the signal].   @realtime
  [[nodiscard]] double decode(std::uint32_t word) const RTHS_REALTIME {
    return scale_ * number(word) + offset_;
  }
  /// Longword for a value [SI unit of the signal]. Integers are rounded to nearest and saturate;
  /// NaN becomes 0 in an integer and stays NaN in a float.   @realtime
  [[nodiscard]] std::uint32_t encode(double value) const RTHS_REALTIME {
    const double number = (value - offset_) / scale_;
    if (type_ == WordType::F32) return std::bit_cast<std::uint32_t>(static_cast<float>(number));
    if (std::isnan(number)) return 0;
    return type_ == WordType::I32 ? signed_word(number) : unsigned_word(number);
  }
  /// Converts a value from the map's unit to SI.   @realtime
  [[nodiscard]] double to_si(double value) const RTHS_REALTIME { return scale_ * value + offset_; }
  /// Converts a value from SI to the map's unit.   @realtime
  [[nodiscard]] double from_si(double value) const RTHS_REALTIME {
    return (value - offset_) / scale_;
  }

 private:
  [[nodiscard]] double number(std::uint32_t word) const noexcept {
    if (type_ == WordType::I32) return static_cast<double>(std::bit_cast<std::int32_t>(word));
    if (type_ == WordType::U32) return static_cast<double>(word);
    return static_cast<double>(std::bit_cast<float>(word));
  }
  [[nodiscard]] static std::uint32_t signed_word(double number) noexcept {
    const double bounded =
        std::fmin(std::fmax(std::nearbyint(number), -2147483648.0), 2147483647.0);
    return std::bit_cast<std::uint32_t>(static_cast<std::int32_t>(bounded));
  }
  [[nodiscard]] static std::uint32_t unsigned_word(double number) noexcept {
    return static_cast<std::uint32_t>(
        std::fmin(std::fmax(std::nearbyint(number), 0.0), 4294967295.0));
  }

  double scale_;   ///< [SI unit per unit]
  double offset_;  ///< [SI unit]
  WordType type_;
};

}  // namespace rths::memmap
