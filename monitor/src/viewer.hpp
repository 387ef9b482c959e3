// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "shown_ring.hpp"

namespace rths::monitor {

/// Sends a message to a page. @returns false if it does not take it
using Send = std::function<bool(const std::string& bytes, bool is_binary)>;
/// Changes a parameter, "name=value", with a token. @returns why not; empty: done
using Change = std::function<std::string(const std::string& assignment, const std::string& token)>;

/// One page. A thread sends it what it watches, 30 times per second, as extents of intervals of
/// about a pixel. A page that does not take a message in time gets no more.
class Viewer {
 public:
  Viewer(const ShownRing& ring, Send send, Change change);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// A message of the page, JSON:
  ///     {"watch": [words], "width_bits": 4, "from": slot, "id": 1}  from now on, and what was
  ///     since
  ///     {"range": [words], "width_bits": 4, "from": slot, "intervals": 900, "id": 2}   once
  ///     {"set": "name=value", "token": "…", "id": 3}
  /// Slots count since the look began.
  /// @returns false if it is no such message
  bool receive(const std::string& message);
  /// False once it did not take a message.   @any_thread
  [[nodiscard]] bool is_reading() const { return is_reading_.load(); }

 private:
  struct Request {
    std::vector<std::uint32_t> words;
    int width_bits = 0;
    double from = 0;
    std::uint32_t intervals = 0, id = 0;
  };
  void run();
  void send_messages();
  void send_live();
  void send_range();
  [[nodiscard]] std::string frame(const RingLook& look, const Request& request, PageFrameKind kind,
                                  Slot& next) const;
  void send(const std::string& bytes, bool is_binary);

  const ShownRing& ring_;
  const Send send_;
  const Change change_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool ends_ = false;
  std::optional<Request> watched_, range_;
  std::vector<std::string> replies_;
  std::optional<Slot> next_;  ///< of the watched words, to send; none: from the request
  std::atomic<bool> is_reading_{true};
  std::uint64_t map_sent_ = 0, status_sent_ = 0, values_sent_ = 0;
  std::thread thread_;
};

}  // namespace rths::monitor
