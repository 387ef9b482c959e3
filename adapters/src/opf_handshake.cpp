// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/opf_handshake.hpp>

namespace rths::adapters {
namespace {

constexpr double kFarewell = 0.02;  // [s] that newTarget stays at stop

}  // namespace

Handshake read_handshake(const Config& table) {
  const std::string word = table.text("handshake", "at_target_first");
  if (word == "target_first") return Handshake::TargetFirst;
  if (word != "at_target_first")
    table.fail("handshake",
               "handshake is '" + word + "', expected at_target_first or target_first");
  return Handshake::AtTargetFirst;
}

Status OpfHandshake::wait_for(bool flag, Phase next, const char* otherwise, double now) noexcept {
  if (flag) enter(next, now);
  if (flag || now - entered_ <= deadline_) return Status::Ok;
  message_ = otherwise;
  return Status::Fault;
}

// The next phase may have come with the same look: a prompt controller raises atTarget with the
// fall of switchPC. What atTarget says is then of this target: it was down when switchPC rose.
Status OpfHandshake::look(bool at_target, bool switch_pc, double now) noexcept {
  if (phase_ == Phase::WaitForSwitch)
    return wait_for(switch_pc, Phase::WaitForRelease, "switchPC did not rise before the deadline",
                    now);
  if (phase_ == Phase::WaitForRelease) {
    const Status status = wait_for(!switch_pc, Phase::WaitForTarget,
                                   "switchPC did not fall before the deadline", now);
    if (phase_ == Phase::WaitForRelease) return status;
  }
  if (phase_ == Phase::WaitForTarget)
    return wait_for(at_target, Phase::There, "atTarget did not rise before the deadline", now);
  return Status::Ok;
}

bool OpfHandshake::has_left(double now) const noexcept {
  return is_leaving() && now - entered_ >= kFarewell;
}

double OpfHandshake::new_target() const noexcept {
  if (phase_ == Phase::Leave) return -1;
  return phase_ == Phase::WaitForSwitch ? 1 : 0;
}

}  // namespace rths::adapters
