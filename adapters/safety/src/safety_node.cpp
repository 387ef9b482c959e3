// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/safe_machine.hpp>

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/installed_files.hpp>
#include <rths/core/text.hpp>
#include <rths/experiment/experiment.hpp>
#include <rths/memmap/codec.hpp>

namespace rths::adapters {

using namespace experiment;

namespace {

using controller::SafetyLimits;

constexpr std::int64_t kLimitsFormat = 1;
constexpr double kBeyond = 100;  // times the limit of the file: a number in another unit

struct Key {
  const char* key;
  double SafetyLimits::*member;
};
constexpr Key kKeys[] = {{"displacement_m", &SafetyLimits::displacement},
                         {"velocity_m_per_s", &SafetyLimits::velocity},
                         {"acceleration_m_per_s2", &SafetyLimits::acceleration},
                         {"jerk_m_per_s3", &SafetyLimits::jerk},
                         {"jump_m", &SafetyLimits::jump},
                         {"braking_m_per_s2", &SafetyLimits::braking},
                         {"force_N", &SafetyLimits::force},
                         {"tracking_m", &SafetyLimits::tracking},
                         {"feedback_jump_m", &SafetyLimits::feedback_jump},
                         {"force_jump_N", &SafetyLimits::force_jump},
                         {"returned_work_J", &SafetyLimits::returned_work},
                         {"negative_work_J", &SafetyLimits::negative_work}};

// A limit that the file does not state is off.
void read_values(const Config& table, const Key& key, double factor,
                 std::array<SafetyLimits, kTranslations.size()>& axes) {
  if (!table.has(key.key)) return;
  const auto values = table.numbers(key.key);
  if (values.size() < 2 || values.size() > axes.size())
    table.fail(key.key, fmt::format("{} has {} numbers, expected [long, lat] or [long, lat, vert]",
                                    key.key, values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > 0))
      table.fail(key.key,
                 fmt::format("{} is {:g}, expected a positive number", key.key, values[i]));
    axes[i].*key.member = factor * values[i];
  }
}

// A limit in mm would guard nothing.
void check_unit(const Config& file, const Config& changes, const char* key) {
  if (!file.has(key) || !changes.has(key)) return;
  const auto usual = file.numbers(key), values = changes.numbers(key);
  for (std::size_t i = 0; i < std::min(usual.size(), values.size()); ++i)
    if (values[i] > kBeyond * usual[i])
      changes.fail(key, fmt::format("{} is {:g}, and {:g} without this key: is it in another unit?",
                                    key, values[i], usual[i]));
}

// A change that states two numbers keeps the vertical limit of the file.
std::array<SafetyLimits, kTranslations.size()> read_limits(const Config& file,
                                                           const Config& table) {
  std::array<SafetyLimits, kTranslations.size()> axes;
  const double margin = table.number_in("velocity_margin", 1, 10, 1.0);
  for (const auto& key : kKeys)
    for (const Config* source : {&file, &table})
      read_values(*source, key, key.member == &SafetyLimits::velocity ? margin : 1, axes);
  if (table.has("vert_return_m_per_s"))
    axes[2].return_speed = table.number_in("vert_return_m_per_s", 1e-6, 100);
  return axes;
}

std::vector<Axis> guarded_axes(const Experiment& setup, const std::vector<MachineAxis>& words) {
  std::vector<Axis> axes;
  for (const Axis axis : kTranslations) {
    const bool is_moved = std::any_of(
        words.begin(), words.end(), [&](const auto& moved) { return moved.name == name_of(axis); });
    if (is_moved || (words.empty() && contains(setup.axes, axis))) axes.push_back(axis);
  }
  return axes;
}

SafeMachineSettings read_settings(const Config& changes, const Experiment& setup,
                                  const std::vector<MachineAxis>& words) {
  const auto file = find_file(changes, "file", "limits", "srmd");
  const Config limits_of_file = Config::load(file);
  const Config table = limits_of_file.overlaid(changes);
  if (const auto format = table.integer("safety"); format != kLimitsFormat)
    table.fail("safety", fmt::format("format is {}, this program reads {}", format, kLimitsFormat));
  static_cast<void>(table.text("title", ""));
  static_cast<void>(table.text("file", ""));
  SafeMachineSettings settings;
  auto& safety = settings.safety;
  for (const auto& key : kKeys) check_unit(limits_of_file, changes, key.key);
  const auto limits = read_limits(limits_of_file, table);
  safety.window = table.number_in("window_s", 1e-3, 1, safety.window);
  safety.response_delay = table.number_in("response_delay_s", 0, 1, safety.response_delay);
  safety.start_distance = table.number_in("start_distance_m", 1e-6, 10, safety.start_distance);
  safety.stuck = table.number_in("stuck_s", 1e-3, 10, safety.stuck);
  safety.stuck_motion = table.number_in("stuck_motion_m", 1e-6, 10, safety.stuck_motion);
  settings.watchdog = table.number_in("watchdog_s", 2e-3, 10, settings.watchdog);
  table.reject_unknown_keys();
  safety.hold = setup.stop.retreat.hold;
  safety.ramp = setup.stop.retreat.ramp;
  settings.axes = words;
  for (const Axis axis : guarded_axes(setup, words)) safety.axes.push_back(limits[index_of(axis)]);
  // Checks what the keys cannot: relations between limits.
  static_cast<void>(
      changes.placed("safety", [&] { return controller::Safety{settings.safety}.state(); }));
  return settings;
}

// The map may narrow the range of a reference.
void narrow(SafeMachineSettings& settings, const memmap::Map& map) {
  for (std::size_t i = 0; i < settings.axes.size(); ++i) {
    const auto& signal = *map.entry(map.signal(settings.axes[i].reference)).signal;
    if (!signal.range) continue;
    const memmap::Codec codec{signal};
    const double most =
        std::min(-codec.to_si(signal.range->first), codec.to_si(signal.range->second));
    auto& displacement = settings.safety.axes[i].displacement;
    displacement = std::min(displacement, most);
  }
}

}  // namespace

NodeSettings with_safety(NodeSettings machine, const Config& table, const Experiment& setup,
                         const std::vector<MachineAxis>& words) {
  machine.lacks_safety = !table.flag("enabled", true);
  const SafeMachineSettings read = read_settings(table.without("enabled"), setup, words);
  if (machine.lacks_safety) return machine;
  auto make = std::exchange(machine.make, nullptr);
  machine.longest_stop = controller::longest_stop(read.safety);
  std::size_t i = 0;
  for (const Axis axis : guarded_axes(setup, words))
    machine.safety_limits.emplace_back(name_of(axis), read.safety.axes[i++]);
  machine.make = [make = std::move(make), read](const Experiment& test,
                                                const NodeContext& context) {
    SafeMachineSettings settings = read;
    if (settings.axes.empty())
      for (const auto& axis : test.roles.axes)
        settings.axes.push_back(
            {axis.axis, axis.reference, axis.machine_displacement, axis.machine_force});
    settings.safety.period = to_seconds(context.period);
    settings.nodes = context.watched;
    narrow(settings, context.map);
    return make_safe_machine(make(test, context), settings);
  };
  return machine;
}

}  // namespace rths::adapters
