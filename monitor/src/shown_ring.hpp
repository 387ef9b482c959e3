// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <shared_mutex>
#include <string>
#include <thread>
#include <vector>

#include <rths/monitor/look.hpp>
#include <rths/monitor/server.hpp>
#include <rths/recording/roles.hpp>

namespace rths::monitor {

/// A message for all viewers. Its number is that of the last change.
struct Broadcast {
  std::uint64_t number = 0;
  std::shared_ptr<const std::string> text;
};

/// The words of a test on a ring of this map.
using RolesOf = std::function<recording::Roles(const memmap::Map&)>;

/// The ring that is shown: a thread keeps the look at it up to date, and replaces it when another
/// ring has taken its name. A ring that has ended stays until then.
class ShownRing {
 public:
  /// @param ring  empty: the first of this host
  ShownRing(std::string ring, RolesOf roles_of, std::vector<ShownLimits> limits,
            std::size_t history_bytes);
  ~ShownRing();
  ShownRing(const ShownRing&) = delete;
  ShownRing& operator=(const ShownRing&) = delete;

  /// Number of looks until now: 0 before the first.
  [[nodiscard]] std::uint32_t epoch() const { return epoch_.load(); }
  /// Calls a function with the look, which does not change meanwhile; with null before the first.
  template <class Function>
  auto with(const Function& function) const {
    const std::shared_lock lock{mutex_};
    return function(look_.get());
  }
  /// Name of the ring; empty if there is none yet.
  [[nodiscard]] std::string name() const;
  /// Words and roles, once for each look; the state; the newest value and age of each word.
  [[nodiscard]] Broadcast map() const;
  [[nodiscard]] Broadcast status() const;
  [[nodiscard]] Broadcast values() const;

 private:
  void run();
  void attach();
  void detach(const std::string& note);
  void publish();
  [[nodiscard]] std::string map_text() const;
  [[nodiscard]] std::string status_text() const;
  [[nodiscard]] std::string values_frame() const;

  const std::string wanted_;
  const RolesOf roles_of_;
  const std::vector<ShownLimits> limits_;
  const std::size_t history_bytes_;
  mutable std::shared_mutex mutex_;  ///< of all that follows
  std::unique_ptr<RingLook> look_;
  bool is_live_ = false;
  std::string note_;  ///< why it is not live
  Broadcast map_, status_, values_;
  TimePoint status_time_{0}, values_time_{0};
  std::atomic<std::uint32_t> epoch_{0};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

/// First bytes of a binary frame; words and extents follow.
struct PageFrame {
  std::uint32_t kind = 0;  ///< below
  std::uint32_t epoch = 0;
  double from = 0;          ///< first slot [ms], since the look began
  std::uint32_t width = 0;  ///< of an interval [slots]
  std::uint32_t intervals = 0, words = 0;
  std::uint32_t id = 0;  ///< of the request
};
static_assert(sizeof(PageFrame) == 32);

enum PageFrameKind : std::uint32_t {
  kLive = 1,    ///< words' positions, then the extents of each word
  kRange = 2,   ///< the same
  kValues = 3,  ///< values of all words, then their ages [s]
};

}  // namespace rths::monitor
