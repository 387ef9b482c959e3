// SPDX-License-Identifier: Apache-2.0
#include "hybrid_test.hpp"

#include <algorithm>
#include <cmath>

#include "actuator.hpp"
#include "structure.hpp"

namespace trial {
namespace {

constexpr double kStep = kSampleTime / static_cast<double>(kSubsteps);

template <class Sample>
double peak(const std::vector<Sample>& samples, double (*size)(const Sample&)) {
  double largest = 0;
  for (const Sample& sample : samples) largest = std::max(largest, size(sample));
  return largest;
}

// Noise of a quantity's two channels.
struct Pair {
  Pair(const NoiseColour& colour, Random& random)
      : noise{Noise{colour, kSampleTime, random}, Noise{colour, kSampleTime, random}} {}
  Plane next(Random& random) { return {noise[0].next(random), noise[1].next(random)}; }
  std::array<Noise, 2> noise;
};

Plane sampled(const Plane& value, const Plane& noise, double resolution) {
  return {quantised(value[0] + noise[0], resolution), quantised(value[1] + noise[1], resolution)};
}

class Laboratory {
 public:
  Laboratory(const Physics& physics, const ChannelNoise& noise, Random random)
      : physics_(physics),
        random_(random),
        displacement_(noise.displacement, random_),
        acceleration_(noise.acceleration, random_),
        force_(noise.force, random_),
        axial_load_(noise.axial_load, kSampleTime, random_),
        actuator_(physics, kStep),
        bearing_(physics, kStep),
        platen_(physics),
        load_cell_(physics, kStep) {}

  Record run(const Excitation& excitation);

 private:
  void sample(Record& record);
  void advance(const Excitation& excitation, std::size_t tick);
  void step(const Plane& ground, const Plane& reference, double axial_load);

  Physics physics_;
  Random random_;
  Pair displacement_, acceleration_, force_;
  Noise axial_load_;
  Actuator actuator_;
  Bearing bearing_;
  Platen platen_;
  LoadCell load_cell_;
  Structure structure_;
  Boundary now_;
  Plane command_{}, last_command_{}, load_{}, feedback_{};
};

void Laboratory::sample(Record& record) {
  const Plane u_noise = displacement_.next(random_), a_noise = acceleration_.next(random_);
  const Plane f_noise = force_.next(random_);
  const Physics& p = physics_;
  const Plane force = load_cell_.recorded(), acceleration = accelerometer(p, now_);
  record.truth.push_back(now_);
  record.load.push_back(load_);
  record.fine_displacement.push_back(sampled(now_.displacement, u_noise, kDisplacementResolution));
  record.fine_acceleration.push_back(sampled(acceleration, a_noise, kAccelerationResolution));
  record.fine_force.push_back(sampled(force, f_noise, kForceResolution));
  record.axial_load.push_back(
      quantised(now_.axial_load + axial_load_.next(random_), kAxialResolution));
  // Coarse steps replace the default resolution: no value is rounded twice.
  record.displacement.push_back(p[kDisplacementStep] > 0
                                    ? sampled(now_.displacement, u_noise, p[kDisplacementStep])
                                    : record.fine_displacement.back());
  record.acceleration.push_back(p[kAccelerationStep] > 0
                                    ? sampled(acceleration, a_noise, p[kAccelerationStep])
                                    : record.fine_acceleration.back());
  record.force.push_back(p[kForceStep] > 0 ? sampled(force, f_noise, p[kForceStep])
                                           : record.fine_force.back());
  // The controller subtracts its own estimate of the platen's inertia force.
  for (std::size_t i = 0; i < 2; ++i)
    feedback_[i] =
        load_cell_.undelayed()[i] + f_noise[i] - kPlatenMass[i] * (acceleration[i] + a_noise[i]);
}

void Laboratory::step(const Plane& ground, const Plane& reference, double axial_load) {
  if (now_.time >= kQuietTime) structure_.advance(feedback_, ground, kStep);
  actuator_.advance(reference, load_);
  now_.time += kStep;
  now_.displacement = actuator_.platen().displacement;
  now_.velocity = actuator_.platen().velocity;
  now_.acceleration = actuator_.platen().acceleration;
  now_.axial_load = axial_load;
  const Plane bearing = bearing_.advance(now_);
  const Plane machine = platen_.advance(now_);
  const Plane force{bearing[0] + machine[0], bearing[1] + machine[1]};
  for (std::size_t i = 0; i < 2; ++i) {
    const double mass = kPlatenMass[i] * (1 + physics_[kMassErrorX + i]);
    load_[i] = force[i] - mass * now_.acceleration[i];
  }
  load_cell_.advance(force, now_);
}

void Laboratory::advance(const Excitation& excitation, std::size_t tick) {
  const std::size_t next = std::min(tick + 1, kSamples - 1);
  for (std::size_t k = 0; k < kSubsteps; ++k) {
    const double share = static_cast<double>(k + 1) / static_cast<double>(kSubsteps);
    const auto between = [&](double from, double to) { return from + share * (to - from); };
    const Plane ground{between(excitation.ground[tick][0], excitation.ground[next][0]),
                       between(excitation.ground[tick][1], excitation.ground[next][1])};
    const Plane reference{between(last_command_[0], command_[0]),
                          between(last_command_[1], command_[1])};
    step(ground, reference, between(excitation.axial_load[tick], excitation.axial_load[next]));
  }
}

Record Laboratory::run(const Excitation& excitation) {
  Record record;
  for (std::size_t tick = 0; tick < kSamples; ++tick) {
    now_.time = static_cast<double>(tick) * kSampleTime;
    sample(record);
    last_command_ = command_;
    if (now_.time >= kQuietTime) command_ = compensated(structure_);
    record.command.push_back(command_);
    advance(excitation, tick);
  }
  return record;
}

// The amplifier holds its last value at random times.
void drop_out(double length, Random random, std::vector<Plane>& force) {
  if (length <= 0) return;
  constexpr int kTimes = 20;
  const std::size_t held = static_cast<std::size_t>(length / kSampleTime);
  for (int i = 0; i < kTimes; ++i) {
    const std::size_t start =
        static_cast<std::size_t>(random.uniform(kQuietTime, kRecordLength - 1) / kSampleTime);
    for (std::size_t k = 1; k <= held; ++k) force[start + k] = force[start];
  }
}

}  // namespace

double Record::peak_displacement() const {
  return peak<Boundary>(
      truth, [](const Boundary& b) { return std::hypot(b.displacement[0], b.displacement[1]); });
}

double Record::peak_speed() const {
  return peak<Boundary>(truth, [](const Boundary& b) {
    return std::max(std::abs(b.velocity[0]), std::abs(b.velocity[1]));
  });
}

double Record::peak_force() const {
  return peak<Plane>(fine_force,
                     [](const Plane& f) { return std::max(std::abs(f[0]), std::abs(f[1])); });
}

Record run_test(const Excitation& excitation, const Physics& physics, const ChannelNoise& noise,
                Random random) {
  Record record = Laboratory{physics, noise, random}.run(excitation);
  drop_out(physics[kDropout], random, record.force);
  return record;
}

}  // namespace trial
