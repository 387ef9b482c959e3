// SPDX-License-Identifier: Apache-2.0
//
// The sending half of a gateway: follows the journals of the nodes on this host.
#pragma once

#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <rths/broker/follow.hpp>
#include <rths/broker/ring.hpp>

#include "frame.hpp"
#include "node_words.hpp"
#include "shared.hpp"

namespace rths::dds {

/// Sends the writes of local nodes. One thread runs it.
class Outbox {
 public:
  /// @throws Error if a tear group is too long for a frame
  Outbox(const std::string& ring, Shared& shared);
  /// Until the gateway ends.
  void run();
  [[nodiscard]] const broker::Waiter& waiter() const { return waiter_; }
  [[nodiscard]] const broker::Node& reader() const { return reader_; }

 private:
  struct SentFrame {
    std::uint64_t first = 0;
    std::uint16_t count = 0;
    std::vector<std::byte> bytes;
  };
  /// The writes of one local node.
  struct Stream {
    Stream(NodeId id, NodeWords its) : node{id}, words{std::move(its)} {}
    NodeId node;
    NodeWords words;
    bool announced = false;
    TimePoint written{0};                ///< when its last write was taken
    std::uint64_t next = 0;              ///< number of the next update
    std::uint64_t joined = 0;            ///< number of the first one since it was announced
    bool vanished_before = false;        ///< this gateway, and has not been back since
    std::optional<FrameWriter> pending;  ///< updates that are not sent yet
    std::deque<SentFrame> sent;          ///< for hosts that miss some
    std::size_t sent_bytes = 0;
    /// Words, and first words of groups, of which only the newest values are sent.
    std::set<LongwordOffset> changed;
  };

  struct WaitingInterrupt {
    Cards::Interrupt interrupt;
    TimePoint since;
  };

  /// Announcements, digests and newest values, when they are due.
  void do_periodic_work();
  /// Takes the next write of a local node. @returns false if there was none until the deadline
  [[nodiscard]] bool take_write(TimePoint deadline);
  void resume_after_loss();
  void take(Stream& stream, const broker::Write& write);
  void append(Stream& stream, const broker::Write& write);
  void append(Stream& stream, std::span<const std::uint32_t> card_message);
  /// The stream's pending frame, with room for an update. @param words  as of FrameWriter::size_of
  [[nodiscard]] FrameWriter& room_in(Stream& stream, std::size_t words);
  void append_card_changes(Stream& stream);
  /// Takes the interrupts whose data are in the journals.
  void take_interrupts();
  /// Appends those whose receiver has the data. One that waits for too long is lost.
  void append_interrupts();
  enum class Readiness : std::uint8_t { Ready, Waits, Lost };
  [[nodiscard]] Readiness readiness_of(const WaitingInterrupt& interrupt) const;
  void count_lost_interrupt(const Cards::Interrupt& interrupt);
  /// Appends the present values of the words that changed.
  void append_latest();
  [[nodiscard]] bool leaves_all_as_sent(const broker::Write& write);
  void flush(Stream& stream);
  void flush_all();
  [[nodiscard]] bool is_here(Stream& stream) const;
  /// True if all other hosts have all its writes, or had enough time.
  [[nodiscard]] bool is_known_elsewhere(const Stream& stream) const;
  /// True if a host has confirmed all writes before this number. The mutex is held.
  [[nodiscard]] bool has(HostId host, const Stream& stream, std::uint64_t number) const;
  void find_local_nodes();
  /// @param is_last  this gateway ends
  void send_hello(bool is_last = false);
  void send_digest();
  void answer();
  void answer(Stream& stream, const Asked& asked);
  void send_snapshot(Stream& stream, HostId to);
  void send(std::span<const std::byte> bytes);
  [[nodiscard]] FrameHeader header(FrameKind kind, const Stream& stream) const;
  [[nodiscard]] bool is_remote(NodeId node) const;
  [[nodiscard]] Stream* stream_of(NodeId node) const;

  Shared& shared_;
  broker::Ring ring_;
  broker::Node reader_;
  broker::Waiter waiter_;
  std::map<std::uint16_t, Stream> streams_;
  std::vector<Stream*> by_id_;                    ///< by NodeId; null: no node
  std::map<LongwordOffset, std::uint32_t> sent_;  ///< last values, to skip unchanged ones
  TimePoint latest_{0};                           ///< when `append_latest` is due
  TimePoint hello_{0};                            ///< when an announcement is due
  TimePoint digest_{0};                           ///< when digests are due
  TimePoint now_{0};                              ///< at the last look at the clock
  std::set<std::uint16_t> undigested_;            ///< nodes whose digest is due
  std::vector<WaitingInterrupt> interrupts_;
  bool has_foreign_interrupt_ = false;  ///< reported
};

}  // namespace rths::dds
