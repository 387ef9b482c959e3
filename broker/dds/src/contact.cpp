// SPDX-License-Identifier: Apache-2.0
#include "contact.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::dds {
namespace {

constexpr Duration kLookPeriod = std::chrono::milliseconds{50};
/// After a longer pause of this process, it judges nobody at first.
constexpr Duration kLongestPause = std::chrono::milliseconds{500};
/// Longer than the lease of a participant: a host that died is not announced any more by then.
constexpr Duration kLongestSilence = std::chrono::milliseconds{2500};
/// Longer: the other host joins anew first, as it does not hear this one.
constexpr Duration kLongestUnconfirmed = std::chrono::milliseconds{3500};
constexpr Duration kFresh = std::chrono::seconds{1};
constexpr Duration kJitter = std::chrono::milliseconds{300};
constexpr int kQuickAttempts = 3;
constexpr int kMostDoublings = 10;  // 43 min

}  // namespace

void Contact::run() {
  joined_ = looked_ = clock_.now();
  while (!shared_.ends.load(std::memory_order_relaxed)) {
    std::this_thread::sleep_for(kLookPeriod);
    look(clock_.now());
  }
}

void Contact::look(TimePoint now) {
  if (now - looked_ > kLongestPause) joined_ = now;
  looked_ = now;
  const std::string reason = trouble(now);
  if (!reason.empty() && now >= next_) return rejoin(reason);
  if (is_in_contact_ || (reason.empty() && now - joined_ > kLongestUnconfirmed)) {
    attempts_ = 0;
    is_reported_ = false;
  }
}

std::string Contact::trouble(TimePoint now) {
  if (is_off_) return "the network could not be joined";
  AllHeard heard;
  {
    const std::lock_guard lock{shared_.mutex};
    heard = shared_.heard;
  }
  const auto silent = silent_host(heard, now);
  is_in_contact_ = are_all_in_contact(heard);
  if (!silent.empty())
    return fmt::format("no frames of host '{}' arrive, although it is on the network", silent);
  if (const auto host = deaf_host(heard, now); !host.empty())
    return fmt::format("host '{}' receives no frames of this host", host);
  return "";
}

std::string Contact::silent_host(const AllHeard& heard, TimePoint now) {
  std::map<HostId, TimePoint> present;
  std::string silent;
  for (const auto& host : shared_.carrier->present()) {
    const auto known = present_.find(host.id);
    const TimePoint since = known == present_.end() ? now : known->second;
    present[host.id] = since;
    const auto found = heard.find(host.id);
    const TimePoint last = found == heard.end() ? since : found->second.last;
    if (now - std::max(last, joined_) > kLongestSilence) silent = printable(host.host);
  }
  present_ = std::move(present);
  return silent;
}

bool Contact::are_all_in_contact(const AllHeard& heard) const {
  return !present_.empty() && std::all_of(present_.begin(), present_.end(), [&](const auto& host) {
    const auto found = heard.find(host.first);
    return found != heard.end() && found->second.last > joined_ &&
           (found->second.came == TimePoint{0} || found->second.reached > joined_);
  });
}

std::string Contact::deaf_host(const AllHeard& heard, TimePoint now) const {
  for (const auto& [id, host] : heard)
    if (host.came != TimePoint{0} && now - host.last < kFresh &&
        now - std::max({host.came, host.reached, joined_}) > kLongestUnconfirmed)
      return host.name;
  return "";
}

// Each attempt interrupts the contact with all hosts, so attempts become rare if they do not help:
// the reason may be a firewall. New damage can spoil each attempt, so it justifies another one.
void Contact::rejoin(const std::string& reason) {
  if (!is_reported_) shared_.report(fmt::format("{}; this host joins the network anew", reason));
  is_reported_ = true;
  attempts_ = shared_.carrier->damaged() == damaged_ && !is_off_ ? attempts_ + 1 : 1;
  ++shared_.counts.rejoins;
  try {
    shared_.carrier->rejoin();
    is_off_ = false;
  } catch (const Error& error) {
    if (!std::exchange(is_off_, true)) shared_.report(error.what());
  }
  damaged_ = shared_.carrier->damaged();
  joined_ = looked_ = clock_.now();
  const int doublings = std::clamp(attempts_ - kQuickAttempts, 0, kMostDoublings);
  const Duration jitter{std::uniform_int_distribution<Duration::rep>{0, kJitter.count()}(random_)};
  next_ = joined_ + kLongestSilence * (1 << doublings) + jitter;
}

}  // namespace rths::dds
