// SPDX-License-Identifier: Apache-2.0
//
// A run in virtual time, and the hybrid test that a budget repeats.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <rths/app/builtin_adapters.hpp>
#include <rths/launch/run.hpp>
#include <rths/session/hybrid_test.hpp>

#include "support/files.hpp"

namespace rths::test {

inline double apart(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, all = 0;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    difference += (a[i] - b[i]) * (a[i] - b[i]);
    all += a[i] * a[i];
  }
  return std::sqrt(difference / all);
}

/// The example for ten seconds in virtual time, with or without noise of the sensors.
class ClosedLoop : public ::testing::Test {
 protected:
  void make(bool has_noise, std::vector<std::pair<std::string, std::string>> changes = {},
            const std::function<Duration(const std::string&, Duration)>& lateness = {}) {
    changes.insert(changes.end(), {{"duration_s", "10"}, {"rest_s", "0.5"}});
    if (!has_noise)
      for (const char* sensor :
           {"displacement_noise_m", "force_noise_N", "acceleration_noise_m_per_s2"})
        changes.emplace_back(std::string{"machine."} + sensor, "0");
    experiment = app::load_experiment(source, changes);
    launch::RunOptions options;
    options.clock = launch::ClockKind::Virtual;
    options.recording = folder / "run.h5";
    options.lateness = lateness;
    const launch::RunOutcome outcome = launch::run(experiment, options);
    ASSERT_TRUE(outcome.completed) << outcome.trouble;
    const recording::Reader run{options.recording};
    hybrid = session::hybrid_test_of(experiment, run);
    measured = session::response_of(experiment, run);
    force = session::fed_force_of(experiment, run);
    // The laboratory itself takes the place of what would be identified.
    hybrid.specimen_identified = experiment.specimen;
    hybrid.machine_identified = experiment.machine.simulated;
    if (has_noise)
      hybrid.noise = budget::sensor_noise(
          hybrid, {session::transfer_record_of(experiment.roles, run, "long", hybrid.host.order),
                   session::transfer_record_of(experiment.roles, run, "lat", hybrid.host.order)});
  }
  // Specimen and machine as the laboratory has them; the transfer system is identified.
  [[nodiscard]] experiment::Experiment as_in_the_laboratory() const {
    auto improved = experiment;
    improved.model.bearing = experiment.specimen;
    improved.model.machine = experiment.machine.simulated;
    return improved;
  }
  [[nodiscard]] double difference(const budget::Response& response) const {
    return std::max(apart(measured[0], response[0]), apart(measured[1], response[1]));
  }

  std::filesystem::path source = source_tree() / "examples/srmd_lprb_2d.toml";
  const TemporaryFolder temporary;
  const std::filesystem::path& folder = temporary.path();
  experiment::Experiment experiment;
  budget::HybridTest hybrid;
  budget::Response measured;
  std::array<std::vector<double>, 2> force;
};

}  // namespace rths::test
