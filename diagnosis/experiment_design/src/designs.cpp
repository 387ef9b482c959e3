// SPDX-License-Identifier: Apache-2.0
#include "designs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <fmt/format.h>

#include <rths/identification/signal.hpp>

#include "test_motion.hpp"

namespace rths::diagnosis {
namespace {

constexpr double kUsualDuration = 30;      // [s]
constexpr double kLongDuration = 120;      // [s]
constexpr double kFewestRows = 1000;       // of a test of a slow system
constexpr double kMostRows = 4'000;        // of a usual test
constexpr double kMostRowsOfLong = 8'000;  // of the long test
constexpr double kMostRepeated = 60'000;   // of a repeated record
constexpr double kRestShare = 0.06;        // of a test, at its beginning
constexpr double kFewestPeriods = 4;       // of a sine in a test
constexpr double kCutoffShare =
    0.15;  // of the row rate: the comparison filters out higher frequencies
constexpr double kSmoothShare = 0.36;  // of the row rate: keeps noise out of the rates
constexpr double kFilterEnd = 6;       // periods of the cutoff, at each end of a record
constexpr double kHoldTime = 4;        // [s]
constexpr double kSteadyShare = 0.02;  // of its mean: a channel that varies less is held constant
constexpr double kHeldShare = 0.3;     // of its mean: change of such a channel
constexpr double kQuasiStatic = 0.02;  // of the largest rate
constexpr double kCircleRadius = 0.7;  // of the largest displacement
constexpr double kOvershoot = 1.05;    // of the acceleration of a sine, while its amplitude changes
constexpr double kRoundOff = 1e-6;     // relative
constexpr double kLeastAxis = 0.01;    // of the other axis' displacement: less is hardly a motion

std::string axis_name_of(const std::string& role) { return role.substr(role.find('.') + 1); }

// Rounds down to two significant digits, as machines are set.
double two_digits(double value) {
  if (!(value > 0)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 1);
  return std::floor(value / unit * (1 + 1e-12)) * unit;
}

std::string quantity(double value, const std::string& unit) {
  if (unit.starts_with("m") && (unit.size() == 1 || unit[1] == '/'))
    return fmt::format("{:.3g} m{}", 1e3 * value, unit);
  if (unit == "N") return fmt::format("{:.3g} kN", 1e-3 * value);
  return fmt::format("{:.3g}{}", value, unit.empty() || unit == "1" ? "" : " " + unit);
}

// Largest values of a channel and its rates.
struct Visited {
  double amplitude = 0, rate = 0, second_rate = 0;
};

Visited visited_by(const Problem& problem, const std::string& role) {
  Visited most;
  for (std::size_t i = 0; i < problem.records(); ++i) {
    const Record& record = problem.record(i);
    const Channel* channel = record.find(role);
    if (channel == nullptr) continue;
    VectorXd x = values_of(*channel);
    const double level = record.quiet ? x.segment(static_cast<Index>(record.quiet->first),
                                                  static_cast<Index>(record.quiet->second) -
                                                      static_cast<Index>(record.quiet->first))
                                            .mean()
                                      : 0.0;
    x.array() -= level;
    const double cutoff = kSmoothShare / problem.drive(i).time_step;
    const bool is_filtered = cutoff < 0.4 / record.time_step;
    if (is_filtered) x = low_passed(x, 4, cutoff, record.time_step);
    // A filter swings at the ends of a motion that is cut.
    const auto end = is_filtered ? static_cast<Index>(kFilterEnd / cutoff / record.time_step) : 0;
    const Index margin = std::min(end, x.size() / 4), length = x.size() - 2 * margin;
    const VectorXd rate = rate_of(x, record.time_step);
    const VectorXd second_rate = rate_of(rate, record.time_step);
    const auto largest = [&](const VectorXd& values) {
      return values.segment(margin, length).cwiseAbs().maxCoeff();
    };
    most.amplitude = std::max(most.amplitude, largest(x));
    most.rate = std::max(most.rate, largest(rate));
    most.second_rate = std::max(most.second_rate, largest(second_rate));
  }
  return most;
}

bool is_at_most(const VectorXd& values, double most) {
  return values.cwiseAbs().maxCoeff() <= (1 + kRoundOff) * most;
}

bool has_reached(const VectorXd& motion, const Visited& limit, double time_step) {
  return is_at_most(motion, limit.amplitude) && is_at_most(rate_of(motion, time_step), limit.rate);
}

bool has_accelerated(const VectorXd& motion, const Visited& limit, double time_step) {
  return is_at_most(rate_of(rate_of(motion, time_step), time_step), limit.second_rate);
}

// Makes records like those of a problem, with other motions.
class DesignSpace {
 public:
  explicit DesignSpace(const Problem& problem)
      : problem_{problem}, like_{problem.record(0)}, drivers_{problem.relation().drivers()} {
    if (drivers_.empty()) return;
    for (const auto& driver : drivers_) {
      const Visited most = visited_by(problem, driver);
      limits_.push_back({kReach * most.amplitude, kReach * most.rate, kReach * most.second_rate});
    }
    // The rate of the model on the records: predictions need no more.
    time_.step = std::max(like_.time_step, problem.drive(0).time_step / 4);
    set_duration(kUsualDuration, kMostRows);
  }

  [[nodiscard]] std::vector<Design> designs(bool is_removable) {
    if (drivers_.empty() || !(limits_[0].amplitude > 0) || !(limits_[0].rate > 0)) return {};
    add_sines();
    add_constant_velocities();
    add_mixed();
    add_second_axis();
    if (is_removable) add_empty();
    add_levels();
    add_repeats();
    set_duration(kLongDuration, kMostRowsOfLong);
    const double slow = frequency_at(amplitude(0.3), 0.2 * limits_[0].rate);
    add(fmt::format("sine of {:.3g} Hz, ±{}", slow, size(0.3)), sine(time_, amplitude(0.3), slow));
    return std::move(designs_);
  }

 private:
  void set_duration(double seconds, double most) {
    const double row = problem_.drive(0).time_step;
    // A slow system needs a long test.
    const double periods = kFewestPeriods / fastest_at(amplitude(1)) / (1 - kRestShare);
    time_.duration = std::min(std::max({seconds, kFewestRows * row, periods}), most * row);
    time_.rest = kRestShare * time_.duration;
  }

  [[nodiscard]] double amplitude(double share, std::size_t driver = 0) const {
    return two_digits(share * limits_[driver].amplitude);
  }
  [[nodiscard]] std::string size(double share, std::size_t driver = 0) const {
    return quantity(amplitude(share, driver), like_.find(drivers_[driver])->unit);
  }
  // Frequency of a sine with this amplitude at the limits of rate and acceleration.
  [[nodiscard]] double fastest_at(double amplitude, std::size_t driver = 0) const {
    const Visited& limit = limits_[driver];
    return std::min(limit.rate / amplitude,
                    std::sqrt(limit.second_rate / (kOvershoot * amplitude))) /
           (2 * std::numbers::pi);
  }
  // Frequency of a sine with this amplitude and rate. Limits: a minimum number of periods, the rate
  // and acceleration that the machine has reached, and the bandwidth of the comparison.
  [[nodiscard]] double frequency_at(double amplitude, double rate) const {
    const double wanted = rate / amplitude / (2 * std::numbers::pi);
    return two_digits(
        std::min({std::max(wanted, kFewestPeriods / time_.moving()), fastest_at(amplitude),
                  kCutoffShare / problem_.drive(0).time_step}));
  }

  void add_sines() {
    for (const double share : {1.0, 0.3, 0.1}) {
      double last = 0;
      for (const double pace : {1.0, 0.2, 0.04}) {
        const double frequency = frequency_at(amplitude(share), pace * limits_[0].rate);
        if (frequency == last) continue;
        last = frequency;
        add(fmt::format("sine of {:.3g} Hz, ±{}", frequency, size(share)),
            sine(time_, amplitude(share), frequency));
      }
    }
  }

  void add_constant_velocities() {
    const std::string unit = like_.find(drivers_[0])->unit;
    for (const double pace : {0.5, 0.1, kQuasiStatic}) {
      const double velocity = two_digits(pace * limits_[0].rate);
      if (time_.moving() * velocity < 4 * amplitude(1)) continue;
      const char* name = pace == kQuasiStatic ? "quasi-static push with reversals" : "triangle";
      add_with_corners(fmt::format("{} at {}, ±{}", name, quantity(velocity, unit + "/s"), size(1)),
                       triangle(time_, amplitude(1), velocity));
    }
    const double velocity = two_digits(0.5 * limits_[0].rate);
    const double hold = std::min(kHoldTime, time_.moving() / 6);
    add_with_corners(fmt::format("ramps at {} to ±{}, held for {:.3g} s",
                                 quantity(velocity, unit + "/s"), size(1), hold),
                     ramps_and_holds(time_, amplitude(1), velocity, hold));
  }

  void add_mixed() {
    const double half = frequency_at(amplitude(1), 0.5 * limits_[0].rate),
                 full = frequency_at(amplitude(1), limits_[0].rate);
    constexpr int kSteps = 5, kBursts = 3;
    add(fmt::format("sine of {:.3g} Hz, amplitude rising in {} steps to ±{}", half, kSteps,
                    size(1)),
        staircase(time_, amplitude(1), half, kSteps));
    for (const double share : {0.3, 0.1}) {
      const double to = frequency_at(amplitude(share), limits_[0].rate), from = two_digits(to / 20);
      add(fmt::format("sine sweep from {:.3g} to {:.3g} Hz, ±{}", from, to, size(share)),
          sweep(time_, amplitude(share), from, to));
    }
    add(fmt::format("{} bursts of a sine of {:.3g} Hz, ±{}, with rests between them", kBursts, full,
                    size(1)),
        bursts(time_, amplitude(1), full, kBursts));
    add(kNothingMoving, VectorXd::Zero(time_.samples()));
  }

  // A sine while another channel is held at three levels.
  void add_levels() {
    for (const auto& channel : like_.channels) {
      if (channel.role != "vertical_force" && !channel.role.starts_with("auxiliary.")) continue;
      const VectorXd x = values_of(channel);
      double reach = kReach / 2 * (x.maxCoeff() - x.minCoeff());
      const double mean = x.mean();
      if (reach < kSteadyShare * std::abs(mean)) reach = kHeldShare * std::abs(mean);
      const double frequency = frequency_at(amplitude(0.8), 0.5 * limits_[0].rate);
      const bool is_added =
          add(fmt::format("sine of {:.3g} Hz, ±{}, at {} of {}, {} and {}", frequency, size(0.8),
                          channel.role, quantity(mean - reach, channel.unit),
                          quantity(mean, channel.unit), quantity(mean + reach, channel.unit)),
              sine(time_, amplitude(0.8), frequency));
      if (!is_added) continue;
      if (Channel* level = channel_of(designs_.back().record, channel.role))
        for (Index k = 0; k < time_.samples(); ++k) {
          const double third =
              std::floor(3 * static_cast<double>(k) / static_cast<double>(time_.samples()));
          level->values[static_cast<std::size_t>(k)] = mean + (third - 1) * reach;
        }
    }
  }

  void add_second_axis() {
    if (drivers_.size() < 2 || family_of(drivers_[0]) != family_of(drivers_[1])) return;
    if (family_of(drivers_[0]) == "input") return;  // not necessarily axes
    const double first = amplitude(kCircleRadius), second = amplitude(kCircleRadius, 1);
    if (!(second > kLeastAxis * first)) return;
    const double frequency =
        two_digits(std::min(frequency_at(first, 0.5 * limits_[0].rate), fastest_at(second, 1)));
    const double quarter = std::numbers::pi / 2;
    const std::string sizes = second == first
                                  ? size(kCircleRadius)
                                  : size(kCircleRadius) + " and " + size(kCircleRadius, 1);
    add(fmt::format("{} of {} in both axes, {:.3g} Hz", second == first ? "circle" : "ellipse",
                    sizes, frequency),
        sine(time_, first, frequency), sine(time_, second, frequency, quarter));
    add(fmt::format("sine of {:.3g} Hz, ±{} in both axes", frequency, sizes),
        sine(time_, first, frequency), sine(time_, second, frequency));
  }

  // Repeats the tests so far on the empty table, which no specimen loads.
  void add_empty() {
    for (std::size_t i = 0, count = designs_.size(); i < count; ++i) {
      Design empty = designs_[i];
      empty.text = "empty table, " + empty.text;
      empty.is_empty = true;
      if (Channel* load = channel_of(empty.record, "vertical_force"))
        std::fill(load->values.begin(), load->values.end(), 0.0);
      designs_.push_back(std::move(empty));
    }
  }

  // Repeats the recorded motion, larger and smaller.
  void add_repeats() {
    for (const double factor : {kReach, 0.5}) {
      Record record = like_;
      for (auto& channel : record.channels)
        if (std::find(drivers_.begin(), drivers_.end(), channel.role) != drivers_.end())
          for (double& value : channel.values) value *= factor;
      for (const auto& [role, unit] : problem_.relation().outputs())
        if (Channel* output = channel_of(record, role))
          for (double& value : output->values) value *= factor;
      if (static_cast<double>(record.samples()) > kMostRepeated) continue;
      designs_.push_back(
          {fmt::format("{} {} repeated, {:.3g} times as large", kSameAgain, like_.name, factor),
           std::move(record)});
    }
  }

  static Channel* channel_of(Record& record, const std::string& role) {
    const auto found = std::find_if(record.channels.begin(), record.channels.end(),
                                    [&](const Channel& channel) { return channel.role == role; });
    return found == record.channels.end() ? nullptr : &*found;
  }

  // Returns false for a test beyond the limits, which is left out.
  bool add(const std::string& text, const VectorXd& motion, const VectorXd& second = {}) {
    const bool is_slow = has_accelerated(motion, limits_[0], time_.step) &&
                         (second.size() == 0 || has_accelerated(second, limits_[1], time_.step));
    return is_slow && add_with_corners(text, motion, second);
  }
  // The machine itself rounds the corners of a motion, at which its velocity jumps.
  bool add_with_corners(const std::string& text, const VectorXd& motion,
                        const VectorXd& second = {}) {
    if (!has_reached(motion, limits_[0], time_.step) ||
        (second.size() > 0 && !has_reached(second, limits_[1], time_.step)))
      return false;
    Record record;
    record.name = text;
    record.use = Use::Fit;
    record.time_step = time_.step;
    record.quiet = {0, static_cast<std::size_t>(time_.rest / time_.step)};
    for (const auto& channel : like_.channels)
      record.channels.push_back({channel.role, channel.unit, {}});
    for (auto& channel : record.channels) {
      const VectorXd values = signal_of(channel.role, motion, second);
      channel.values.assign(values.begin(), values.end());
    }
    constexpr double kLong = 999.5;  // [s] three digits would have an exponent
    const std::string duration = time_.duration < kLong ? fmt::format("{:.3g}", time_.duration)
                                                        : fmt::format("{:.0f}", time_.duration);
    designs_.push_back({fmt::format("{}, {} s", text, duration), std::move(record)});
    return true;
  }

  // The signal of a channel of the records under a motion.
  [[nodiscard]] VectorXd signal_of(const std::string& role, const VectorXd& motion,
                                   const VectorXd& second) const {
    const VectorXd still = VectorXd::Zero(time_.samples());
    for (std::size_t i = 0; i < drivers_.size(); ++i) {
      const VectorXd& moved = i == 0 ? motion : i == 1 && second.size() > 0 ? second : still;
      if (const auto signal = signal_along(role, drivers_[i], moved)) return *signal;
    }
    const Channel& recorded = *like_.find(role);
    if (!is_output(role)) return VectorXd::Constant(time_.samples(), values_of(recorded).mean());
    // Models need the peak and the first value of an output.
    VectorXd sized = still;
    sized[sized.size() - 1] = values_of(recorded).cwiseAbs().maxCoeff();
    return sized;
  }

  // The signal of a channel that follows a driver; none if it does not.
  [[nodiscard]] std::optional<VectorXd> signal_along(const std::string& role,
                                                     const std::string& driver,
                                                     const VectorXd& moved) const {
    if (role == driver) return moved;
    if (axis_name_of(role) != axis_name_of(driver)) return std::nullopt;
    const bool is_displacement = driver.starts_with("displacement.");
    if (is_displacement && role.starts_with("velocity.")) return rate_of(moved, time_.step);
    if (is_displacement && role.starts_with("acceleration."))
      return second_rate_of(moved, time_.step);
    if (role.starts_with("force.") && !is_output(role))
      return VectorXd{load_of(role, driver) * moved};
    return std::nullopt;
  }

  [[nodiscard]] bool is_output(const std::string& role) const {
    const auto& outputs = problem_.relation().outputs();
    return std::any_of(outputs.begin(), outputs.end(),
                       [&](const auto& output) { return output.first == role; });
  }

  // Force per motion of an actuator with a load.
  [[nodiscard]] double load_of(const std::string& force, const std::string& driver) const {
    const VectorXd u = values_of(*like_.find(driver)), f = values_of(*like_.find(force));
    const double square = (u.array() - u.mean()).square().sum();
    return square > 0 ? ((u.array() - u.mean()) * f.array()).sum() / square : 0;
  }

  const Problem& problem_;
  const Record& like_;
  std::vector<std::string> drivers_;
  std::vector<Visited> limits_;  // of each driver
  TestTime time_;
  std::vector<Design> designs_;
};

}  // namespace

std::vector<Design> designs_for(const Problem& problem, bool is_removable) {
  return DesignSpace{problem}.designs(is_removable);
}

}  // namespace rths::diagnosis
