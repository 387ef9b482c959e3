// SPDX-License-Identifier: Apache-2.0
#include <rths/controller/safety.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rths/core/error.hpp>

namespace rths::controller {
namespace {

constexpr std::size_t kWindows = 3;  // of the past that the jerk needs

constexpr Require kRequireSafety{"safety"};

void check(const SafetyLimits& limits, const SafetySettings& settings) {
  const double values[] = {limits.displacement,  limits.velocity,      limits.acceleration,
                           limits.jerk,          limits.jump,          limits.force,
                           limits.tracking,      limits.feedback_jump, limits.force_jump,
                           limits.returned_work, limits.negative_work, limits.return_speed};
  for (const double value : values)
    kRequireSafety(value > 0, "a limit", value, "a positive number");
  kRequireSafety(limits.braking > 0 && std::isfinite(limits.braking), "braking", limits.braking,
                 "a positive number");
  kRequireSafety(limits.braking <= limits.acceleration, "braking", limits.braking,
                 "at most the limit of acceleration");
  if (std::isfinite(limits.return_speed)) {
    kRequireSafety(limits.return_speed <= limits.velocity, "return_speed", limits.return_speed,
                   "at most the limit of velocity");
    kRequireSafety(std::isfinite(limits.displacement), "displacement", limits.displacement,
                   "a limit beside return_speed");
  }
  const bool has_windows = std::isfinite(limits.acceleration) || std::isfinite(limits.jerk);
  kRequireSafety(std::isfinite(limits.velocity) || !has_windows, "velocity", limits.velocity,
                 "a limit beside those of acceleration and jerk");
  kRequireSafety(
      limits.velocity * settings.period <= limits.jump || !std::isfinite(limits.velocity), "jump",
      limits.jump, "at least the velocity over one period");
}

SafetySettings checked(const SafetySettings& settings) {
  kRequireSafety.positive("period", settings.period);
  kRequireSafety(settings.window >= settings.period && settings.window <= 1, "window",
                 settings.window, "a period to 1 s");
  kRequireSafety(settings.response_delay >= 0 &&
                     settings.response_delay < kWindows * settings.window - settings.period,
                 "response_delay", settings.response_delay, "less than three windows");
  kRequireSafety(settings.start_distance > 0, "start_distance", settings.start_distance,
                 "a positive number");
  kRequireSafety(settings.stuck >= settings.period, "stuck", settings.stuck, "at least a period");
  kRequireSafety(settings.hold >= 0 && settings.ramp > 0, "ramp", settings.ramp,
                 "a positive number");
  if (settings.axes.empty()) throw Error{"safety: no axis, expected at least one"};
  for (const auto& limits : settings.axes) check(limits, settings);
  return settings;
}

std::size_t periods(double time, double period) {
  return static_cast<std::size_t>(std::lround(time / period));
}

bool beyond(double value, double limit) noexcept { return !(std::abs(value) <= limit); }

// Shortest duration D of a cosine bell of height h inside the limits: it has at most the velocity
// π h/2D and the acceleration π² h/2D².
double ramp_over(double height, const SafetyLimits& limits, double window) noexcept {
  const double square = std::numbers::pi * std::numbers::pi * height / 2;
  return std::max({std::numbers::pi * height / (2 * limits.velocity),
                   std::sqrt(square / limits.acceleration),
                   std::sqrt(2 * square / (window * limits.jerk))});
}

}  // namespace

double longest_stop(const SafetySettings& settings) {
  constexpr double kLongest = 120;  // [s]
  double stop = settings.hold, ramp = settings.ramp;
  for (const SafetyLimits& limits : settings.axes) {
    const double height = 2 * limits.displacement;  // from one end to a rest position at the other
    const double braking = std::isfinite(limits.return_speed) ? height / limits.return_speed
                                                              : limits.velocity / limits.braking;
    stop = std::max(stop, braking + static_cast<double>(kWindows) * settings.window);
    ramp = std::max(ramp, ramp_over(height, limits, settings.window));
  }
  return std::min(stop + ramp, kLongest);
}

SafetyCauseText to_text(SafetyCause cause) noexcept {
  static constexpr SafetyCauseText kTexts[] = {
      {"none", ""},
      {"command", "m"},
      {"displacement of the command and a stop from it", "m"},
      {"velocity of the command", "m/s"},
      {"acceleration of the command", "m/s2"},
      {"jerk of the command", "m/s3"},
      {"jump of the command", "m"},
      {"distance of the first command from the platen", "m"},
      {"feedback", ""},
      {"measured displacement", "m"},
      {"measured velocity", "m/s"},
      {"jump of the measured displacement", "m"},
      {"expected motion while the measured displacement is stuck", "m"},
      {"measured force", "N"},
      {"jump of the measured force", "N"},
      {"expected motion while the measured force is stuck", "m"},
      {"work returned by the specimen, by the sign of the force,", "J"},
      {"tracking error", "m"},
      {"silence", "s"},
      {"number of invalid values", ""},
  };
  return kTexts[static_cast<std::size_t>(cause)];
}

Safety::Safety(const SafetySettings& settings)
    : settings_{checked(settings)},
      window_{periods(settings.window, settings.period)},
      delay_{periods(settings.response_delay, settings.period)},
      paths_(settings.axes.size()),
      sensors_(settings.axes.size()),
      references_(settings.axes.size()) {
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    const SafetyLimits& limits = settings.axes[axis];
    const Stop worst{2 * limits.displacement, limits.velocity};
    const std::size_t longest = std::isfinite(limits.velocity) ? stop_ticks(axis, worst) : 0;
    paths_[axis].line.resize((2 * kWindows) * window_ + longest + 1);
    sensors_[axis].past.resize(window_ + 1);
  }
}

void Safety::enable(std::span<const double> rest) noexcept {
  act(SafetyEvent::Enable);
  if (state_ != SafetyState::Ready) return;
  trip_ = {};
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    Path& path = paths_[axis];
    std::ranges::fill(path.line, rest[axis]);
    path.rest = references_[axis] = rest[axis];
    path.stop = {rest[axis], 0};
    Sensor& sensor = sensors_[axis];
    sensor.repeated_displacement = sensor.repeated_force = 0;
    sensor.work = sensor.most_work = 0;
    sensor.has_values = false;
  }
}

void Safety::disable() noexcept { act(SafetyEvent::Disable); }
void Safety::stop() noexcept { act(SafetyEvent::Stop); }

void Safety::trip(const SafetyTrip& trip) noexcept {
  const bool is_latched = state_ == SafetyState::Off || state_ == SafetyState::Tripped;
  if (!is_latched && !has_tripped()) trip_ = trip;
  act(SafetyEvent::Trip);
}

void Safety::act(SafetyEvent event) noexcept {
  const SafetyState before = state_;
  state_ = next_state(state_, event);
  if (state_ != before) ticks_ = 0;
}

std::size_t Safety::stop_ticks(std::size_t axis, const Stop& stop) const noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  const double time = std::isfinite(limits.return_speed)
                          ? std::abs(stop.from - paths_[axis].rest) / limits.return_speed
                          : std::abs(stop.velocity) / limits.braking;
  return static_cast<std::size_t>(std::ceil(std::min(time / settings_.period, 1e9)));
}

double Safety::stop_at(std::size_t axis, const Stop& stop, std::size_t ticks) const noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  const double elapsed = static_cast<double>(ticks) * settings_.period;
  if (std::isfinite(limits.return_speed)) {
    const double way = paths_[axis].rest - stop.from, most = limits.return_speed * elapsed;
    return stop.from + std::clamp(way, -most, most);
  }
  const double braking = std::copysign(limits.braking, stop.velocity);
  const double time = std::min(elapsed, stop.velocity / braking);
  return stop.from + time * (stop.velocity - braking * time / 2);
}

SafetyTrip Safety::find_in_command(std::size_t axis, double command) noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  Path& path = paths_[axis];
  if (!std::isfinite(command)) return {SafetyCause::CommandNotFinite, axis, command, 0};
  if (beyond(command, limits.displacement))
    return {SafetyCause::CommandDisplacement, axis, command, limits.displacement};
  const std::size_t now = kWindows * window_;
  if (beyond(command - path.line[now - 1], limits.jump))
    return {SafetyCause::CommandJump, axis, command - path.line[now - 1], limits.jump};
  const double velocity = (command - path.line[now - window_]) / settings_.window;
  if (beyond(velocity, limits.velocity))
    return {SafetyCause::CommandVelocity, axis, velocity, limits.velocity};

  return find_in_stops(axis, {command, velocity});
}

// A stop begins with the mean velocity of the last window. A command that slows down has a lower
// one now: a stop that begins with less may be inside the limits where that one is not.
SafetyTrip Safety::find_in_stops(std::size_t axis, const Stop& full) noexcept {
  SafetyTrip first;
  for (const double share : {1.0, 0.5, 0.0}) {
    paths_[axis].wanted = {full.from, share * full.velocity};
    const SafetyTrip found = find_in_stop(axis);
    if (found.cause == SafetyCause::None) return found;
    if (first.cause == SafetyCause::None) first = found;
  }
  return first;
}

SafetyTrip Safety::find_in_stop(std::size_t axis) noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  const Stop& stop = paths_[axis].wanted;
  const double end = stop_at(axis, stop, stop_ticks(axis, stop));
  if (beyond(end, limits.displacement))
    return {SafetyCause::CommandDisplacement, axis, end, limits.displacement};
  return std::isfinite(limits.velocity) ? find_in_windows(axis) : SafetyTrip{};
}

// The command and each reference of a stop from it, until the command leaves the last window.
SafetyTrip Safety::find_in_windows(std::size_t axis) noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  Path& path = paths_[axis];
  const std::size_t now = kWindows * window_;
  const std::size_t end = now + stop_ticks(axis, path.wanted) + kWindows * window_;
  const double w = settings_.window;
  for (std::size_t i = now; i <= end; ++i) {
    double* r = path.line.data() + i;
    const auto ago = [&](std::size_t windows) { return *(r - windows * window_); };
    *r = stop_at(axis, path.wanted, i - now);
    const double velocity = (*r - ago(1)) / w;
    if (beyond(velocity, limits.velocity))
      return {SafetyCause::CommandVelocity, axis, velocity, limits.velocity};
    const double acceleration = (*r - 2 * ago(1) + ago(2)) / (w * w);
    if (beyond(acceleration, limits.acceleration))
      return {SafetyCause::CommandAcceleration, axis, acceleration, limits.acceleration};
    const double jerk = (*r - 3 * (ago(1) - ago(2)) - ago(3)) / (w * w * w);
    if (beyond(jerk, limits.jerk)) return {SafetyCause::CommandJerk, axis, jerk, limits.jerk};
  }
  return {};
}

double Safety::expected(std::size_t axis) const noexcept {
  return paths_[axis].line[kWindows * window_ - 1 - delay_];
}

SafetyTrip Safety::find_in_feedback(std::size_t axis, const SafetyFeedback& now) const noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  const Sensor& sensor = sensors_[axis];
  if (!std::isfinite(now.displacement))
    return {SafetyCause::FeedbackNotFinite, axis, now.displacement, 0};
  if (!std::isfinite(now.force)) return {SafetyCause::FeedbackNotFinite, axis, now.force, 0};
  if (state_ == SafetyState::Ready || !sensor.has_values) return {};
  if (beyond(now.displacement, limits.displacement))
    return {SafetyCause::FeedbackDisplacement, axis, now.displacement, limits.displacement};
  if (beyond(now.force, limits.force)) return {SafetyCause::Force, axis, now.force, limits.force};
  const double moved = now.displacement - sensor.last.displacement;
  if (beyond(moved, limits.feedback_jump))
    return {SafetyCause::FeedbackJump, axis, moved, limits.feedback_jump};
  const double change = now.force - sensor.last.force;
  if (beyond(change, limits.force_jump))
    return {SafetyCause::ForceJump, axis, change, limits.force_jump};
  const double error = now.displacement - expected(axis);
  if (beyond(error, limits.tracking)) return {SafetyCause::Tracking, axis, error, limits.tracking};
  return {};
}

void Safety::observe(std::size_t axis, const SafetyFeedback& now) noexcept {
  Sensor& sensor = sensors_[axis];
  if (!std::isfinite(now.displacement) || !std::isfinite(now.force)) return;
  const bool is_first = !sensor.has_values;
  if (is_first) {
    std::ranges::fill(sensor.past, now.displacement);
    sensor.last = now;
    sensor.has_values = true;
  }
  const auto count = [&](double value, double last, std::size_t& repeated, double& since) {
    repeated = value == last && !is_first ? repeated + 1 : 0;
    if (repeated == 0) since = expected(axis);
  };
  count(now.displacement, sensor.last.displacement, sensor.repeated_displacement,
        sensor.expected_displacement);
  count(now.force, sensor.last.force, sensor.repeated_force, sensor.expected_force);
  sensor.work +=
      (now.force + sensor.last.force) / 2 * (now.displacement - sensor.last.displacement);
  sensor.most_work = std::max(sensor.most_work, sensor.work);
  std::copy(sensor.past.begin() + 1, sensor.past.end(), sensor.past.begin());
  sensor.past.back() = now.displacement;
  sensor.last = now;
}

// Guards that need more than two samples. A passive specimen never returns more work than it got.
SafetyTrip Safety::find_in_history(std::size_t axis) const noexcept {
  const SafetyLimits& limits = settings_.axes[axis];
  const Sensor& sensor = sensors_[axis];
  const double velocity = (sensor.past.back() - sensor.past.front()) / settings_.window;
  if (beyond(velocity, limits.velocity))
    return {SafetyCause::FeedbackVelocity, axis, velocity, limits.velocity};
  const auto longest = periods(settings_.stuck, settings_.period);
  const auto stuck_for = [&](std::size_t repeated, double since) {
    return repeated >= longest ? expected(axis) - since : 0.0;
  };
  const double stuck = stuck_for(sensor.repeated_displacement, sensor.expected_displacement);
  if (beyond(stuck, settings_.stuck_motion))
    return {SafetyCause::FeedbackStuck, axis, stuck, settings_.stuck_motion};
  const double stuck_force = stuck_for(sensor.repeated_force, sensor.expected_force);
  if (beyond(stuck_force, settings_.stuck_motion))
    return {SafetyCause::ForceStuck, axis, stuck_force, settings_.stuck_motion};
  if (sensor.work < -limits.negative_work)
    return {SafetyCause::ForceSign, axis, -sensor.work, limits.negative_work};
  if (sensor.work < sensor.most_work - limits.returned_work)
    return {SafetyCause::ForceSign, axis, sensor.most_work - sensor.work, limits.returned_work};
  return {};
}

void Safety::judge_feedback(std::span<const SafetyFeedback> feedback) noexcept {
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    SafetyTrip found = find_in_feedback(axis, feedback[axis]);
    observe(axis, feedback[axis]);
    if (found.cause == SafetyCause::None && state_ != SafetyState::Ready)
      found = find_in_history(axis);
    if (found.cause != SafetyCause::None) trip(found);
  }
}

void Safety::admit(std::span<const double> command,
                   std::span<const SafetyFeedback> feedback) noexcept {
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    const double distance = command[axis] - feedback[axis].displacement;
    if (std::isfinite(command[axis]) && beyond(distance, settings_.start_distance))
      return trip({SafetyCause::FirstCommand, axis, distance, settings_.start_distance});
  }
  act(SafetyEvent::Admit);
}

// Passes the commands of all axes, or none and trips.
void Safety::pass(std::span<const double> command) noexcept {
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    const SafetyTrip found = find_in_command(axis, command[axis]);
    if (found.cause != SafetyCause::None) return trip(found);
  }
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    paths_[axis].stop = paths_[axis].wanted;
    write(axis, command[axis]);
  }
}

void Safety::write(std::size_t axis, double reference) noexcept {
  auto& line = paths_[axis].line;
  const auto now = static_cast<std::ptrdiff_t>(kWindows * window_);
  std::copy(line.begin() + 1, line.begin() + now, line.begin());
  line[kWindows * window_ - 1] = references_[axis] = reference;
}

void Safety::brake() noexcept {
  ++ticks_;
  std::size_t longest = periods(settings_.hold, settings_.period) + 1;
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    write(axis, stop_at(axis, paths_[axis].stop, ticks_));
    longest = std::max(longest, stop_ticks(axis, paths_[axis].stop) + kWindows * window_);
  }
  if (ticks_ < longest) return;
  act(SafetyEvent::Standstill);
  begin_ramp();
}

void Safety::begin_ramp() noexcept {
  ramp_ = settings_.ramp;
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    const double height = std::abs(references_[axis] - paths_[axis].rest);
    ramp_ = std::max(ramp_, ramp_over(height, settings_.axes[axis], settings_.window));
    paths_[axis].stop = {references_[axis], 0};
  }
}

void Safety::ramp_down() noexcept {
  const double x = static_cast<double>(++ticks_) * settings_.period / ramp_;
  const double share = x >= 1 ? 0 : 0.5 * (1 + std::cos(std::numbers::pi * x));
  for (std::size_t axis = 0; axis < paths_.size(); ++axis) {
    const Path& path = paths_[axis];
    write(axis, path.rest + share * (path.stop.from - path.rest));
  }
  if (x >= 1) act(has_tripped() ? SafetyEvent::RestAfterTrip : SafetyEvent::Rest);
}

std::span<const double> Safety::step(std::span<const double> command,
                                     std::span<const SafetyFeedback> feedback,
                                     bool admits) noexcept {
  if (state_ == SafetyState::Off || state_ == SafetyState::Tripped) return references_;
  judge_feedback(feedback);
  if (state_ == SafetyState::Ready && admits) admit(command, feedback);
  if (state_ == SafetyState::Running) pass(command);
  if (state_ == SafetyState::Hold)
    brake();
  else if (state_ == SafetyState::RampDown)
    ramp_down();
  return references_;
}

}  // namespace rths::controller
