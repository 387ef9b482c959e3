// SPDX-License-Identifier: Apache-2.0
#include <rths/dds/gateway.hpp>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>

#include "inbox.hpp"
#include "outbox.hpp"
#include "shared.hpp"

namespace rths::dds {
namespace {

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

// One more than the largest NodeId.
std::size_t ids_of(const memmap::Map& map) {
  std::size_t ids = 0;
  for (const auto& node : map.description().nodes)
    ids = std::max<std::size_t>(ids, node.id.value() + 1U);
  return ids;
}

}  // namespace

struct Gateway::State {
  State(const std::string& ring, std::unique_ptr<Carrier> with, GatewayOptions options)
      : carrier{std::move(with)} {
    shared.host = carrier->id();
    shared.options = std::move(options);
    shared.carrier = carrier.get();
    const auto attached = broker::Ring::attach(ring);
    shared.map_hash = attached.map().hash();
    shared.is_remote = std::vector<std::atomic<bool>>(ids_of(attached.map()));
    cards = std::make_unique<Cards>(attached, ring);
    shared.cards = cards.get();
    outbox = std::make_unique<Outbox>(ring, shared);
    shared.sender = &outbox->waiter();
    shared.reader = &outbox->reader();
    inbox = std::make_unique<Inbox>(ring, shared);
    sender = std::thread{[this] { outbox->run(); }};
    receiver = std::thread{[this] { inbox->run(); }};
    keeper = std::thread{[this] { Contact{shared}.run(); }};
  }
  ~State() {
    shared.ends = true;
    keeper.join();
    sender.join();
    receiver.join();
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  std::unique_ptr<Carrier> carrier;
  Shared shared;
  std::unique_ptr<Cards> cards;
  std::unique_ptr<Outbox> outbox;
  std::unique_ptr<Inbox> inbox;
  std::thread sender, receiver, keeper;
};

Gateway::Gateway(const std::string& ring, std::unique_ptr<Carrier> carrier, GatewayOptions options)
    : state_{std::make_unique<State>(ring, std::move(carrier), std::move(options))} {}
Gateway::~Gateway() = default;

GatewayCounts Gateway::counts() const {
  const auto& c = state_->shared.counts;
  return {c.frames_sent,
          c.updates_sent,
          c.frames_received,
          c.updates_received,
          c.bad_frames,
          c.repeated,
          c.gaps,
          c.sent_again,
          c.snapshots,
          c.mismatches,
          c.lapped,
          c.interrupts_sent,
          c.interrupts_lost,
          c.hold_off_ns,
          c.rejoins};
}

GatewayStatus Gateway::status() const {
  const std::lock_guard lock{state_->shared.mutex};
  return state_->shared.status;
}

}  // namespace rths::dds
