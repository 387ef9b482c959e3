// SPDX-License-Identifier: Apache-2.0
#include "inbox.hpp"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::dds {
namespace {

constexpr Duration kTickPeriod = std::chrono::milliseconds{5};
constexpr Duration kPatience = std::chrono::milliseconds{10};
constexpr Duration kSilence = std::chrono::seconds{1};  // then a host is not listed any more
constexpr std::size_t kMostRemoteHosts = 64;
constexpr std::size_t kMostVisitors = 16;
constexpr std::size_t kMostHeard = 1024;
constexpr Duration kStatusPeriod = std::chrono::milliseconds{10};
constexpr Duration kLost = std::chrono::seconds{10};
constexpr Duration kWrongClock = std::chrono::seconds{1};

}  // namespace

Inbox::Inbox(const std::string& ring, Shared& shared)
    : shared_{shared},
      ring_{broker::Ring::attach(ring)},
      signals_{ring_, shared.options.is_deterministic ? "" : shared.options.host} {}

void Inbox::run() {
  shared_.carrier->listen([this](std::span<const std::byte> bytes) {
    thread_local const Inbox* prepared_for = nullptr;
    if (std::exchange(prepared_for, this) != this && shared_.options.prepare_thread)
      shared_.options.prepare_thread();
    const std::lock_guard lock{mutex_};
    now_ = clock_.now();
    receive(bytes);
  });
  while (!shared_.ends.load(std::memory_order_relaxed)) {
    std::this_thread::sleep_for(kTickPeriod);
    const std::lock_guard lock{mutex_};
    tick(clock_.now());
  }
  shared_.carrier->listen({});
}

void Inbox::bad_frame(const std::string& reason) {
  ++shared_.counts.bad_frames;
  if (reported_.insert(reason).second) shared_.report(reason);
}

Inbox::Stream* Inbox::stream_of(const Frame& frame) {
  const auto found = streams_.find(frame.header.node);
  return found == streams_.end() || found->second->host != frame.header.host ? nullptr
                                                                             : found->second.get();
}

void Inbox::receive(std::span<const std::byte> bytes) {
  FrameDefect defect{};
  const auto frame = decode(bytes, defect);
  if (!frame) return bad_frame(fmt::format("a frame was dropped: {}", to_text(defect)));
  if (frame->header.host == shared_.host) return;
  if (frame->header.map_hash == 0) return receive_visitor(*frame);
  note_arrival(frame->header.host);
  if (frame->header.map_hash != shared_.map_hash) {
    const auto hello =
        frame->header.kind == FrameKind::Hello ? hello_from(frame->payload) : std::nullopt;
    if (!hello) return;
    return bad_frame(fmt::format("host '{}' has another map: its hash is {}, ours {}", hello->host,
                                 memmap::hash_text(frame->header.map_hash),
                                 memmap::hash_text(shared_.map_hash)));
  }
  ++shared_.counts.frames_received;
  if (frame->header.kind == FrameKind::Hello) return receive_hello(*frame);
  if (frame->header.kind == FrameKind::Request) return receive_request(*frame);
  Stream* const stream = stream_of(*frame);
  if (stream == nullptr) return;  // of a host or node that is not announced yet
  if (frame->header.kind == FrameKind::Updates) receive_updates(*stream, *frame, bytes);
  if (frame->header.kind == FrameKind::Snapshot) receive_snapshot(*stream, *frame);
  if (frame->header.kind == FrameKind::Digest) receive_digest(*stream, *frame);
}

// A program without a map asks for the time: see network.hpp.
void Inbox::receive_visitor(const Frame& frame) {
  if (frame.header.kind != FrameKind::Hello) return;
  if (visitors_.size() == kMostVisitors && visitors_.count(frame.header.host) == 0) return;
  visitors_[frame.header.host] = {frame.header.host, TimePoint{frame.header.sent}, now_};
}

void Inbox::note_arrival(HostId host) {
  if (heard_.size() < kMostHeard || heard_.count(host) != 0) heard_[host] = now_;
}

void Inbox::receive_hello(const Frame& frame) {
  const auto hello = hello_from(frame.payload);
  if (!hello) return bad_frame("a frame was dropped: malformed announcement");
  const HostId id = frame.header.host;
  if (hosts_.count(id) == 0) {
    if (hosts_.size() == kMostRemoteHosts) return bad_frame("a frame was dropped: too many hosts");
    newest_host_ = hosts_[id].came = now_;
    shared_.report(fmt::format("host '{}' is here", hello->host));
  }
  Host& host = hosts_[id];
  host.name = hello->host;
  host.has_ended = hello->is_last;
  lost_.erase(host.name);
  compare_clocks(host, *hello, TimePoint{frame.header.sent});
  host.confirmed.clear();
  for (const auto& stream : hello->received)
    if (stream.host == shared_.host) host.confirmed[stream.node] = stream.expected;
  close_streams_that_left(id, *hello);
  for (const auto& node : hello->nodes)
    announce(id, hello->host, node, TimePoint{frame.header.sent});
}

void Inbox::compare_clocks(Host& host, const Hello& hello, TimePoint sent) {
  host.arrival = now_;
  host.announced = sent;
  for (const auto& echo : hello.echoes)
    if (echo.host == shared_.host) {
      host.clock.add(echo.sent, echo.received, sent, now_);
      host.reached = std::max(host.reached, std::min(echo.sent, now_));
    }
  const auto clock = host.clock.at(now_);
  if (!clock) return;
  host.real_time_ahead = hello.real_time + clock->offset - real_time_offset();
  if (std::chrono::abs(host.real_time_ahead) < kWrongClock || host.has_wrong_clock) return;
  host.has_wrong_clock = true;
  shared_.report(fmt::format("the clock of host '{}' is {:.1f} s {}; its times are corrected",
                             host.name, std::abs(to_seconds(host.real_time_ahead)),
                             host.real_time_ahead > Duration{0} ? "ahead of ours" : "behind ours"));
}

void Inbox::note_time(Stream& stream, TimePoint sent) {
  stream.as_of = std::max(stream.as_of, sent);
  const auto host = hosts_.find(stream.host);
  if (host == hosts_.end()) return;
  if (const auto clock = host->second.clock.at(now_)) stream.delay = now_ - (sent - clock->offset);
}

void Inbox::publish_status(TimePoint now) {
  if (now < published_ + kStatusPeriod) return;
  published_ = now;
  GatewayStatus status;
  std::vector<HelloEcho> echoes;
  for (const auto& [id, host] : hosts_) {
    if (now - host.arrival > kSilence || host.has_ended) continue;
    RemoteHost remote{host.name, now - host.arrival, {}, host.real_time_ahead};
    if (const auto clock = host.clock.at(now)) remote.clock = {clock->offset, clock->error};
    status.hosts.push_back(std::move(remote));
    echoes.push_back({id, host.announced, host.arrival});
  }
  std::erase_if(visitors_, [&](const auto& one) { return now - one.second.received > kSilence; });
  for (const auto& [id, visitor] : visitors_) echoes.push_back(visitor);
  for (const auto& [id, stream] : streams_) {
    const auto host = hosts_.find(stream->host);
    const auto clock = host == hosts_.end() ? std::nullopt : host->second.clock.at(now);
    if (!clock || stream->as_of == TimePoint{0}) continue;
    status.nodes.push_back({ring_.map().node_name(NodeId{id}), host->second.name,
                            now - (stream->as_of - clock->offset), stream->delay});
  }
  signals_.write(status);
  publish_positions();
  const std::lock_guard lock{shared_.mutex};
  shared_.status = std::move(status);
  shared_.echoes = std::move(echoes);
}

void Inbox::publish_positions() {
  std::vector<Received> received;
  decltype(shared_.owners) owners;
  decltype(shared_.confirmed) confirmed;
  for (const auto& [id, stream] : streams_) {
    if (stream->synced) received.push_back({stream->host, id, stream->expected});
    owners[id] = stream->host;
  }
  for (const auto& [id, host] : hosts_) confirmed[id] = host.confirmed;
  std::erase_if(heard_, [&](const auto& one) { return now_ - one.second > kLost; });
  auto missing = missed();
  auto all_heard = heard();
  const std::lock_guard lock{shared_.mutex};
  shared_.received = std::move(received);
  shared_.owners = std::move(owners);
  shared_.confirmed = std::move(confirmed);
  shared_.newest_host = newest_host_;
  shared_.heard = std::move(all_heard);
  shared_.missed = std::move(missing);
}

std::map<HostId, Heard> Inbox::heard() const {
  std::map<HostId, Heard> heard;
  for (const auto& [id, last] : heard_) heard[id].last = last;
  for (const auto& [id, host] : hosts_)
    if (heard.count(id) != 0) heard[id] = {heard[id].last, host.came, host.reached, host.name};
  return heard;
}

std::vector<Missed> Inbox::missed() const {
  std::vector<Missed> missed;
  for (const auto& [name, arrival] : lost_) missed.push_back({name, now_ - arrival});
  for (const auto& [id, host] : hosts_)
    if (now_ - host.arrival > kSilence && !host.has_ended && !has_restarted(id, host))
      missed.push_back({host.name, now_ - host.arrival});
  return missed;
}

bool Inbox::has_restarted(HostId id, const Host& host) const {
  return std::any_of(hosts_.begin(), hosts_.end(), [&](const auto& other) {
    return other.first != id && other.second.name == host.name &&
           other.second.arrival > host.arrival;
  });
}

void Inbox::close_streams_that_left(HostId host, const Hello& hello) {
  for (auto entry = streams_.begin(); entry != streams_.end();) {
    const std::uint16_t node = entry->first;
    const bool stays = entry->second->host != host ||
                       std::any_of(hello.nodes.begin(), hello.nodes.end(),
                                   [&](const auto& one) { return one.node == node; });
    if (stays) {
      ++entry;
      continue;
    }
    shared_.cards->release(NodeId{node});
    set_remote(node, false);
    entry = streams_.erase(entry);
  }
}

void Inbox::set_remote(std::uint16_t node, bool remote) {
  shared_.is_remote[node].store(remote, std::memory_order_release);
}

void Inbox::announce(HostId host, const std::string& name, const Announced& announced,
                     TimePoint sent) {
  const auto& nodes = ring_.map().description().nodes;
  const auto known = std::find_if(nodes.begin(), nodes.end(), [&](const auto& node) {
    return node.id.value() == announced.node;
  });
  if (known == nodes.end()) return bad_frame("a frame was dropped: unknown node");
  Stream* const stream = join(*known, host, name);
  if (stream == nullptr || !belongs_to(*stream, *known, host, name)) return;
  if (announced.beats != stream->beats) {
    stream->beats = announced.beats;
    stream->node.beat();
  }
  stream->announced = announced.next;
  if (stream->synced && stream->expected >= announced.next)
    stream->as_of = std::max(stream->as_of, sent);
}

Inbox::Stream* Inbox::join(const memmap::MapNode& node, HostId host, const std::string& name) {
  const auto id = node.id.value();
  if (const auto found = streams_.find(id); found != streams_.end()) return found->second.get();
  // Its writes must not be ignored meanwhile.
  const auto local = shared_.reader->presence_of(node.id);
  if (local.state == broker::Presence::State::Alive) {
    refuse(host, id,
           fmt::format("node '{}' of host '{}' is refused: it is on this host, as process {}",
                       node.name, name, local.pid));
    return nullptr;
  }
  set_remote(id, true);  // before it joins: it must not be taken for a local node
  try {
    auto stream = std::make_unique<Stream>(node.id, host, ring_.join(node.name, 0),
                                           NodeWords{ring_, node.name});
    stream->node.spare(*shared_.sender);
    return streams_.emplace(id, std::move(stream)).first->second.get();
  } catch (const Error& error) {
    set_remote(id, false);
    refuse(host, id,
           fmt::format("node '{}' of host '{}' is refused: {}", node.name, name, error.what()));
    return nullptr;
  }
}

bool Inbox::belongs_to(Stream& stream, const memmap::MapNode& node, HostId host,
                       const std::string& name) {
  if (stream.host == host) return true;
  const auto owner = hosts_.find(stream.host);
  const bool is_silent = owner == hosts_.end() || now_ - owner->second.arrival > kSilence;
  const bool is_restart = owner != hosts_.end() && owner->second.name == name;
  if (!is_silent && !is_restart) {
    refuse(host, node.id.value(),
           fmt::format("node '{}' is on two hosts, '{}' and '{}'; that of '{}' counts", node.name,
                       owner->second.name, name, owner->second.name));
    return false;
  }
  stream.host = host;  // restarted: a new stream of the same node
  stream.synced = false;
  stream.waiting.clear();
  stream.parts.clear();
  stream.asked = TimePoint{0};
  stream.beats = 0;
  stream.expected = 0;
  stream.as_of = TimePoint{0};
  return true;
}

void Inbox::refuse(HostId host, std::uint16_t node, const std::string& reason) {
  if (refused_.insert({host, node}).second) shared_.report(reason);
}

// The nodes of a host that is gone may join elsewhere.
void Inbox::forget_lost_hosts() {
  for (auto host = hosts_.begin(); host != hosts_.end();) {
    if (now_ - host->second.arrival < kLost) {
      ++host;
      continue;
    }
    const auto& [id, its] = *host;
    if (!has_restarted(id, its)) {
      shared_.report(fmt::format("host '{}' is silent for {:.0f} s; its nodes have left", its.name,
                                 to_seconds(kLost)));
      if (!its.has_ended && lost_.size() < kMostRemoteHosts) lost_[its.name] = its.arrival;
    }
    close_streams_that_left(host->first, {});
    host = hosts_.erase(host);
  }
}

void Inbox::tick(TimePoint now) {
  now_ = now;
  forget_lost_hosts();
  publish_status(now);
  for (auto& [node, stream] : streams_) {
    const bool lacks = !stream->waiting.empty() || stream->announced > stream->expected;
    if (stream->synced && !lacks) stream->complete = now;
    if (!stream->synced) ask(node, *stream, 0);
    // Frames may overtake each other, so a gap is real only after a while.
    if (lacks && now - stream->complete > kPatience)
      ask(node, *stream,
          stream->waiting.empty() ? stream->announced : stream->waiting.begin()->first);
  }
}

GatewaySignals::GatewaySignals(broker::Ring& ring, const std::string& host) {
  const std::string node = "gateway_" + host, prefix = "gateway." + host;
  const auto& nodes = ring.map().description().nodes;
  if (std::none_of(nodes.begin(), nodes.end(), [&](const auto& n) { return n.name == node; }))
    return;
  node_ = ring.join(node, 0);
  for (const auto& entry : ring.map().signals())
    if (entry.partition->name == prefix && !entry.partition->tear_group)
      signals_.push_back({entry.signal->name, entry.signal->offset, memmap::Codec{*entry.signal}});
}

void GatewaySignals::set(const std::string& name, Duration value) {
  for (const auto& signal : signals_)
    if (signal.name == name)
      static_cast<void>(node_->write(signal.offset, signal.codec.encode(to_seconds(value))));
}

void GatewaySignals::write(const GatewayStatus& status) {
  if (!node_) return;
  for (const auto& node : status.nodes) {
    set("age." + node.node, node.age);
    set("delay." + node.node, node.delay);
  }
  for (const auto& host : status.hosts) {
    if (!host.clock) continue;
    set("clock_offset." + host.name, host.clock->offset);
    set("clock_error." + host.name, host.clock->error);
  }
  node_->beat();
}

}  // namespace rths::dds
