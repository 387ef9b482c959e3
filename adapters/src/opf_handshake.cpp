// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opf_handshake.hpp>

namespace rths::adapters {
namespace {

constexpr double kStopHold = 0.02;  // [s] that newTarget stays at −1

}  // namespace

Handshake read_handshake(const Config& table) {
  const std::string word = table.text("handshake", "at_target_first");
  if (word == "target_first") return Handshake::TargetFirst;
  if (word == "numbered") return Handshake::Numbered;
  if (word != "at_target_first")
    table.fail("handshake",
               "handshake is '" + word + "', expected at_target_first, target_first or numbered");
  return Handshake::AtTargetFirst;
}

Status OpfHandshake::wait_for(bool flag, Phase next, const char* otherwise, double now) noexcept {
  if (flag) enter(next, now);
  if (flag || now - entered_ <= deadline_) return Status::Ok;
  message_ = otherwise;
  return Status::Fault;
}

// A fast controller may lower switchPC and raise atTarget between two updates, so one update
// handles both. atTarget then refers to this target, because it was 0 when switchPC rose.
Status OpfHandshake::update(double at_target, double switch_pc, double now) noexcept {
  if (phase_ == Phase::WaitForSwitch)
    return wait_for(switch_pc > 0, Phase::WaitForRelease,
                    "switchPC did not rise before the deadline", now);
  if (phase_ == Phase::WaitForRelease) {
    const Status status = wait_for(!(switch_pc > 0), Phase::WaitForAtTarget,
                                   "switchPC did not fall before the deadline", now);
    if (phase_ == Phase::WaitForRelease) return status;
  }
  if (phase_ == Phase::WaitForAtTarget && is_numbered_ && number_ > 0)
    return wait_for(at_target == number_, Phase::Ready,
                    "atTarget did not show the target's number before the deadline", now);
  if (phase_ == Phase::WaitForAtTarget)
    return wait_for(at_target > 0, Phase::Ready, "atTarget did not rise before the deadline", now);
  return Status::Ok;
}

void OpfHandshake::post(double now) noexcept {
  number_ = is_numbered_ && number_ != 2 ? 2 : 1;
  enter(is_numbered_ ? Phase::WaitForAtTarget : Phase::WaitForSwitch, now);
}

bool OpfHandshake::has_stopped(double now) const noexcept {
  return is_stopping() && now - entered_ >= kStopHold;
}

double OpfHandshake::new_target() const noexcept {
  if (phase_ == Phase::Stopping) return -1;
  return is_numbered_ || phase_ == Phase::WaitForSwitch ? number_ : 0;
}

}  // namespace rths::adapters
