// SPDX-License-Identifier: Apache-2.0
#include "gt_unit.hpp"

#include <array>
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>

#include <rths/core/error.hpp>

#include "warning.hpp"

namespace rths::scramnet {
namespace {

// Like the SCRAMNet+ card, a unit is never destroyed; at exit it leaves the ring.
std::array<std::atomic<GtUnit*>, SCGT_MAX_DEVICES> units{};
std::mutex taking;

void leave_all() {
  for (auto& unit : units)
    if (GtUnit* taken = unit.load()) taken->session().leave();
}

bool reaches(const GtCard& card, const scgtInterrupt& interrupt) {
  return interrupt.type == SCGT_BROADCAST_INTR || node_id(card) == interrupt.id;
}

}  // namespace

GtUnit::GtUnit(std::uint32_t unit)
    : session_{gt_settings(unit)},
      memory_{session_.map_memory(nullptr, 0, session_.memory_bytes())} {
  if (memory_ == nullptr) throw Error{"the ring's memory cannot be mapped"};
}

GtRing GtUnit::ring() const {
  GtRing ring{0, node_id(card())};
  bool passed_self = false;
  session_.for_each_card([&](const CardSession::CardView& other) {
    ++ring.nodes;
    const bool self = other.card == &session_.card();
    // The card before this one; for the first card, the last.
    if (!self && (!passed_self || session_.index() == 0)) ring.upstream = node_id(other.card->gt);
    passed_self = passed_self || self;
  });
  return ring;
}

bool GtUnit::send(const scgtInterrupt& interrupt) {
  if (!is_set(card(), gt::kLinkControl, gt::kTransmit)) return true;
  const bool unicast = interrupt.type == SCGT_UNICAST_INTR;
  const QueuedInterrupt message{interrupt.type, node_id(card()), unicast ? 0 : interrupt.id,
                                interrupt.val};
  bool all = true;
  session_.for_each_card([&](const CardSession::CardView& other) {
    const bool self = other.card == &session_.card();
    if (self && !is_set(card(), gt::kLinkControl, gt::kInterruptSelf)) return;
    const GtCard& gt = other.card->gt;
    if (!reaches(gt, interrupt) || !accepts(gt, interrupt.type, interrupt.id)) return;
    if (push(other.card->gt, message, session_.self(), session_.members()))
      other.card->gt.counts[kReceived].fetch_add(1);
    else
      all = false;
  });
  card().counts[kSent].fetch_add(1);
  return all;
}

GtUnit* unit_of(const scgtHandle* handle) noexcept {
  if (handle == nullptr || handle->unitNum >= SCGT_MAX_DEVICES) return nullptr;
  return units[handle->unitNum].load(std::memory_order_acquire);
}

GtUnit* take_unit(std::uint32_t number) noexcept {
  const std::lock_guard lock{taking};
  static bool leaves_at_exit = false;
  if (GtUnit* taken = units[number].load()) return taken;
  try {
    units[number].store(std::make_unique<GtUnit>(number).release());
  } catch (const std::exception& error) {
    warn_once("scgt", error.what());
    return nullptr;
  }
  if (!leaves_at_exit) leaves_at_exit = std::atexit(leave_all) == 0;
  return units[number].load();
}

}  // namespace rths::scramnet
