// SPDX-License-Identifier: Apache-2.0
#include "viewer.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nlohmann/json.hpp>

namespace rths::monitor {
namespace {

using Json = nlohmann::ordered_json;

constexpr auto kFrameEvery = std::chrono::microseconds{33'333};
constexpr std::size_t kMostWords = 256;
constexpr Slot kMostIntervals = 4096;  // of a frame
constexpr int kMostBits = 14;          // of an interval: 16 s
constexpr double kFarthest = 1e12;     // of a slot from the begin

template <class T>
void append(std::string& bytes, const T* values, std::size_t count) {
  bytes.append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

}  // namespace

Viewer::Viewer(const ShownRing& ring, Send send, Change change)
    : ring_{ring}, send_{std::move(send)}, change_{std::move(change)}, thread_{[this] { run(); }} {}

Viewer::~Viewer() {
  {
    const std::scoped_lock lock{mutex_};
    ends_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

bool Viewer::receive(const std::string& message) {
  const Json json = Json::parse(message, nullptr, false);
  if (!json.is_object()) return false;
  try {
    const auto id = json.value("id", 0U);
    if (json.contains("set")) {
      const std::string trouble =
          change_(json.at("set").get<std::string>(), json.value("token", ""));
      const std::scoped_lock lock{mutex_};
      replies_.push_back(Json{{"kind", "set"}, {"id", id}, {"error", trouble}}.dump(
          -1, ' ', false, Json::error_handler_t::replace));
    } else if (json.contains("watch") || json.contains("range")) {
      const bool is_range = json.contains("range");
      Request request;
      request.words = json.at(is_range ? "range" : "watch").get<std::vector<std::uint32_t>>();
      if (request.words.size() > kMostWords) request.words.resize(kMostWords);
      request.width_bits = std::clamp(json.value("width_bits", 4), 0, kMostBits);
      request.from = std::clamp(json.value("from", 0.0), -kFarthest, kFarthest);
      request.intervals = json.value("intervals", 0U);
      request.id = id;
      const std::scoped_lock lock{mutex_};
      if (!is_range) next_.reset();
      (is_range ? range_ : watched_) = std::move(request);
    } else if (!json.contains("alive")) {
      return false;
    }
  } catch (const Json::exception&) {
    return false;
  }
  wake_.notify_all();
  return true;
}

void Viewer::run() {
  std::unique_lock lock{mutex_};
  auto next = std::chrono::steady_clock::now();
  while (!ends_ && is_reading_.load()) {
    lock.unlock();
    send_messages();
    send_range();
    send_live();
    lock.lock();
    next = std::max(next + kFrameEvery, std::chrono::steady_clock::now());
    wake_.wait_until(lock, next, [&] { return ends_ || range_ || !replies_.empty(); });
  }
}

void Viewer::send(const std::string& bytes, bool is_binary) {
  if (is_reading_.load() && !send_(bytes, is_binary)) is_reading_.store(false);
}

void Viewer::send_messages() {
  std::vector<std::string> replies;
  {
    const std::scoped_lock lock{mutex_};
    replies.swap(replies_);
  }
  for (const auto& reply : replies) send(reply, false);
  const auto send_new = [&](const Broadcast& message, std::uint64_t& sent, bool is_binary) {
    if (!message.text || message.number == sent) return;
    sent = message.number;
    send(*message.text, is_binary);
  };
  const Broadcast map = ring_.map();
  if (map_sent_ != 0 && map.number != map_sent_) {
    const std::scoped_lock lock{mutex_};
    watched_.reset();  // its words are those of another map
    range_.reset();
  }
  send_new(map, map_sent_, false);
  send_new(ring_.status(), status_sent_, false);
  send_new(ring_.values(), values_sent_, true);
}

// Extents from the requested slot on, as many as are complete.
std::string Viewer::frame(const RingLook& look, const Request& request, PageFrameKind kind,
                          Slot& next) const {
  const History& history = *look.history();
  const Slot begun = look.begun() / kSlot;
  std::vector<std::uint32_t> words;
  for (const auto word : request.words)
    if (word < look.words().size()) words.push_back(word);
  const int bits = request.width_bits;
  const Slot from = std::max(next, history.begin()) >> bits;
  const Slot most =
      kind == kRange ? std::min<Slot>(kMostIntervals, request.intervals) : kMostIntervals;
  const Slot count = std::clamp<Slot>((history.end() >> bits) - from, 0, most);
  next = (from + count) << bits;
  if (words.empty() || (count == 0 && kind == kLive)) return "";
  PageFrame header{kind,
                   ring_.epoch(),
                   static_cast<double>((from << bits) - begun),
                   1U << bits,
                   static_cast<std::uint32_t>(count),
                   static_cast<std::uint32_t>(words.size()),
                   request.id};
  std::string bytes;
  append(bytes, &header, 1);
  append(bytes, words.data(), words.size());
  std::vector<Extent> extents(static_cast<std::size_t>(count));
  for (const auto word : words) {
    history.reduce(word, from << bits, bits, extents);
    append(bytes, extents.data(), extents.size());
  }
  return bytes;
}

void Viewer::send_range() {
  std::optional<Request> request;
  {
    const std::scoped_lock lock{mutex_};
    request.swap(range_);
  }
  if (!request) return;
  const std::string bytes = ring_.with([&](const RingLook* look) -> std::string {
    if (look == nullptr) return "";
    const Slot from = look->begun() / kSlot + static_cast<Slot>(std::llround(request->from));
    const int bits = look->history()->width_bits_at(from, request->width_bits);
    request->intervals >>= bits - request->width_bits;
    request->width_bits = bits;
    Slot next = from;
    return frame(*look, *request, kRange, next);
  });
  if (!bytes.empty()) send(bytes, true);
}

void Viewer::send_live() {
  std::optional<Request> request;
  std::optional<Slot> next;
  {
    const std::scoped_lock lock{mutex_};
    request = watched_;
    next = next_;
  }
  if (!request) return;
  const std::string bytes = ring_.with([&](const RingLook* look) -> std::string {
    if (look == nullptr) return "";
    if (!next) {
      next = look->begun() / kSlot + static_cast<Slot>(std::llround(request->from));
      request->width_bits = look->history()->width_bits_at(*next, request->width_bits);
    }
    return frame(*look, *request, kLive, *next);
  });
  {
    const std::scoped_lock lock{mutex_};
    if (!watched_ || watched_->id != request->id) return;  // another request meanwhile
    watched_->width_bits = request->width_bits;
    next_ = next;
  }
  if (!bytes.empty()) send(bytes, true);
}

}  // namespace rths::monitor
