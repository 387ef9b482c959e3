// SPDX-License-Identifier: Apache-2.0
//
// Payloads of the frames that carry no updates.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/core/clock.hpp>

#include "frame.hpp"

namespace rths::dds {

/// A node of the sender's host.
struct Announced {
  std::uint16_t node = 0;   ///< NodeId
  std::uint64_t next = 0;   ///< number of its next update
  std::uint64_t beats = 0;  ///< its heartbeats; unchanged while it is stopped or after its death
};

/// Another host's last Hello, as the sender received it.
struct HelloEcho {
  HostId host = 0;
  TimePoint sent{0};      ///< on that host's clock
  TimePoint received{0};  ///< on the sender's clock
};

/// A stream of another host, as far as the sender has it.
struct Received {
  HostId host = 0;             ///< owner of the stream
  std::uint16_t node = 0;      ///< NodeId
  std::uint64_t expected = 0;  ///< number of the next update
};

/// A host that did not leave and of which nothing arrives.
struct Missed {
  std::string host;     ///< name, at most 63 bytes
  Duration silence{0};  ///< since its last announcement
};

/// Payload of a Hello.
struct Hello {
  std::string host;       ///< name, at most 63 bytes
  Duration real_time{0};  ///< CLOCK_REALTIME minus CLOCK_MONOTONIC
  std::vector<Announced> nodes;
  std::vector<Received> received;
  std::vector<HelloEcho> echoes;  ///< of the hosts whose announcements arrive
  std::vector<Missed> missed;
  bool is_last = false;  ///< the sender ends in order
};
[[nodiscard]] std::vector<std::byte> to_bytes(const Hello& hello);
/// Empty if the bytes are malformed. Its names are printable.
[[nodiscard]] std::optional<Hello> hello_from(std::span<const std::byte> bytes);

/// The name with '?' in place of bytes that cannot be printed.
[[nodiscard]] std::string printable(std::string name);

/// Payload of a Request: updates [header.first, end) of the stream of `host`; end 0: a snapshot.
struct Request {
  HostId host = 0;
  std::uint64_t end = 0;
};
/// Part of a snapshot; the last bytes of its payload.
struct SnapshotPart {
  HostId to = 0;  ///< the host that asked; 0: all, since updates are lost
  std::uint32_t index = 0;
  std::uint32_t parts = 0;  ///< number of parts in the last one, otherwise 0
};

template <class Plain>
[[nodiscard]] std::span<const std::byte> bytes_of(const Plain& plain) {
  static_assert(std::is_trivially_copyable_v<Plain>);
  return std::as_bytes(std::span{&plain, 1});
}
/// The plain value at the beginning of the bytes, which it removes.
template <class Plain>
[[nodiscard]] std::optional<Plain> take(std::span<const std::byte>& bytes);

}  // namespace rths::dds
