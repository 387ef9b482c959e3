// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rths {

/// An axis of a test machine, in the order of every vector by axis. Files spell it as `name_of`
/// does.
enum class Axis : std::uint8_t { Long, Lat, Vert, Roll, Pitch, Yaw };

enum class AxisKind : std::uint8_t {
  Translational,  ///< [m], [N]
  Rotational,     ///< [rad], [N·m]
};

inline constexpr std::array kAxes{Axis::Long, Axis::Lat,   Axis::Vert,
                                  Axis::Roll, Axis::Pitch, Axis::Yaw};
inline constexpr std::array kTranslations{Axis::Long, Axis::Lat, Axis::Vert};
inline constexpr std::array kHorizontal{Axis::Long, Axis::Lat};

/// Place of an axis in `kAxes`, and in `kTranslations` and `kHorizontal` if it is there.
[[nodiscard]] constexpr std::size_t index_of(Axis axis) noexcept {
  return static_cast<std::size_t>(axis);
}
[[nodiscard]] constexpr AxisKind kind_of(Axis axis) noexcept {
  return axis < Axis::Roll ? AxisKind::Translational : AxisKind::Rotational;
}
[[nodiscard]] constexpr bool is_horizontal(Axis axis) noexcept { return axis < Axis::Vert; }

/// "long", "lat", "vert", "roll", "pitch", "yaw"
[[nodiscard]] constexpr const char* name_of(Axis axis) noexcept {
  constexpr std::array kNames{"long", "lat", "vert", "roll", "pitch", "yaw"};
  return kNames[index_of(axis)];
}
[[nodiscard]] std::vector<std::string> names_of(std::span<const Axis> axes);

/// The axis of a name; empty: there is none.
[[nodiscard]] constexpr std::optional<Axis> axis_named(std::string_view name) noexcept {
  for (const Axis axis : kAxes)
    if (name == name_of(axis)) return axis;
  return std::nullopt;
}
/// The horizontal axis of a name; empty: there is none.
[[nodiscard]] constexpr std::optional<Axis> horizontal_axis_named(std::string_view name) noexcept {
  const auto axis = axis_named(name);
  return axis && is_horizontal(*axis) ? axis : std::nullopt;
}
/// Whether a list of names has an axis.
[[nodiscard]] bool contains(std::span<const std::string> names, Axis axis);
/// Whether a list of names has long, lat.
[[nodiscard]] std::array<bool, kHorizontal.size()> horizontal_among(
    std::span<const std::string> names);

}  // namespace rths
