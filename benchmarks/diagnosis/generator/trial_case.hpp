// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "effects.hpp"
#include "hybrid_test.hpp"

namespace trial {

/// Difficulty of a trial.
enum class Tier {
  Standard,   ///< A
  Small,      ///< B: a quarter of the size
  Noisy,      ///< C: noise of 1 % instead of 0.3 %
  Pair,       ///< D: two effects, the second at 30 %
  WrongLoop,  ///< E: the simulation's hysteresis loop has the wrong shape
};

/// @throws std::invalid_argument
Tier tier_of(char letter);
char letter_of(Tier tier);

/// Identifies a case; it determines everything else.
struct CaseId {
  std::uint64_t seed = 0;
  std::uint64_t number = 0;
  Tier tier = Tier::Standard;
};

/// A case with its concealed effects: none, one or several.
struct TrialCase {
  CaseId id;
  std::vector<const Effect*> hidden;
  Physics physics{};           ///< with the effects, without the records' offsets
  std::vector<Plane> offsets;  ///< of the load cell in each record [N]
  ChannelNoise noise;
  std::vector<Excitation> excitations;
  std::vector<Record> records;  ///< fit, second, unseen

  [[nodiscard]] Physics physics_of(std::size_t record) const;  ///< with that record's offsets
};

/// Returns the effects that a case conceals.
std::vector<const Effect*> plan(const CaseId& id);

/// Returns the effects of a block of cases of that tier, in no particular order. nullptr stands for
/// a case without an effect.
std::vector<const Effect*> block_of(Tier tier);

TrialCase make_case(const CaseId& id, const std::vector<GroundMotion>& motions);

}  // namespace trial
