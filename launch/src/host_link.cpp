// SPDX-License-Identifier: Apache-2.0
#include "host_link.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <thread>

#include <fmt/format.h>
#include <xxhash.h>

#include <rths/core/error.hpp>

#include "run_modes.hpp"

namespace rths::launch {
namespace {

constexpr Duration kHostPoll = std::chrono::milliseconds{20};
constexpr Duration kFreshWords = std::chrono::milliseconds{500};
constexpr Duration kSignOfLife = std::chrono::milliseconds{200};  // several announcements
constexpr Duration kLongestHostSilence = std::chrono::milliseconds{800};
constexpr Duration kLongestVirtualSilence = std::chrono::seconds{10};
constexpr std::size_t kTextAt = 6;  // longword of the text

using Words = std::array<std::uint32_t, kLauncherLongwords>;

// Another program may have written the words.
HostState state_of(std::uint32_t word) {
  return word <= static_cast<std::uint32_t>(HostState::StoppedEarly) ? static_cast<HostState>(word)
                                                                     : HostState::Absent;
}

bool has_ended(HostState state) {
  return state == HostState::Completed || state == HostState::Failed;
}

// Of all input of a test: hosts with other files would run another test.
std::uint64_t fingerprint_of(const Experiment& experiment) {
  std::uint64_t hash = 0;
  const auto add = [&](const void* bytes, std::size_t size) {
    hash = XXH3_64bits_withSeed(bytes, size, hash);
  };
  for (const auto& [name, text] : experiment.texts()) add(text.data(), text.size());
  const auto& motion = experiment.earthquake.motion;
  for (const auto* values : {&motion.long_acceleration, &motion.lat_acceleration})
    add(values->data(), values->size() * sizeof(double));
  return hash;
}

}  // namespace

dds::CycloneOptions network_of(const Experiment& experiment, const RunOptions& options) {
  dds::CycloneOptions network;
  network.domain = experiment.network.domain;
  network.ring = experiment.name;
  network.host = options.host;
  for (const auto& host : experiment.network.hosts) {
    if (host.name == options.host)
      network.interface = options.interface.empty() ? host.interface : options.interface;
    else if (!host.address.empty())
      network.peers.push_back(host.address);
  }
  return network;
}

HostLink::HostLink(broker::Ring& ring, const Experiment& experiment, const RunOptions& options)
    : experiment_{experiment},
      own_{options.host},
      leader_{experiment.leading_host()},
      fingerprint_{fingerprint_of(experiment)},
      longest_silence_{options.clock == ClockKind::Virtual ? kLongestVirtualSilence
                                                           : kLongestHostSilence},
      node_{ring.join(launcher_node(own_), 0)},
      group_{ring.tear_group(launcher_partition(own_))} {
  for (const auto& host : experiment.network.hosts)
    if (host.name != own_)
      others_.push_back({host.name, ring.tear_group(launcher_partition(host.name)), 0, {}});
  dds::GatewayOptions gateway;
  gateway.host = own_;
  gateway.report = options.report;
  gateway.is_deterministic = options.clock == ClockKind::Virtual;
  // Below the nodes, above everything else: other processes must not delay the updates.
  if (!gateway.is_deterministic) gateway.prepare_thread = [] { prefer_realtime(kGatewayPriority); };
  publish(HostState::Starting);
  gateway_ = std::make_unique<dds::Gateway>(
      options.ring, dds::make_cyclone_carrier(network_of(experiment, options)), gateway);
}

void HostLink::publish(HostState state, const std::string& text, TimePoint epoch) {
  Words words{};
  const auto length = std::min(text.size(), 4 * (words.size() - kTextAt));
  const std::int64_t time = epoch.count();
  words[0] = static_cast<std::uint32_t>(state);
  std::memcpy(&words[1], &time, sizeof time);
  std::memcpy(&words[3], &fingerprint_, sizeof fingerprint_);
  words[5] = static_cast<std::uint32_t>(length);
  std::memcpy(&words[kTextAt], text.data(), length);
  static_cast<void>(node_.write_group(group_, words));
}

HostLink::Published HostLink::published_by(const Other& other) {
  Words words{};
  if (node_.read_group(other.group, words) != Status::Ok) return {};
  std::int64_t time = 0;
  std::memcpy(&time, &words[1], sizeof time);
  const std::size_t length = std::min<std::size_t>(words[5], 4 * (words.size() - kTextAt));
  Published published{state_of(words[0]), TimePoint{time}, 0, std::string(length, '\0')};
  std::memcpy(&published.fingerprint, &words[3], sizeof published.fingerprint);
  std::memcpy(published.text.data(), &words[kTextAt], length);
  std::replace_if(
      published.text.begin(), published.text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return published;
}

bool HostLink::has_all_nodes() const {
  const auto status = gateway_->status();
  return std::all_of(experiment_.nodes.begin(), experiment_.nodes.end(), [&](const auto& plan) {
    return plan.host == own_ ||
           std::any_of(status.nodes.begin(), status.nodes.end(), [&](const auto& node) {
             return node.node == plan.node && node.host == plan.host && node.age < kFreshWords;
           });
  });
}

bool HostLink::are_all_ready() {
  return std::all_of(others_.begin(), others_.end(), [&](const auto& other) {
    const auto state = published_by(other).state;
    return state == HostState::Ready || (other.name == leader_ && state == HostState::Going);
  });
}

void HostLink::compare_fingerprints() {
  for (const auto& other : others_) {
    const auto published = published_by(other);
    if (published.state != HostState::Absent && published.fingerprint != fingerprint_)
      throw Error{
          fmt::format("host '{}' runs another experiment, expected the same files and --set there",
                      other.name)};
  }
}

std::string HostLink::missing_hosts() {
  std::string missing;
  for (const auto& other : others_)
    if (published_by(other).state != HostState::Ready)
      missing += fmt::format("{}'{}'", missing.empty() ? "" : ", ", other.name);
  return missing;
}

void HostLink::wait_until_ready(const std::function<bool()>& look) {
  const TimePoint deadline = clock_.now() + from_seconds(experiment_.network.deadline);
  bool is_ready = false;
  while (!is_ready || !are_all_ready()) {
    if (look()) return;
    if (!is_ready && has_all_nodes()) {
      publish(HostState::Ready);
      is_ready = true;
    }
    compare_fingerprints();
    if (const auto failed = failures(); !failed.empty()) throw Error{failed};
    if (clock_.now() > deadline)
      throw Error{fmt::format(
          "host {} not ready after {:g} s, expected `rths run {} --host …` there", missing_hosts(),
          experiment_.network.deadline, experiment_.file.filename().string())};
    std::this_thread::sleep_for(kHostPoll);
  }
}

std::optional<TimePoint> HostLink::epoch() {
  const auto leader = std::find_if(others_.begin(), others_.end(),
                                   [&](const auto& other) { return other.name == leader_; });
  if (leader == others_.end()) return std::nullopt;
  const auto published = published_by(*leader);
  if (published.state != HostState::Going) return std::nullopt;
  for (const auto& host : gateway_->status().hosts)
    if (host.name == leader_ && host.clock) return published.epoch - host.clock->offset;
  return std::nullopt;
}

std::optional<std::string> HostLink::find_trouble() {
  const auto status = gateway_->status();
  for (auto& other : others_) {
    const auto published = published_by(other);
    if (published.state == HostState::Failed || !published.text.empty())
      return fmt::format("host '{}' stopped the test: {}", other.name, published.text);
    if (has_ended(published.state)) continue;
    const bool has_announced = std::any_of(
        status.hosts.begin(), status.hosts.end(),
        [&](const auto& host) { return host.name == other.name && host.silence < kSignOfLife; });
    if (has_announced) ++other.signs;
    if (other.silence.look(clock_.now(), other.signs) > longest_silence_)
      return fmt::format("host '{}' is silent", other.name);
  }
  return std::nullopt;
}

bool HostLink::is_test_over() {
  return std::any_of(others_.begin(), others_.end(), [&](const auto& other) {
    const auto published = published_by(other);
    return published.text.empty() &&
           (published.state == HostState::Stopping || published.state == HostState::Completed);
  });
}

bool HostLink::is_stopped_early() {
  return std::any_of(others_.begin(), others_.end(), [&](const auto& other) {
    return published_by(other).state == HostState::StoppedEarly;
  });
}

std::string HostLink::failures() {
  for (const auto& other : others_) {
    const auto published = published_by(other);
    if (published.state == HostState::Failed)
      return fmt::format("host '{}': {}", other.name, published.text);
  }
  return "";
}

void HostLink::wait_until_ended(Duration longest) {
  const TimePoint deadline = clock_.now() + longest;
  const auto is_active = [&](const auto& other) {
    const auto status = gateway_->status();
    return !has_ended(published_by(other).state) &&
           std::any_of(status.hosts.begin(), status.hosts.end(),
                       [&](const auto& host) { return host.name == other.name; });
  };
  while (clock_.now() < deadline && std::any_of(others_.begin(), others_.end(), is_active))
    std::this_thread::sleep_for(kHostPoll);
  // The others wait for our last words in the same way.
  std::this_thread::sleep_for(3 * kHostPoll);
}

}  // namespace rths::launch
