// SPDX-License-Identifier: Apache-2.0
#include "trial_case.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace trial {
namespace {

constexpr std::size_t kEmptyCases = 4;  ///< of a block
constexpr std::size_t kRecords = 3;
constexpr double kSecondShare = 0.3;  ///< of its standard size, in pairs

// Streams of random numbers: the seed alone determines the order of cases, the case all other
// draws.
constexpr std::uint64_t kOrderStream = 1ULL << 40U;
constexpr std::uint64_t kNoiseStream = 1ULL << 41U;

double size_of(Tier tier) { return tier == Tier::Small ? 0.25 : 1; }

double noise_level(Tier tier) { return tier == Tier::Noisy ? 0.01 : 0.003; }

// The specimen differs slightly from the simulation's assumptions.
void vary_specimen(Tier tier, Random& random, Physics& p) {
  p[kStiffness] *= random.uniform(0.93, 1.07);
  p[kStrength] *= random.uniform(0.93, 1.07);
  p[kYieldDisplacement] *= random.uniform(0.85, 1.15);
  p[kExponent] = random.uniform(1.7, 2.3);
  if (tier != Tier::WrongLoop) return;
  if (random.coin()) {
    p[kBeta] = random.coin() ? random.uniform(0.1, 0.3) : random.uniform(0.7, 0.9);
  } else {
    p[kMixShare] = random.uniform(0.25, 0.5);
    p[kMixRatio] = random.uniform(3, 6);
    p[kYieldDisplacement] *= 0.6;
  }
}

double peak_of(const Record& record, const Physics& physics) {
  return physics[kClipShare] > 0 ? record.peak_force() : record.peak_speed();
}

// A limit is set below the peak of the case itself. The record with the second largest peak is
// fitted and the one with the largest is second: both reach the limit, and neither exceeds it most
// of the time.
void set_limit(TrialCase& trial) {
  Physics& p = trial.physics;
  if (p[kClipShare] == 0 && p[kSpeedShare] == 0) return;
  Random still{0, 0};
  const ChannelNoise silence = draw_noise(0, still);
  std::vector<std::pair<double, Excitation>> reached;
  for (Excitation& excitation : trial.excitations) {
    const double peak = peak_of(run_test(excitation, p, silence, Random{0, 0}), p);
    reached.emplace_back(peak, std::move(excitation));
  }
  std::sort(reached.begin(), reached.end(),
            [](const auto& one, const auto& other) { return one.first > other.first; });
  std::swap(reached[0], reached[1]);
  for (std::size_t i = 0; i < reached.size(); ++i)
    trial.excitations[i] = std::move(reached[i].second);
  const double peak = reached[0].first;
  if (p[kClipShare] > 0) p[kClipLimit] = (1 - p[kClipShare]) * peak;
  if (p[kSpeedShare] > 0) p[kSpeedLimit] = (1 - p[kSpeedShare]) * peak;
}

void choose_excitations(const std::vector<GroundMotion>& motions, Random& random,
                        TrialCase& trial) {
  std::vector<std::size_t> left(motions.size());
  for (std::size_t i = 0; i < left.size(); ++i) left[i] = i;
  const double reach = random.uniform(0.13, 0.19);
  for (std::size_t i = 0; i < kRecords; ++i) {
    const std::size_t chosen = random.below(left.size());
    const double this_reach = reach * random.uniform(0.85, 1.1);
    trial.excitations.push_back(excite(motions[left[chosen]], this_reach, random));
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(chosen));
  }
}

bool may_pair(const Effect* candidate) {
  return candidate != nullptr && candidate->home == Home::Library &&
         candidate->relation == Relation::Force && candidate->name != "quantisation";
}

// Effects that share a parameter cannot form a pair.
bool disjoint(const Effect& one, const Effect& other) {
  return std::none_of(one.draws.begin(), one.draws.end(), [&](const Draw& mine) {
    return std::any_of(other.draws.begin(), other.draws.end(),
                       [&](const Draw& theirs) { return mine.parameter == theirs.parameter; });
  });
}

}  // namespace

Tier tier_of(char letter) {
  if (letter < 'A' || letter > 'E') throw std::invalid_argument("a tier is one of A, B, C, D, E");
  return static_cast<Tier>(letter - 'A');
}

char letter_of(Tier tier) { return static_cast<char>('A' + static_cast<int>(tier)); }

Physics TrialCase::physics_of(std::size_t record) const {
  Physics with_offsets = physics;
  with_offsets[kOffsetX] = offsets[record][0];
  with_offsets[kOffsetY] = offsets[record][1];
  return with_offsets;
}

std::vector<const Effect*> block_of(Tier tier) {
  std::vector<const Effect*> block;
  for (const Effect& candidate : effects()) {
    const bool fits = tier == Tier::Pair    ? may_pair(&candidate)
                      : tier == Tier::Small ? candidate.home == Home::Library
                                            : true;
    if (fits) block.push_back(&candidate);
  }
  if (tier != Tier::Pair && tier != Tier::Small) block.insert(block.end(), kEmptyCases, nullptr);
  return block;
}

std::vector<const Effect*> plan(const CaseId& id) {
  std::vector<const Effect*> block = block_of(id.tier);
  const std::uint64_t tier = static_cast<std::uint64_t>(id.tier);
  Random order{id.seed, kOrderStream + 16 * (id.number / block.size()) + tier};
  for (std::size_t i = block.size(); i > 1; --i) std::swap(block[i - 1], block[order.below(i)]);
  const Effect* first = block[id.number % block.size()];
  if (first == nullptr) return {};
  if (id.tier != Tier::Pair) return {first};
  Random choice{id.seed, kOrderStream * 2 + id.number};
  const Effect* second = first;
  while (!disjoint(*first, *second)) second = block[choice.below(block.size())];
  return {first, second};
}

TrialCase make_case(const CaseId& id, const std::vector<GroundMotion>& motions) {
  Random random{id.seed, id.number * 8 + static_cast<std::uint64_t>(id.tier)};
  TrialCase trial{.id = id,
                  .hidden = plan(id),
                  .physics = absent(),
                  .offsets = {},
                  .noise = {},
                  .excitations = {},
                  .records = {}};
  vary_specimen(id.tier, random, trial.physics);
  trial.noise = draw_noise(noise_level(id.tier), random);
  choose_excitations(motions, random, trial);
  for (std::size_t i = 0; i < trial.hidden.size(); ++i)
    add(*trial.hidden[i], (i == 0 ? 1 : kSecondShare) * size_of(id.tier), random, trial.physics);
  set_limit(trial);
  constexpr double kOffset = 3e3;  // [N]
  for (std::size_t i = 0; i < kRecords; ++i) {
    trial.offsets.push_back({kOffset * random.gaussian(), kOffset * random.gaussian()});
    trial.records.push_back(run_test(trial.excitations[i], trial.physics_of(i), trial.noise,
                                     Random{random.bits(), kNoiseStream + i}));
  }
  return trial;
}

}  // namespace trial
