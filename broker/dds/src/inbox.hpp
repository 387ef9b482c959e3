// SPDX-License-Identifier: Apache-2.0
//
// The receiving half of a gateway: writes the updates of other hosts' nodes into this ring.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/dds/gateway.hpp>
#include <rths/memmap/codec.hpp>

#include "clock_offset.hpp"
#include "frame.hpp"
#include "hello.hpp"
#include "node_words.hpp"
#include "shared.hpp"

namespace rths::dds {

/// The signals of a gateway, if the map has them: the node `gateway_<host>` writes
/// `gateway.<host>.age.<node>`, `.delay.<node>`, `.clock_offset.<host>` and `.clock_error.<host>`
/// in a unit of time. One thread.
class GatewaySignals {
 public:
  /// @param host  name of this host
  /// @throws Error if the node is on the ring already   @setup
  GatewaySignals(broker::Ring& ring, const std::string& host);
  void write(const GatewayStatus& status);

 private:
  struct Signal {
    std::string name;  ///< without the partition: "age.machine"
    LongwordOffset offset;
    memmap::Codec codec;
  };
  void set(const std::string& name, Duration value);

  std::optional<broker::Node> node_;
  std::vector<Signal> signals_;
};

/// Receives the writes of other hosts' nodes. A thread of the carrier hands over their bytes,
/// another one runs the timers.
class Inbox {
 public:
  Inbox(const std::string& ring, Shared& shared);
  /// Until the gateway ends.
  void run();

 private:
  /// Handles received bytes, which anyone may have sent.
  void receive(std::span<const std::byte> bytes);
  /// Asks again for missing updates.
  void tick(TimePoint now);

  /// The writes of one node of another host.
  struct Stream {
    Stream(NodeId its_id, HostId of, broker::Node joined, NodeWords its)
        : id{its_id}, host{of}, node{std::move(joined)}, words{std::move(its)} {}
    NodeId id;
    HostId host;
    broker::Node node;
    NodeWords words;
    bool synced = false;          ///< has a snapshot, or all updates from the first
    std::uint64_t expected = 0;   ///< number of the next update to apply
    std::uint64_t announced = 0;  ///< its owner has sent all before this number
    TimePoint complete{0};        ///< when no update was known to be missing
    std::uint64_t beats = 0;
    std::map<std::uint64_t, std::vector<std::byte>> waiting;  ///< frames behind a gap, by first
    std::uint64_t part_first = 0;                             ///< snapshot that is being received
    std::set<std::uint32_t> parts;
    std::size_t part_count = 0;  ///< 0: not known yet
    TimePoint asked{0};          ///< when updates were asked for
    int differing = 0;           ///< digests in a row that differed
    TimePoint as_of{0};          ///< on its host's clock: all earlier writes are here
    Duration delay{0};           ///< of the last updates
  };
  struct Host {
    std::string name;
    TimePoint came{0};       ///< arrival of its first announcement
    TimePoint arrival{0};    ///< arrival of its last announcement
    TimePoint reached{0};    ///< when we sent the last announcement that it has confirmed
    TimePoint announced{0};  ///< when that was sent, on its clock
    Duration real_time_ahead{0};
    ClockOffset clock;
    bool has_wrong_clock = false;  ///< reported
    bool has_ended = false;        ///< in order
    Shared::Confirmed confirmed;
  };

  void receive_hello(const Frame& frame);
  void receive_visitor(const Frame& frame);
  void note_arrival(HostId host);
  void compare_clocks(Host& host, const Hello& hello, TimePoint sent);
  /// Notes that the words are here as they were on their host at this time of its clock.
  void note_time(Stream& stream, TimePoint sent);
  void publish_status(TimePoint now);
  /// How far this host has the streams of others, and the others those of this host.
  void publish_positions();
  [[nodiscard]] std::map<HostId, Heard> heard() const;
  /// Hosts that did not end in order and whose announcements do not arrive.
  [[nodiscard]] std::vector<Missed> missed() const;
  [[nodiscard]] bool has_restarted(HostId id, const Host& host) const;
  void announce(HostId host, const std::string& name, const Announced& announced, TimePoint sent);
  void forget_lost_hosts();
  void close_streams_that_left(HostId host, const Hello& hello);
  /// The stream of a node, which joins if it is new. @returns null if it cannot join
  [[nodiscard]] Stream* join(const memmap::MapNode& node, HostId host, const std::string& name);
  /// Whether the node is on this host; it may take over the stream of a host that is lost.
  [[nodiscard]] bool belongs_to(Stream& stream, const memmap::MapNode& node, HostId host,
                                const std::string& name);
  /// Reports the reason once.
  void refuse(HostId host, std::uint16_t node, const std::string& reason);
  void receive_updates(Stream& stream, const Frame& frame, std::span<const std::byte> bytes);
  void receive_snapshot(Stream& stream, const Frame& frame);
  void receive_digest(Stream& stream, const Frame& frame);
  void receive_request(const Frame& frame);
  void apply_waiting(Stream& stream);
  /// Writes the updates from number `expected` on.
  void apply(Stream& stream, const Frame& frame);
  [[nodiscard]] bool write(Stream& stream, const Update& update);
  [[nodiscard]] static bool write_into_group(Stream& stream, const Update& update);
  [[nodiscard]] bool apply_card_message(Stream& stream, std::span<const std::uint32_t> message);
  [[nodiscard]] bool write_run(Stream& stream, const Update& run);
  /// Asks for the updates before `end`, or, with 0, for a snapshot; not again within 30 ms.
  void ask(std::uint16_t node, Stream& stream, std::uint64_t end);
  [[nodiscard]] Stream* stream_of(const Frame& frame);
  void bad_frame(const std::string& reason);
  void set_remote(std::uint16_t node, bool remote);

  Shared& shared_;
  broker::Ring ring_;
  WallClock clock_;
  std::mutex mutex_;  ///< of all below, for the two threads
  TimePoint now_{0};
  std::map<std::uint16_t, std::unique_ptr<Stream>> streams_;  ///< by NodeId: one owner per node
  std::map<HostId, Host> hosts_;
  std::map<HostId, HelloEcho> visitors_;
  std::map<HostId, TimePoint> heard_;      ///< last arrivals, also with another map
  std::map<std::string, TimePoint> lost_;  ///< hosts, with their last arrival
  GatewaySignals signals_;
  TimePoint published_{0};
  TimePoint newest_host_{0};                            ///< when a host came
  std::set<std::pair<HostId, std::uint16_t>> refused_;  ///< reported once
  std::set<std::string> reported_;                      ///< reasons of bad frames, once each
};

}  // namespace rths::dds
