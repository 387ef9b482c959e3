// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "effects.hpp"
#include "hybrid_test.hpp"

namespace trial {

/// How hard a trial is.
enum class Tier {
  Standard,   ///< A
  Small,      ///< B: a quarter of the size
  Noisy,      ///< C: noise of 1 % instead of 0.3 %
  Pair,       ///< D: two effects, the second at 30 %
  WrongLoop,  ///< E: the simulation's own loop has the wrong shape
};

/// @throws std::invalid_argument
Tier tier_of(char letter);
char letter_of(Tier tier);

/// Which case: everything else follows from it.
struct CaseId {
  std::uint64_t seed = 0;
  std::uint64_t number = 0;
  Tier tier = Tier::Standard;
};

/// One concealed effect, or several, or none.
struct TrialCase {
  CaseId id;
  std::vector<const Effect*> hidden;
  Physics physics{};           ///< with the effects; offsets are those of no record
  std::vector<Plane> offsets;  ///< of the load cell in each record [N]
  ChannelNoise noise;
  std::vector<Excitation> excitations;
  std::vector<Record> records;  ///< fit, second, unseen

  [[nodiscard]] Physics physics_of(std::size_t record) const;  ///< with that record's offsets
};

/// What such a case conceals; empty: nothing.
std::vector<const Effect*> plan(const CaseId& id);

/// Every row of what a block of cases of that tier goes through, in no particular order.
std::vector<const Effect*> block_of(Tier tier);  ///< nullptr: nothing is concealed

TrialCase make_case(const CaseId& id, const std::vector<GroundMotion>& motions);

}  // namespace trial
