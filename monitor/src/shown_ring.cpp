// SPDX-License-Identifier: Apache-2.0
#include "shown_ring.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <rths/broker/detail/shared_object.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/core/error.hpp>

namespace rths::monitor {
namespace {

using Json = nlohmann::ordered_json;

constexpr Duration kUpdateEvery = std::chrono::milliseconds{10};
constexpr Duration kLookForRingEvery = std::chrono::milliseconds{100};
constexpr Duration kStatusEvery = std::chrono::milliseconds{250};
constexpr Duration kValuesEvery = std::chrono::milliseconds{100};

std::string dumped(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json json_of(const recording::AxisRoles& axis) {
  return {{"axis", axis.axis},
          {"target", axis.target},
          {"command", axis.command},
          {"displacement", axis.displacement},
          {"force", axis.force},
          {"reference", axis.reference},
          {"machine_displacement", axis.machine_displacement},
          {"machine_force", axis.machine_force}};
}

Json json_of(const WordState& word, const memmap::Map& map) {
  const auto& signal = *map.entry(map.signal(word.name)).signal;
  Json json = {{"name", word.name}, {"node", word.node}, {"unit", word.unit}};
  if (word.is_parameter) json["parameter"] = true;
  if (signal.range) {
    json["low"] = word.codec.to_si(signal.range->first);
    json["high"] = word.codec.to_si(signal.range->second);
  }
  for (const auto& [name, value] : signal.values) json["values"][name] = value;
  return json;
}

template <class T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

ShownRing::ShownRing(std::string ring, RolesOf roles_of, std::vector<ShownLimits> limits,
                     std::size_t history_bytes)
    : wanted_{std::move(ring)},
      roles_of_{std::move(roles_of)},
      limits_{std::move(limits)},
      history_bytes_{history_bytes} {
  broker::check_ring_name(wanted_);
  thread_ = std::thread{[this] { run(); }};
}

ShownRing::~ShownRing() {
  ends_.store(true);
  thread_.join();
}

void ShownRing::run() {
  WallClock clock;
  TimePoint next_ring{0};
  while (!ends_.load()) {
    const TimePoint now = clock.now();
    if (now >= next_ring) {
      next_ring = now + kLookForRingEvery;
      attach();
    }
    publish();
    clock.sleep_until(now + kUpdateEvery);
  }
}

// Looks whether the ring is still there, and for one that takes its place.
void ShownRing::attach() {
  if (is_live_ && look_->is_current()) return;
  if (is_live_) detach("the ring has ended");
  const auto rings = broker::ring_names();
  const std::string name = wanted_.empty() && !rings.empty() ? rings.front() : wanted_;
  if (std::find(rings.begin(), rings.end(), name) == rings.end()) {
    if (!look_)
      detach(wanted_.empty() ? "there is no ring on this host yet"
                             : "there is no ring '" + wanted_ + "' yet");
    return;
  }
  try {
    auto look = std::make_unique<RingLook>(name, history_bytes_);
    const std::scoped_lock lock{mutex_};
    look_ = std::move(look);
    is_live_ = true;
    note_.clear();
    const std::uint32_t epoch = epoch_.load() + 1;
    map_ = {epoch, std::make_shared<const std::string>(map_text())};
    values_ = {};
    epoch_.store(epoch);
  } catch (const Error& error) {
    detach(error.what());
  }
}

void ShownRing::detach(const std::string& note) {
  const std::scoped_lock lock{mutex_};
  is_live_ = false;
  note_ = note;
}

// A change of the events is sent at once.
void ShownRing::publish() {
  const std::scoped_lock lock{mutex_};
  const auto newest = [&] {
    return look_ && !look_->events().empty() ? look_->events().back().number : 0;
  };
  const auto before = newest();
  if (is_live_) look_->update();
  const TimePoint now = WallClock{}.now();
  if (now - status_time_ >= kStatusEvery || newest() != before) {
    status_time_ = now;
    status_ = {status_.number + 1, std::make_shared<const std::string>(status_text())};
  }
  if (is_live_ && now - values_time_ >= kValuesEvery) {
    values_time_ = now;
    values_ = {values_.number + 1, std::make_shared<const std::string>(values_frame())};
  }
}

std::string ShownRing::name() const {
  const std::shared_lock lock{mutex_};
  return look_ ? look_->ring() : "";
}

Broadcast ShownRing::map() const {
  const std::shared_lock lock{mutex_};
  return map_;
}

Broadcast ShownRing::status() const {
  const std::shared_lock lock{mutex_};
  return status_;
}

Broadcast ShownRing::values() const {
  const std::shared_lock lock{mutex_};
  return values_;
}

std::string ShownRing::map_text() const {
  Json json = {{"kind", "map"},
               {"epoch", epoch_.load() + 1},
               {"ring", look_->ring()},
               {"map", look_->map().description().name},
               {"hash", memmap::hash_text(look_->map().hash())},
               {"words", Json::array()}};
  for (const auto& word : look_->words()) json["words"].push_back(json_of(word, look_->map()));
  const recording::Roles roles = roles_of_(look_->map());
  json["roles"] = {{"controller", roles.controller},
                   {"machine", roles.machine},
                   {"solver", roles.solver},
                   {"time", roles.time},
                   {"axes", Json::array()}};
  for (const auto& axis : roles.axes) json["roles"]["axes"].push_back(json_of(axis));
  for (const auto& limit : limits_)  // an infinite number is null
    json["limits"][limit.axis] = {
        {"displacement", limit.displacement}, {"force", limit.force}, {"tracking", limit.tracking}};
  using controller::PcState;
  json["pc_states"] = {{std::to_string(static_cast<int>(PcState::Initialize)), "initialize"},
                       {std::to_string(static_cast<int>(PcState::Correct)), "correct"},
                       {std::to_string(static_cast<int>(PcState::Predict)), "predict"},
                       {std::to_string(static_cast<int>(PcState::AutoSlowDown)), "slow-down"}};
  return dumped(json);
}

std::string ShownRing::status_text() const {
  Json json = {{"kind", "status"}, {"epoch", epoch_.load()}, {"live", is_live_}, {"note", note_}};
  // Appended as text: the look writes its own JSON.
  std::string text = dumped(json);
  text.pop_back();
  return text + ",\"look\":" + (look_ ? monitor::json_of(*look_) : "null") + "}";
}

std::string ShownRing::values_frame() const {
  const auto& words = look_->words();
  PageFrame header{kValues, epoch_.load()};
  header.from = static_cast<double>(look_->history()->end() - look_->begun() / kSlot);
  header.words = static_cast<std::uint32_t>(words.size());
  std::string frame;
  frame.reserve(sizeof header + 8 * words.size());
  append(frame, header);
  for (const auto& word : words) append(frame, word.value);
  for (const auto& word : words)
    append(frame, word.written.count() == 0
                      ? std::numeric_limits<float>::quiet_NaN()
                      : static_cast<float>(to_seconds(look_->updated() - word.written)));
  return frame;
}

}  // namespace rths::monitor
