// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>
#include <vector>

#include <rths/core/realtime.hpp>

#include <rths/fmi/model_description.hpp>

namespace rths::fmi {

/// si = scale·value + offset.
struct Conversion {
  double scale = 1, offset = 0;

  [[nodiscard]] double si(double value) const { return scale * value + offset; }
};

/// Variables of one type, which one call of the FMU reads or writes.
struct Exchange {
  Type type = Type::Float64;
  std::vector<std::uint32_t> references;
  std::vector<std::size_t> indices;  ///< in the adapter's inputs or outputs
  std::vector<Conversion> conversions;
  std::vector<std::uint64_t> memory;  ///< a word for each value, of whatever type

  void add(std::uint32_t reference, std::size_t index, Conversion conversion) {
    references.push_back(reference);
    indices.push_back(index);
    conversions.push_back(conversion);
    memory.push_back(0);
  }
  [[nodiscard]] std::size_t size() const { return references.size(); }
  template <class T>
  [[nodiscard]] T* values() noexcept {
    static_assert(sizeof(T) <= sizeof(std::uint64_t));
    return reinterpret_cast<T*>(memory.data());
  }
};

/// Exchanges of one direction, one for each type.
class Exchanges {
 public:
  void add(const Variable& variable, std::size_t index, Conversion conversion) {
    for (auto& exchange : all_)
      if (exchange.type == variable.type)
        return exchange.add(variable.reference, index, conversion);
    all_.emplace_back().type = variable.type;
    all_.back().add(variable.reference, index, conversion);
  }
  [[nodiscard]] auto begin() noexcept { return all_.begin(); }
  [[nodiscard]] auto end() noexcept { return all_.end(); }

 private:
  std::vector<Exchange> all_;
};

/// A number as a value of an FMU's type; the nearest one, if it is outside the type's range.
/// @returns whether it is inside   @realtime
template <class T>
bool convert(double number, T& value) RTHS_REALTIME {
  if constexpr (std::is_floating_point_v<T>) {
    value = static_cast<T>(number);
    return true;
  } else {
    using Limits = std::numeric_limits<T>;
    const double whole = std::nearbyint(number);
    const bool is_low = whole < static_cast<double>(Limits::min());
    // 2⁶³ − 1 rounds up as a double.
    const bool is_high = whole >= static_cast<double>(Limits::max());
    value = is_low ? Limits::min() : (is_high ? Limits::max() : static_cast<T>(whole));
    return !is_low && !(whole > static_cast<double>(Limits::max()));
  }
}

/// Fills the values of an exchange from numbers in SI. Truth is any number but 0.
/// @returns whether all are inside the range of the type   @realtime
template <class T>
bool take(Exchange& exchange, std::span<const double> numbers, bool is_truth) RTHS_REALTIME {
  bool fits = true;
  T* values = exchange.values<T>();
  for (std::size_t i = 0; i < exchange.size(); ++i) {
    const auto [scale, offset] = exchange.conversions[i];
    const double number = (numbers[exchange.indices[i]] - offset) / scale;
    if (is_truth)
      values[i] = static_cast<T>(number != 0);
    else
      fits = convert(number, values[i]) && fits;
  }
  return fits;
}

/// Before the FMU gives its values: a real one that it does not give is not a number.   @realtime
template <class T>
void forget(Exchange& exchange) RTHS_REALTIME {
  if constexpr (std::is_floating_point_v<T>)
    for (std::size_t i = 0; i < exchange.size(); ++i)
      exchange.values<T>()[i] = std::numeric_limits<T>::quiet_NaN();
}

/// Writes the values of an exchange as numbers in SI.   @realtime
template <class T>
void give(Exchange& exchange, double* numbers, bool is_truth) RTHS_REALTIME {
  const T* values = exchange.values<T>();
  for (std::size_t i = 0; i < exchange.size(); ++i) {
    const auto [scale, offset] = exchange.conversions[i];
    const auto number =
        is_truth ? static_cast<double>(values[i] != T{}) : static_cast<double>(values[i]);
    numbers[exchange.indices[i]] = number * scale + offset;
  }
}

}  // namespace rths::fmi
