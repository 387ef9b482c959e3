// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <rths/core/axis.hpp>
#include <rths/core/constants.hpp>
#include <rths/core/error.hpp>
#include <rths/experiment/check.hpp>
#include <rths/sim/oscillator.hpp>

#include "tables.hpp"

namespace rths::experiment {
namespace {

// Horizontal peaks of strong records are 0.1 to 1 g, and hardly ever 2 g.
constexpr double kMostAcceleration = 2 * kStandardGravity;   // [m/s²]
constexpr double kUsualAcceleration = 0.3;                   // [g]
constexpr double kLongestStep = 0.1;                         // of a record [s]
constexpr double kMostVelocity = 5, kMostDisplacement = 10;  // [m/s], [m]
// Velocity over acceleration: 0.05 s on rock to 0.3 s near a fault.
constexpr double kLongestPulse = 0.35;  // [s]

/// A unit of acceleration, and how many of it make 1 g.
struct LikelyUnit {
  const char* name;
  double per_g;
};
constexpr LikelyUnit kUnits[] = {{"m/s²", kStandardGravity},
                                 {"% of g", 100},
                                 {"gal (cm/s²)", 100 * kStandardGravity},
                                 {"mm/s²", 1000 * kStandardGravity}};

const LikelyUnit& likely_unit(double peak_in_g) {
  const auto distance = [&](const LikelyUnit& unit) {
    return std::abs(std::log(peak_in_g / unit.per_g / kUsualAcceleration));
  };
  return *std::min_element(
      std::begin(kUnits), std::end(kUnits),
      [&](const LikelyUnit& a, const LikelyUnit& b) { return distance(a) < distance(b); });
}

bool is_about(double value, double other) { return std::abs(value - other) <= 0.005 * other; }

// A scale that would convert a record which is in g already.
std::optional<std::string> conversion_of(double scale, double unscaled_in_g) {
  for (const LikelyUnit& unit : kUnits) {
    if (is_about(scale, unit.per_g))
      return fmt::format("scale is {:g}, the factor from {} to g the wrong way: the record is in g",
                         scale, unit.name);
    const bool is_in_g_already = unscaled_in_g < 2 && unit.per_g > 100;
    if (is_about(scale, 1 / unit.per_g) && is_in_g_already)
      return fmt::format("scale is {:g}, as for a record in {}, but its peak is {:.3g}: it is in g",
                         scale, unit.name, unscaled_in_g);
  }
  return std::nullopt;
}

// A unit in the heading is converted by the reader; a scale that converts it too is refused.
void check_source(const Config& table, const sim::MotionSource& source, double scale) {
  constexpr double kMostScale = 3;  // of a record that the scale converts
  if (source.per_g == 1 || scale == 0 || scale * source.per_g > kMostScale) return;
  table.fail("scale", fmt::format("scale is {:g}, but '{}' states {}, which is converted to g: "
                                  "expected scale = {:.3g}",
                                  scale, source.heading, source.unit, scale * source.per_g));
}

// Channels of one recorder begin together, but may end a few samples apart.
void remark_lengths(const sim::GroundMotion& motion, std::vector<std::string>& remarks) {
  std::size_t least = motion.long_acceleration.size();
  for (const auto& source : motion.sources) least = std::min(least, source.samples);
  if (least < motion.long_acceleration.size() && !motion.sources.empty())
    remarks.push_back(fmt::format(
        "the channels of {} have {} to {} samples; zeros follow the shorter ones",
        motion.sources[0].file.filename().string(), least, motion.long_acceleration.size()));
}

// One component may drive both axes on purpose, or by mistake.
void remark_shared(const sim::GroundMotion& motion, const std::vector<std::string>& axes,
                   std::vector<std::string>& remarks) {
  if (axes.size() < 2 || motion.sources.size() < 2) return;
  const auto &one = motion.sources[0], &other = motion.sources[1];
  if (one.file == other.file && one.has_one_column && other.has_one_column)
    remarks.push_back(
        fmt::format("{} has one component, which drives both axes", one.file.filename().string()));
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

void check_peak(const Config& table, double peak, double scale) {
  if (peak == 0) return;
  const double unscaled = scale > 0 ? peak / scale : 0;
  if (table.has("scale") && scale > 0)
    if (const auto wrong = conversion_of(scale, unscaled / kStandardGravity))
      table.fail("scale", *wrong);
  if (std::min(peak, scale > 0 ? unscaled : peak) <= kMostAcceleration) return;
  const LikelyUnit& unit = likely_unit(unscaled / kStandardGravity);
  table.fail("file",
             fmt::format("peak ground acceleration is {:.4g} g, expected at most {:g} g: is "
                         "the record in {}? Then expected scale = {:.6g}",
                         peak / kStandardGravity, kMostAcceleration / kStandardGravity, unit.name,
                         std::min(scale, 1.0) / unit.per_g));
}

std::string text_of(const MotionSizes& sizes) {
  return fmt::format("{:.3g} g, {:.3g} m/s, {:.3g} m", sizes.acceleration / kStandardGravity,
                     sizes.velocity, sizes.displacement);
}

// The unit of which a key's number may be, if it is a thousandth or thousand times too large.
struct Confused {
  const char* ending;
  const char *small, *large;  ///< unit whose numbers are small or large
};
constexpr Confused kConfused[] = {{"_N_per_m", "kN/m", "N/km"},
                                  {"_N_s_per_m", "kN·s/m", "mN·s/m"},
                                  {"_N", "kN", "mN"},
                                  {"_kg", "t", "g"},
                                  {"_Pa", "kPa", "mPa"},
                                  {"_m", "km", "mm"},
                                  {"_s", "ks", "ms"}};

const Confused* confused(const std::string& key) {
  const auto found = std::find_if(std::begin(kConfused), std::end(kConfused),
                                  [&](const Confused& unit) { return key.ends_with(unit.ending); });
  return found == std::end(kConfused) ? nullptr : &*found;
}

std::vector<double> numbers_of(const Config& table, const std::string& key) {
  try {
    return table.is_array(key) ? table.numbers(key) : std::vector{table.number(key)};
  } catch (const Error&) {
    return {};  // its reader refuses it
  }
}

void check_number(const Config& changes, const Config& original, const std::string& key) {
  constexpr double kLeast = 300, kMost = 3000;  // around the factor 1000
  const Confused* unit = confused(key);
  const bool is_offset = key.find("offset") != std::string::npos;
  if (unit == nullptr || !original.has(key) || is_offset) return;
  const auto now = numbers_of(changes, key), before = numbers_of(original, key);
  for (std::size_t i = 0; i < std::min(now.size(), before.size()); ++i) {
    if (now[i] == 0 || before[i] == 0) continue;
    const double factor = std::abs(now[i] / before[i]);
    const bool is_small = factor > 1 / kMost && factor < 1 / kLeast;
    if (!is_small && !(factor > kLeast && factor < kMost)) continue;
    changes.fail(key, fmt::format("{} is {:g}, and {:g} without this key: is it in {}?", key,
                                  now[i], before[i], is_small ? unit->small : unit->large));
  }
}

}  // namespace

MotionSizes sizes_of(const std::vector<double>& acceleration, double time_step) {
  // Relative to a slow oscillator, the ground moves as it does, but without drift.
  constexpr double kPeriod = 10, kDamping = 0.7;  // [s], [-]
  const auto step = sim::oscillator_step(2 * std::numbers::pi / kPeriod, kDamping, time_step);
  sim::Oscillator slow;
  MotionSizes sizes{largest(acceleration), 0, 0};
  for (std::size_t i = 1; i < acceleration.size(); ++i) {
    slow.advance(step, acceleration[i - 1], acceleration[i]);
    sizes.velocity = std::max(sizes.velocity, std::abs(slow.v));
    sizes.displacement = std::max(sizes.displacement, std::abs(slow.x));
  }
  return sizes;
}

std::vector<std::string> check_motion(const Config& table, const sim::GroundMotion& motion,
                                      const std::vector<std::string>& axes) {
  if (motion.time_step > kLongestStep)
    table.fail("file", fmt::format("the time step is {:g} s, expected at most {:g} s: is the time "
                                   "in ms, or a number of samples?",
                                   motion.time_step, kLongestStep));
  const double scale = table.number("scale", 1.0);
  for (const auto& source : motion.sources) check_source(table, source, scale);
  MotionSizes most;
  std::vector<std::string> remarks;
  remark_shared(motion, axes, remarks);
  remark_lengths(motion, remarks);
  for (const auto* component :
       {&motion.long_acceleration, &motion.lat_acceleration, &motion.vert_acceleration}) {
    const MotionSizes sizes = sizes_of(*component, motion.time_step);
    check_peak(table, sizes.acceleration, scale);
    if (sizes.acceleration > most.acceleration) most = sizes;
  }
  if (most.velocity > kMostVelocity || most.displacement > kMostDisplacement)
    table.fail("file",
               fmt::format("the peaks of the ground are {}, expected at most {:g} m/s and "
                           "{:g} m: is the time step, {:g} s, too long?",
                           text_of(most), kMostVelocity, kMostDisplacement, motion.time_step));
  if (most.velocity > kLongestPulse * most.acceleration)
    remarks.push_back(
        fmt::format("the peaks of the ground, {}, are those of a slow motion: is the "
                    "time step, {:g} s, twice the true one?",
                    text_of(most), motion.time_step));
  if (most.acceleration == 0) remarks.emplace_back("the ground motion is zero");
  return remarks;
}

CheckedMotion check_motion_file(const std::filesystem::path& file) {
  Config table;
  table.put("file", std::filesystem::absolute(file).string());
  try {
    MotionFiles files;
    const auto& read = files.at(std::filesystem::absolute(file));
    CheckedMotion checked;
    for (std::size_t channel = 1; channel <= (read.has_channels ? read.columns.size() : 1);
         ++channel) {
      if (read.has_channels)
        for (const char* key : {"column_long", "column_lat"})
          table.set(key, std::to_string(channel));
      for (auto& remark : check_motion(table, read_motion(table, files), {name_of(Axis::Long)}))
        checked.remarks.push_back(std::move(remark));
    }
    checked.file = read;
    return checked;
  } catch (const Error& error) {
    // The table itself has no place.
    const std::string problem = error.what();
    throw Error{problem.starts_with(":") ? file.string() + problem : problem};
  }
}

void check_units(const Config& changes, const Config& original) {
  for (const auto& key : changes.keys())
    if (!changes.is_table(key))
      check_number(changes, original, key);
    else if (original.is_table(key))
      check_units(changes.table(key), original.table(key));
}

}  // namespace rths::experiment
