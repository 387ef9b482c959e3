// SPDX-License-Identifier: Apache-2.0
#include "example_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace rths::report::test_support {
namespace {

using namespace diagnosis;

constexpr double kDuration = 24;                                           // [s]
constexpr double kTimeStep = 0.01;                                         // of the traces [s]
constexpr double kStiffness = 4.2e6, kDamping = 9.0e4, kFriction = 4.1e4;  // [N/m], [N·s/m], [N]
constexpr double kNoise = 1.6e3;                                           // [N]

/// A motion with the envelope of an earthquake.
struct Motion {
  std::vector<double> time, displacement, velocity;
};

double displacement_at(double t, double phase) {
  const double envelope = 0.16 * std::pow(t / 5, 2) * std::exp(2 * (1 - t / 5));
  return envelope *
         (std::sin(2 * M_PI * 0.45 * t + phase) + 0.35 * std::sin(2 * M_PI * 1.3 * t + 2 * phase));
}

Motion motion(double phase) {
  Motion m;
  constexpr double kStep = 1e-5;
  for (double t = 0; t < kDuration; t += kTimeStep) {
    m.time.push_back(t);
    m.displacement.push_back(displacement_at(t, phase));
    m.velocity.push_back((displacement_at(t + kStep, phase) - displacement_at(t - kStep, phase)) /
                         (2 * kStep));
  }
  return m;
}

using Law = std::function<double(double u, double v)>;

std::vector<double> forces(const Motion& m, const Law& law) {
  std::vector<double> f;
  for (std::size_t i = 0; i < m.time.size(); ++i)
    f.push_back(law(m.displacement[i], m.velocity[i]));
  return f;
}

double base_law(double u, double v) { return kStiffness * u + kDamping * v; }
double friction(double v) { return kFriction * std::tanh(v / 0.02); }
// A fit without the friction term overestimates the damping.
double absorbed_law(double u, double v) { return kStiffness * u + 1.9 * kDamping * v; }

Trace trace(const std::string& record, double phase, const Law& truth, const Law& before,
            const Law& after) {
  const Motion m = motion(phase);
  Trace t;
  t.record = record;
  t.channel = "force.long";
  t.unit = "N";
  t.use = "fit";
  t.cutoff = 25;
  t.time = m.time;
  t.abscissa = m.displacement;
  t.abscissa_label = "displacement [m]";
  t.noise.assign(m.time.size(), kNoise);
  t.measured = forces(m, truth);
  std::mt19937 random{3};
  std::normal_distribution<double> noise{0, kNoise};
  for (double& value : t.measured) value += noise(random);
  t.stated = forces(m, base_law);
  t.before = forces(m, before);
  t.after = forces(m, after);
  for (std::size_t i = 0; i < m.time.size(); ++i)
    t.excess.push_back(std::max(0.0, std::pow((t.measured[i] - t.before[i]) / kNoise, 2) - 1));
  const double sum = std::accumulate(t.excess.begin(), t.excess.end(), 1e-12);
  for (double& value : t.excess) value /= sum;
  return t;
}

// Energy of a trace in each cell of a value, as a fraction of its total.
Profile profile(const std::string& name, const std::string& unit, std::vector<double> edges,
                const std::vector<double>& values, const std::vector<double>& excess) {
  Profile p{name, unit, std::move(edges), {}};
  p.share.assign(p.edges.size() - 1, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto cell = std::upper_bound(p.edges.begin(), p.edges.end(), values[i]);
    if (cell != p.edges.begin() && cell != p.edges.end())
      p.share[static_cast<std::size_t>(cell - p.edges.begin()) - 1] += excess[i];
  }
  return p;
}

std::vector<double> equal_edges(double low, double high, int cells) {
  std::vector<double> edges;
  for (int i = 0; i <= cells; ++i) edges.push_back(low + (high - low) * i / cells);
  return edges;
}

void add_state_map(Where& where, const Trace& t, const Motion& m) {
  constexpr int kCells = 9;
  const auto largest = [](const std::vector<double>& values) {
    return 1.0001 *
           std::abs(*std::max_element(values.begin(), values.end(), [](double a, double b) {
             return std::abs(a) < std::abs(b);
           }));
  };
  const double du = 2 * largest(m.displacement) / kCells, dv = 2 * largest(m.velocity) / kCells;
  std::vector<double> energy(kCells * kCells, 0);
  std::vector<bool> visited(kCells * kCells, false);
  for (std::size_t i = 0; i < m.time.size(); ++i) {
    const auto column = static_cast<std::size_t>(m.displacement[i] / du + kCells / 2.0);
    const auto row = static_cast<std::size_t>(m.velocity[i] / dv + kCells / 2.0);
    energy[row * kCells + column] += t.excess[i];
    visited[row * kCells + column] = true;
  }
  for (std::size_t i = 0; i < energy.size(); ++i) {
    if (!visited[i]) continue;
    const double u = du * (static_cast<double>(i % kCells) - kCells / 2.0);
    const double v = dv * (static_cast<double>(i / kCells) - kCells / 2.0);
    where.state_map.push_back({{u, u + du}, {v, v + dv}, energy[i]});
  }
  where.states = where.state_map;
  std::sort(where.states.begin(), where.states.end(),
            [](const StateCell& a, const StateCell& b) { return a.share > b.share; });
  double held = 0;
  std::size_t count = 0;
  while (count < where.states.size() && held < 0.8) held += where.states[count++].share;
  where.states.resize(count);
}

// The smallest set of cells that holds 80 % of the energy; neighbours are joined.
std::vector<std::pair<double, double>> place_of(const Profile& p) {
  std::vector<std::size_t> order(p.share.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return p.share[a] > p.share[b]; });
  double held = 0;
  std::size_t count = 0;
  while (count < order.size() && held < 0.8) held += p.share[order[count++]];
  order.resize(count);
  std::sort(order.begin(), order.end());
  std::vector<std::pair<double, double>> intervals;
  for (const std::size_t i : order)
    if (!intervals.empty() && intervals.back().second == p.edges[i])
      intervals.back().second = p.edges[i + 1];
    else
      intervals.emplace_back(p.edges[i], p.edges[i + 1]);
  return intervals;
}

// Third octaves with the energy of friction: odd harmonics of the motion.
Profile third_octaves() {
  Profile p{"frequency", "Hz", {}, {}};
  for (int i = -3; i <= 14; ++i) p.edges.push_back(std::pow(10.0, i / 10.0) / std::pow(10.0, 0.05));
  p.edges[0] = 0;  // and below
  p.share = {.05, .19, .17, .08, .06, .12, .1, .07, .05, .04, .03, .02, .01, .01, 0, -1, -1};
  return p;
}

Where where_of(const Trace& t, const Motion& m) {
  Where where;
  where.part = Part::Machine;
  where.channel = "force.long";
  where.record = t.record;
  add_state_map(where, t, m);
  std::vector<double> load;
  for (const double time : m.time) load.push_back(7e6 + 9e5 * std::sin(2 * M_PI * 0.9 * time));
  where.profiles = {profile("time", "s", equal_edges(0, kDuration, 92), m.time, t.excess),
                    third_octaves(),
                    profile("axial load", "N", equal_edges(6e6, 8e6, 9), load, t.excess)};
  where.intervals = place_of(where.profiles[0]);
  where.bands = place_of(where.profiles[1]);
  return where;
}

std::vector<double> noise_correlation() {
  std::mt19937 random{8};
  std::normal_distribution<double> noise{0, 0.025};
  std::vector<double> values(40);
  for (double& value : values) value = noise(random);
  return values;
}

Verdict common(const std::string& name) {
  Verdict v;
  v.case_name = name;
  v.synthetic = true;
  v.noise.source = "rest interval, 0.0 to 1.1 s, autoregressive of order 12";
  v.evaluation.residual.correlation = noise_correlation();
  v.evaluation.residual.bound = 0.05;
  v.seconds = 1.84;
  v.evaluation.proof_record = "petrolia.csv";
  return v;
}

Cause friction_cause() {
  Cause cause;
  cause.name = "coulomb_friction";
  cause.title = "Coulomb friction in the guides";
  cause.equation = "F = Fc · tanh(v / vs)";
  cause.part = Part::Machine;
  cause.channel = "force.long";
  cause.confidence = 0.98;
  cause.explained = 0.97;
  cause.parameters = {{"coulomb_friction.friction_force", "N", 41.2e3, 40.5e3, 41.9e3},
                      {"coulomb_friction.presliding_velocity", "m/s", 0.0204, 0.0189, 0.0221}};
  cause.alternatives = {{"load_dep_friction", "Friction that follows the vertical load", 0.97,
                         "empty table, sine of 0.5 Hz at three vertical loads", 218}};
  return cause;
}

}  // namespace

Verdict missing_verdict() {
  const Law truth = [](double u, double v) { return base_law(u, v) + friction(v); };
  const Law after = [](double u, double v) { return base_law(u, v) + 1.003 * friction(v); };
  Verdict v = common("guides of a table");
  v.conclusion.outcome = Outcome::Missing;
  v.conclusion.confidence = 0.98;
  v.sentence =
      "Missing: Coulomb friction in the guides, Fc = 41.2 kN ± 0.7 kN (confidence 0.98); explains "
      "97 % of the systematic residual; on the unseen record the error falls from 9.1 % to 0.6 % "
      "(noise floor 0.6 %). Could also be friction that follows the vertical load. Next test: "
      "empty "
      "table, sine of 0.5 Hz at three vertical loads (218 σ).";
  v.evaluation.traces = {trace("northridge.csv", 0, truth, absorbed_law, after),
                         trace("petrolia.csv", 1.1, truth, absorbed_law, after)};
  v.conclusion.where = where_of(v.evaluation.traces[0], motion(0));
  v.conclusion.causes = {friction_cause()};
  v.evaluation.refitted = {{"bouc_wen.post_yield_stiffness", "N/m", 4.24e6, 4.61e6, 4.25e6}};
  v.evaluation.fit = {{"northridge.csv", "fit", 0.089, 0.0061, 0.112, 0.0060, 31.0, 1.02},
                      {"kobe.csv", "fit", 0.093, 0.0062, 0.118, 0.0061, 33.2, 1.01},
                      {"petrolia.csv", "held_out", 0.091, 0.0063, 0.121, 0.0061, 32.4, 1.03}};
  v.evaluation.proof = {0.091, 0.0063, 0.0061, 0.97};
  v.evaluation.proof.has_noise_at_rest = true;
  v.ablation = {{"load_dep_friction instead of coulomb_friction", 0.0081},
                {"quadratic_drag instead of coulomb_friction", 0.071},
                {"without coulomb_friction", 0.091}};
  v.evaluation.residual.is_white = true;
  v.evidence = {{"coulomb_friction", "Coulomb friction", 14.8, 13.1, 16.4},
                {"load_dep_friction", "Friction that follows the load", 14.4, 12.8, 16.0},
                {"stribeck_breakaway", "Friction with breakaway", 14.1, 12.2, 15.8},
                {"transducer_backlash", "Play of the transducer", 6.2, 5.0, 7.3},
                {"quadratic_drag", "Quadratic drag", 1.3, 0.7, 1.9},
                {"platen_inertia", "Inertia of the platen", 0.01, -0.04, 0.06}};
  v.limits = {"No vertical force was recorded: friction that follows it cannot be distinguished.",
              "Displacements above 0.17 m were never visited.",
              "The noise was estimated from a rest interval of 1.1 s."};
  v.next.text = "empty table, sine of 0.5 Hz, ±120 mm, at vertical loads of 0.5, 1 and 1.6";
  v.improvement.fragment =
      "# found by rths diagnose; omitted in the simulation\n[coulomb_friction]\n"
      "friction_force_N = 41_200\npresliding_velocity_m_per_s = 0.0204\n";
  return v;
}

Verdict none_verdict() {
  Verdict v = common("guides of a table, lubricated");
  v.conclusion.outcome = Outcome::None;
  v.conclusion.confidence = 0.97;
  v.sentence =
      "Nothing is missing: the residual on the unseen record is noise (error 0.6 %, noise floor "
      "0.6 "
      "%; confidence 0.97).";
  v.evaluation.traces = {trace("petrolia.csv", 1.1, base_law, base_law, base_law)};
  v.evaluation.fit = {{"petrolia.csv", "held_out", 0.0061, 0.0061, 0.0061, 0.0060, 1.01, 1.01}};
  v.evaluation.proof = {0.0061, 0.0061, 0.0060, 0};
  v.evaluation.residual.is_white = true;
  v.evidence = {{"quadratic_drag", "Quadratic drag", 0.003, -0.004, 0.01},
                {"coulomb_friction", "Coulomb friction", 0.001, -0.006, 0.008}};
  v.limits = {"Displacements above 0.17 m were never visited."};
  return v;
}

Verdict unknown_verdict() {
  const Law truth = [](double u, double v) {
    return base_law(u, v) + 3e4 * std::sin(2 * M_PI * u / 0.06);
  };
  Verdict v = common("guides of a table, cogging");
  v.conclusion.outcome = Outcome::Unknown;
  v.conclusion.confidence = 0.94;
  v.conclusion.has_remainder = true;
  v.sentence =
      "Unknown: none of the terms that were searched explains the residual; a force that depends "
      "on displacement, f(u), explains 93 % of it (confidence 0.94). Next test: a triangle of "
      "20 mm/s on the empty table shows whether it is the machine's.";
  v.evaluation.traces = {trace("northridge.csv", 0, truth, base_law, base_law),
                         trace("petrolia.csv", 1.1, truth, base_law, base_law)};
  v.conclusion.where = where_of(v.evaluation.traces[0], motion(0));
  v.evaluation.fit = {{"northridge.csv", "fit", 0.066, 0.066, 0.069, 0.006, 17.2, 17.2},
                      {"petrolia.csv", "held_out", 0.068, 0.068, 0.07, 0.006, 18.1, 18.1}};
  v.evaluation.proof = {0.068, 0.068, 0.006, 0, true};
  Description curve{"f(u)", 0.93, "displacement [m]", {}, {}, {}};
  for (double u = -0.16; u <= 0.161; u += 0.004) {
    curve.x.push_back(u);
    curve.y.push_back(3e4 * std::sin(2 * M_PI * u / 0.06) * (1 - 0.5 * u));
    curve.band.push_back(900 + 2e5 * u * u);
  }
  v.descriptions = {curve, {"sgn(v) g(u)", 0.21, "", {}, {}, {}}, {"f(t)", 0.04, "", {}, {}, {}}};
  v.evidence = {{"cubic_stiffness", "Cubic stiffness", 0.05, -0.02, 0.12},
                {"coulomb_friction", "Coulomb friction", 0.01, -0.06, 0.08}};
  v.evaluation.residual.correlation = {};
  for (int lag = 1; lag <= 40; ++lag)
    v.evaluation.residual.correlation.push_back(0.8 * std::exp(-lag / 25.0) * std::cos(lag / 4.0));
  v.limits = {"No acceleration was recorded: inertia cannot be distinguished from stiffness."};
  v.next.text = "empty table, triangle of 20 mm/s";
  return v;
}

budget::ResponseBands example_bands() {
  budget::ResponseBands bands;
  bands.peaks = {{"displacement.long", "m", 0.2125, 0.2085, 0.2165},
                 {"force.long", "N", 1.91e6, 1.88e6, 1.94e6}};
  bands.frequencies = {0.5, 2, 8};
  bands.damping_ratio = 0.05;
  bands.spectra = {{"containment", {1.5, 4.25, 3}, {1.4, 4, 0}, {1.6, 4.5, 6}}};
  bands.runs = 21;
  bands.has_remainder = true;
  return bands;
}

}  // namespace rths::report::test_support
