// SPDX-License-Identifier: Apache-2.0
#include <rths/session/pretest.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/budget/transfer_system.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/maths/statistics.hpp>
#include <rths/recording/roles.hpp>
#include <rths/session/companions.hpp>
#include <rths/session/hybrid_test.hpp>
#include <rths/sim/term.hpp>

#include "virtual_run.hpp"

namespace rths::session {
namespace {

using commissioning::AmplitudeMargin;
using commissioning::HybridLoop;
using commissioning::LinearLead;
using Json = nlohmann::ordered_json;

constexpr const char* kImposed = "imposed.h5";
constexpr const char* kClosedLoop = "closed_loop.h5";
constexpr const char* kNumerical = "numerical.h5";
constexpr const char* kOther = "other.h5";  // of the other closed loops, one after the other
constexpr int kAmplitudes = 8;              // from a thousandth of the peak to the peak
constexpr double kSmallest = 1e-3;          // of the peak
constexpr double kLoopFrequency = 1;        // of describing functions [Hz]
constexpr double kWorstMachine = 0.3;       // error of the identified machine over that of none
constexpr double kSearchedDelay = 0.2;      // [s]
constexpr double kLeastReference = 1e-4;    // RMS of a reference that identifies a machine [m]
constexpr std::uint64_t kRuns = 8;          // of the closed loop
constexpr double kHoldPeriods = 0.5;        // of the controller: its reference is held

bool is_tested(const Experiment& experiment, std::size_t axis) {
  return contains(experiment.axes, kHorizontal[axis]);
}

// The numerical specimen is the bearing that the simulation assumes.
Experiment with_numerical_specimen(Experiment experiment) {
  experiment.specimen = experiment.model.bearing;
  experiment.machine.simulated.specimen = experiment.model.bearing;
  return experiment;
}

// The motion of the purely numerical result, at the targets of the test.
experiment::DisplacementHistory motion_in(const recording::Reader& numerical,
                                          const Experiment& experiment) {
  const double interval = numerical.time()[1] - numerical.time()[0];
  experiment::DisplacementHistory history;
  history.time_step = experiment.time.integration_step;
  const auto steps = std::lround(experiment.time.duration / experiment.time.integration_step);
  const auto read = [&](const char* axis) {
    const auto values = numerical.signal(std::string{"result.displ."} + axis);
    std::vector<double> found{0};
    for (long i = 1; i <= steps; ++i) {
      const double place = std::clamp(static_cast<double>(i) * history.time_step / interval - 1,
                                      0.0, static_cast<double>(values.size() - 1));
      const auto before = static_cast<std::size_t>(place);
      const auto after = std::min(before + 1, values.size() - 1);
      found.push_back(
          std::lerp(values[before], values[after], place - static_cast<double>(before)));
    }
    return found;
  };
  history.displacement_long = read(name_of(kHorizontal[0]));
  history.displacement_lat = read(name_of(kHorizontal[1]));
  return history;
}

Experiment with_imposed_motion(Experiment experiment,
                               const experiment::DisplacementHistory& motion) {
  experiment.history = motion;
  for (auto& node : experiment.nodes) node.switch_compensation_off();
  return experiment;
}

void identify_machine(const recording::Reader& run, AxisPrediction& axis) {
  const auto record = transfer_record_of(recording::roles_of(run), run, axis.name, {});
  if (!(maths::rms(record.reference) >= kLeastReference))
    throw Error{fmt::format("machine: the reference of {} does not move", axis.name)};
  axis.machine = budget::identify_transfer(record);
  axis.machine_delay =
      maths::identify_delay(record.reference, record.displacement, record.period, kSearchedDelay)
          .minimum_rms;
}

// The median of each number over the ticks.
template <class Numbers>
Numbers median_of(const std::vector<Numbers>& by_tick) {
  Numbers middle = by_tick.front();
  for (Eigen::Index i = 0; i < middle.size(); ++i) {
    std::vector<double> values;
    for (const auto& one : by_tick) values.push_back(one[i]);
    middle[i] = maths::median(std::move(values));
  }
  return middle;
}

// The compensation of most ticks; dead band and flow of an inverse are not linear, and left out.
LinearLead lead_of(const budget::Compensation& compensation) {
  if (const auto* sent = std::get_if<budget::SentInverse>(&compensation)) {
    const auto w = controller::InverseLead::coefficients_of(median_of(sent->coefficients));
    return {{w.a0, w.a1, w.a2, w.a3, sent->settings.a4}, {w.load, w.load_rate}};
  }
  const auto& leads = std::get<std::vector<budget::Lead>>(compensation);
  if (leads.empty()) return {};
  const budget::Lead lead = median_of(leads);
  return {{lead[0], lead[1], lead[2], 0, 0}, {}};
}

void predict_stability(const Experiment& experiment, const recording::Reader& run, std::size_t i,
                       AxisPrediction& axis) {
  const auto test = hybrid_test_of(experiment, run);
  const sim::PlantMatrices* plant = test.structure->matrices();
  if (plant == nullptr) return;  // too large to solve in every frequency
  const HybridLoop loop{*plant,
                        static_cast<int>(i),
                        axis.machine,
                        experiment.model.machine.axes[i].effective_mass,
                        lead_of(test.compensation[i]),
                        kHoldPeriods * test.period,
                        experiment.time.rate};
  for (int k = 0; k < kAmplitudes; ++k) {
    AmplitudeMargin margin;
    margin.amplitude =
        axis.peak * std::pow(kSmallest, 1 - static_cast<double>(k) / (kAmplitudes - 1));
    margin.stiffness = commissioning::describing_function(experiment.model.bearing,
                                                          margin.amplitude, kLoopFrequency);
    margin.delay_margin = loop.delay_margin(margin.stiffness);
    margin.stable = margin.delay_margin > 0;
    margin.gain_margin = loop.gain_margin(margin.stiffness);
    if (!margin.stable) axis.ringing = margin.amplitude;
    axis.margins.push_back(margin);
  }
}

void predict_tracking(const recording::Reader& run, AxisPrediction& axis) {
  for (const auto& roles : recording::roles_of(run).axes) {
    if (roles.axis != axis.name) continue;
    const auto command = run.signal(roles.command), measured = run.signal(roles.displacement);
    axis.tracking = maths::tracking_error(command, measured);
    const double interval =
        (run.time().back() - run.time().front()) / static_cast<double>(run.time().size() - 1);
    axis.delay = maths::identify_delay(command, measured, interval, kSearchedDelay).minimum_rms;
  }
}

void decide(const PretestSettings& settings, double most_difference, Pretest& result) {
  for (const auto& axis : result.axes) {
    if (!axis.differences.empty() && !(axis.difference() <= most_difference))
      result.reasons.push_back(
          fmt::format("{}: the response differs by {:.1f} % from the numerical result, expected at "
                      "most {:g} %",
                      axis.name, 1e2 * axis.difference(), 1e2 * most_difference));
    if (axis.margins.empty()) continue;
    const auto& largest = axis.margins.back();
    if (axis.ringing > settings.most_ringing * axis.peak)
      result.reasons.push_back(fmt::format(
          "{}: the loop is unstable up to an amplitude of {:.1f} mm, expected at most {:.1f} mm",
          axis.name, 1e3 * axis.ringing, 1e3 * settings.most_ringing * axis.peak));
    else if (largest.delay_margin < settings.least_delay_margin)
      result.reasons.push_back(fmt::format(
          "{}: {:.2f} ms more delay make the loop unstable, expected at least {:.2f} ms", axis.name,
          1e3 * largest.delay_margin, 1e3 * settings.least_delay_margin));
  }
  for (const auto& condition : result.broken)
    result.reasons.push_back("the test would not be conclusive: " + condition.text());
}

/// The steps of a pretest, in order. Each returns false if the next ones make no sense.
class Steps {
 public:
  Steps(const Experiment& experiment, const PretestSettings& settings)
      : experiment_{with_numerical_specimen(experiment)}, settings_{settings} {}

  Pretest all() {
    find_reference();
    if (check_path() && check_machine()) close_loop();
    decide(settings_, report::read_bounds(experiment_.conclusive).response, result_);
    return std::move(result_);
  }

 private:
  void begin(const std::string& step) const {
    if (settings_.begins) settings_.begins(step);
  }
  [[nodiscard]] std::filesystem::path imposed() const { return settings_.folder / kImposed; }

  void find_reference() {
    begin("the numerical result");
    const auto file = settings_.folder / kNumerical;
    if (!run_numerical(experiment_, file, settings_.version))
      throw Error{
          experiment_.file.string() +
          ": the structure of the solver is its own, expected it as [plant] or its response "
          "as [reference]"};
    motion_ = motion_in(recording::Reader{file}, experiment_);
  }

  [[nodiscard]] launch::RunOutcome run(const Experiment& experiment,
                                       const std::filesystem::path& file) const {
    auto outcome = run_virtually(experiment, file, settings_.version);
    if (outcome.interrupted)
      throw Error{experiment.file.string() + ": the pretest was interrupted"};
    return outcome;
  }

  [[nodiscard]] std::vector<commissioning::SignalFinding> signals_in(
      const std::filesystem::path& file) const {
    return commissioning::check_signals(
        recording::Reader{file}, experiment_.model.machine,
        experiment_.machine.simulated.has_specimen ? &experiment_.model.bearing : nullptr);
  }

  bool check_path() {
    begin("the path with an imposed motion");
    const auto outcome = run(with_imposed_motion(experiment_, motion_), imposed());
    // A safety layer may end the path because of a signal; its rows up to there name the signal.
    if (!outcome.completed)
      result_.reasons.push_back("the path did not reach its end: " + outcome.trouble);
    result_.signals = signals_in(imposed());
    if (!settings_.machine.empty()) {
      auto real = signals_in(settings_.machine);
      result_.signals.insert(result_.signals.end(), real.begin(), real.end());
    }
    for (const auto& signal : result_.signals)
      if (!signal.is_fine())
        result_.reasons.push_back(
            fmt::format("{}: {} {}", signal.axis, signal.signal, signal.trouble));
    return result_.reasons.empty();
  }

  bool check_machine() {
    begin("the identification of the machine");
    const recording::Reader run{settings_.machine.empty() ? imposed() : settings_.machine};
    for (std::size_t i = 0; i < 2; ++i) {
      if (!is_tested(experiment_, i)) continue;
      AxisPrediction axis;
      axis.name = name_of(kHorizontal[i]);
      identify_machine(run, axis);
      for (const double x : i == 0 ? motion_.displacement_long : motion_.displacement_lat)
        axis.peak = std::max(axis.peak, std::abs(x));
      if (axis.machine.error > kWorstMachine * axis.machine.error_without)
        result_.reasons.push_back(fmt::format(
            "{}: the machine is not identified: its model leaves {:.1f} % of the displacement, "
            "expected at most {:.1f} %",
            axis.name, 1e2 * axis.machine.error, 1e2 * kWorstMachine * axis.machine.error_without));
      result_.axes.push_back(std::move(axis));
    }
    return result_.reasons.empty();
  }

  // Why the identified machine cannot close the loop; empty: it can.
  [[nodiscard]] std::string machine_kept_because() const {
    if (recording::Reader{imposed()}.has(experiment_.roles.vertical_measured))
      return "the test controls the vertical force";
    const auto* machine = experiment_.node(experiment_.roles.machine);
    if (machine == nullptr || machine->adapter == "srmd") return "";
    return fmt::format("the adapter of node '{}' is {}", machine->node, machine->adapter);
  }

  [[nodiscard]] Experiment with_machine_of_loop() {
    const std::string kept_because = machine_kept_because();
    result_.loop_machine = kept_because.empty()
                               ? "the identified machine"
                               : "the machine of the experiment, because " + kept_because;
    Experiment closed = experiment_;
    if (!kept_because.empty()) return closed;
    closed.machine.is_identified = true;
    // Friction that the controller subtracts was identified, so the machine has it.
    closed.machine.simulated =
        budget::with_known_friction(closed.model.machine, correction_of(closed));
    std::erase_if(closed.machine.simulated.terms, [](const auto& term) {
      return sim::term_kind(term.kind).stage == sim::Stage::Actuator;  // identified with the axis
    });
    closed.machine.simulated.specimen = closed.model.bearing;
    closed.machine.simulated.seed = experiment_.machine.simulated.seed;
    for (const auto& axis : result_.axes) {
      auto& servo = closed.machine.simulated.axes[index_of(*axis_named(axis.name))];
      servo = sim::servo_axis(axis.machine, servo);
    }
    return closed;
  }

  // Independent noise of run k; that of the first is the experiment's.
  bool close_loop(Experiment closed, std::uint64_t k, const std::filesystem::path& file) {
    renew_noise(closed, k);
    const auto outcome = run(closed, file);
    if (!outcome.completed) {
      result_.reasons.push_back("the closed loop did not reach its end: " + outcome.trouble);
      return false;
    }
    const recording::Reader numerical{settings_.folder / kNumerical};
    const auto differences = report::response_differences(recording::Reader{file}, numerical);
    for (auto& axis : result_.axes) axis.differences.push_back(differences.at(axis.name));
    return true;
  }

  void close_loop() {
    const Experiment closed = with_machine_of_loop();
    begin("the closed loop with " + result_.loop_machine);
    const auto first = settings_.folder / kClosedLoop, other = settings_.folder / kOther;
    if (!close_loop(closed, 0, first)) return;
    const recording::Reader run{first};
    result_.broken = report::judge(run);
    for (std::uint64_t k = 1; k < kRuns; ++k)
      if (!close_loop(closed, k, other)) break;
    std::filesystem::remove(other);
    begin("the stability of the loop");
    for (auto& axis : result_.axes) {
      predict_tracking(run, axis);
      if (closed.solves_plant())
        predict_stability(closed, run, index_of(*axis_named(axis.name)), axis);
    }
  }

  Experiment experiment_;
  const PretestSettings& settings_;
  experiment::DisplacementHistory motion_;  ///< of the numerical result
  Pretest result_;
};

}  // namespace

double AxisPrediction::difference() const { return maths::mean(differences); }

Pretest pretest(const Experiment& experiment, const PretestSettings& settings) {
  if (experiment.has_user_program())
    throw Error{experiment.file.string() +
                ": a node is a program of your own, which has no virtual time"};
  if (experiment.history)
    throw Error{experiment.file.string() + ": has [targets], expected a closed loop"};
  for (const char* name : {kImposed, kClosedLoop, kNumerical, kOther})
    if (const auto file = settings.folder / name; std::filesystem::exists(file))
      throw Error{file.string() +
                  ": exists, expected a folder without recordings of an earlier pretest"};
  return Steps{experiment, settings}.all();
}

std::string text_of(const Pretest& pretest) {
  std::string text = "signals, by what they should follow:\n";
  for (const auto& signal : pretest.signals)
    text += fmt::format("  {:<5}{:<36} {:>9.4g} × {:<44} {:.2f}  {}\n", signal.axis, signal.signal,
                        signal.gain, signal.against, signal.correlation,
                        signal.is_fine() ? "ok" : signal.trouble);
  for (const auto& axis : pretest.axes) {
    text += fmt::format(
        "{}: machine {:.1f} ms late, {:.1f} % of its motion unexplained; peak of the numerical "
        "result {:.0f} mm\n",
        axis.name, 1e3 * axis.machine_delay, 1e2 * axis.machine.error, 1e3 * axis.peak);
    if (axis.differences.empty()) continue;
    if (axis.margins.empty())
      text += "  stability unknown: the structure is that of the solver\n";
    else
      text += "  amplitude mm   stiffness MN/m   delay margin ms   gain margin\n";
    for (const auto& margin : axis.margins)
      text += margin.stable ? fmt::format("{:14.2f}{:17.2f}{:18.1f}{:14.2f}\n",
                                          1e3 * margin.amplitude, margin.stiffness.real() / 1e6,
                                          1e3 * margin.delay_margin, margin.gain_margin)
                            : fmt::format("{:14.2f}{:17.2f}{:>18}{:>14}\n", 1e3 * margin.amplitude,
                                          margin.stiffness.real() / 1e6, "unstable", "");
    const auto [lowest, highest] =
        std::minmax_element(axis.differences.begin(), axis.differences.end());
    text += fmt::format(
        "  tracking: {:.1f} ms, NRMS {:.2f} %; response {:.1f} % from the numerical result, {:.1f} "
        "to {:.1f} % in {} runs\n",
        1e3 * axis.delay, 1e2 * axis.tracking.nrms, 1e2 * axis.difference(), 1e2 * *lowest,
        1e2 * *highest, axis.differences.size());
  }
  if (!pretest.loop_machine.empty())
    text += fmt::format("the loop was closed with {}\n", pretest.loop_machine);
  if (pretest.is_go()) return text + "go\n";
  for (const auto& reason : pretest.reasons) text += "no-go: " + reason + "\n";
  return text;
}

std::string json_of(const Pretest& pretest) {
  Json document{{"go", pretest.is_go()},
                {"reasons", pretest.reasons},
                {"loop_machine", pretest.loop_machine},
                {"signals", Json::array()}};
  for (const auto& s : pretest.signals)
    document["signals"].push_back({{"axis", s.axis},
                                   {"role", s.role},
                                   {"signal", s.signal},
                                   {"against", s.against},
                                   {"gain", s.gain},
                                   {"correlation", s.correlation},
                                   {"trouble", s.trouble}});
  document["axes"] = Json::object();
  for (const auto& axis : pretest.axes) {
    Json json{{"machine_delay_ms", 1e3 * axis.machine_delay},
              {"machine_error", axis.machine.error},
              {"peak_m", axis.peak},
              {"ringing_m", axis.ringing},
              {"difference_percent", 1e2 * axis.difference()},
              {"difference_percent_of_runs", Json::array()},
              {"tracking_delay_ms", 1e3 * axis.delay},
              {"tracking_nrms_percent", 1e2 * axis.tracking.nrms},
              {"margins", Json::array()}};
    for (const auto& m : axis.margins)
      json["margins"].push_back({{"amplitude_m", m.amplitude},
                                 {"stiffness_N_per_m", m.stiffness.real()},
                                 {"stable", m.stable},
                                 {"delay_margin_ms", 1e3 * m.delay_margin},
                                 {"gain_margin", m.gain_margin}});
    for (const double d : axis.differences) json["difference_percent_of_runs"].push_back(1e2 * d);
    document["axes"][axis.name] = json;
  }
  return document.dump(2) + "\n";
}

}  // namespace rths::session
