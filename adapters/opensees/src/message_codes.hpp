// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Codes of the messages between OpenSees' or OpenFresco's client elements and a server: the first
/// number of a message (OpenSees SRC/element/genericClient, OpenFresco SRC/expSite).
namespace rths::adapters::message_code {

/// kOpen, kSetUp and kExecute need no action. OpenFresco requests all measured quantities or a
/// single one.
inline constexpr double kOpen = 1, kSetUp = 2, kTrial = 3, kExecute = 4, kCommit = 5,
                        kAllMeasured = 6, kDisplacement = 7, kForce = 10, kTime = 11,
                        kInitialStiffness = 12, kTangentStiffness = 13, kDamping = 14, kMass = 15,
                        kEnd = 99;

}  // namespace rths::adapters::message_code
