// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <string>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>
#include <rths/launch/run.hpp>

#include "host_link.hpp"

namespace rths::launch {

/// The order of the steps of all hosts in virtual time. Each node writes the number of its steps
/// after the results of its step, so a host that reads this number has the results.
class Turns {
 public:
  Turns(broker::Ring& ring, const Experiment& experiment, HostLink& link);

  /// Result of the next step of a node of another host.
  struct Waited {
    std::optional<Status> status;  ///< empty: the other host did not make the step
    std::string trouble;           ///< why
  };
  [[nodiscard]] Waited wait_for(const std::string& node);
  /// Tells the other hosts that a node of this host made its step.
  void pass_on(broker::Node& writer, const std::string& node, Status status);

 private:
  struct Turn {
    LongwordOffset word;
    std::uint32_t steps = 0;
  };
  broker::Node reader_;
  broker::Waiter waiter_;
  HostLink& link_;
  std::map<std::string, Turn> turns_;  ///< by node
};

}  // namespace rths::launch
