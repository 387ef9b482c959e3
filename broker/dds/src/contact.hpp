// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <random>
#include <string>

#include <rths/core/clock.hpp>

#include "shared.hpp"

namespace rths::dds {

/// Sees whether frames pass in both directions between this host and every other host that the
/// network announces. If they stay away, it joins the network anew: a damaged datagram with a valid
/// checksum can spoil the records that DDS has of another host, for good. One thread.
class Contact {
 public:
  explicit Contact(Shared& shared) : shared_{shared} {}
  /// Until the gateway ends.
  void run();

 private:
  using AllHeard = std::map<HostId, Heard>;
  void look(TimePoint now);
  /// Why to join anew; empty if there is no reason.
  [[nodiscard]] std::string trouble(TimePoint now);
  /// A host that the network announces and of which nothing arrives; empty if there is none.
  [[nodiscard]] std::string silent_host(const AllHeard& heard, TimePoint now);
  /// A host that does not confirm what this one sends; empty if there is none.
  [[nodiscard]] std::string deaf_host(const AllHeard& heard, TimePoint now) const;
  /// True if frames have passed in both directions since this host joined.
  [[nodiscard]] bool are_all_in_contact(const AllHeard& heard) const;
  void rejoin(const std::string& reason);

  Shared& shared_;
  WallClock clock_;
  std::minstd_rand random_{std::random_device{}()};
  std::map<HostId, TimePoint> present_;  ///< hosts, since when
  TimePoint looked_{0};
  TimePoint joined_{0};         ///< silence counts from here on
  TimePoint next_{0};           ///< not again before
  int attempts_ = 0;            ///< since all hosts were in contact or a datagram was damaged
  std::uint64_t damaged_ = 0;   ///< datagrams until the last attempt
  bool is_in_contact_ = false;  ///< with all hosts, since it joined
  bool is_reported_ = false;    ///< since all hosts were in contact
  bool is_off_ = false;         ///< the last attempt failed
};

}  // namespace rths::dds
