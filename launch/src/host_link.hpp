// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/dds/gateway.hpp>
#include <rths/launch/run.hpp>

#include "run_modes.hpp"
#include "silence.hpp"

namespace rths::launch {

/// The link of a launcher to those of the other hosts of a test: a gateway, and the words through
/// which the launchers start and stop the test together. One thread.
class HostLink {
 public:
  /// @param ring  of this host, with the map of the test
  /// @throws Error if the gateway cannot start   @setup
  HostLink(broker::Ring& ring, const Experiment& experiment, const RunOptions& options);

  /// Publishes the state of the test on this host.
  void publish(HostState state, const std::string& text = "", TimePoint epoch = TimePoint{0});
  /// Waits until every host has all nodes of the test on its ring.
  /// @param look  called several times per second; returns true to give up
  /// @throws Error if another host ended, or did not come in time
  void wait_until_ready(const std::function<bool()>& look);

  [[nodiscard]] bool is_leader() const { return leader_ == own_; }
  /// The common time zero on this host's clock, once the leading host has set it.
  [[nodiscard]] std::optional<TimePoint> epoch();
  /// Why the test cannot go on: another host stopped it, or is silent.
  [[nodiscard]] std::optional<std::string> find_trouble();
  /// True if another host has ended the test in order.
  [[nodiscard]] bool is_test_over();
  /// True if another host ends it before its time, because a person asked it to.
  [[nodiscard]] bool is_stopped_early();
  /// Why the other hosts failed; empty if none did.
  [[nodiscard]] std::string failures();
  /// Waits until the other hosts have ended or are silent, so that they get the last words.
  void wait_until_ended(Duration longest);

 private:
  struct Other {
    std::string name;
    TearGroupId group;
    std::uint64_t signs = 0;  ///< of life, counted by looks
    Silence silence = {};
  };
  struct Published {
    HostState state = HostState::Absent;
    TimePoint epoch{0};
    std::uint64_t fingerprint = 0;
    std::string text;
  };
  [[nodiscard]] Published published_by(const Other& other);
  /// True if all nodes of other hosts are on this ring with all their words.
  [[nodiscard]] bool has_all_nodes() const;
  [[nodiscard]] bool are_all_ready();
  /// @throws Error if another host has other input files
  void compare_fingerprints();
  /// Names of the hosts that are not ready.
  [[nodiscard]] std::string missing_hosts();

  const Experiment& experiment_;
  std::string own_, leader_;
  std::uint64_t fingerprint_;
  Duration longest_silence_;
  broker::Node node_;
  TearGroupId group_;
  std::vector<Other> others_;
  std::unique_ptr<dds::Gateway> gateway_;
  WallClock clock_;
};

/// Settings of DDS for this host of a test.
[[nodiscard]] dds::CycloneOptions network_of(const Experiment& experiment,
                                             const RunOptions& options);

}  // namespace rths::launch
