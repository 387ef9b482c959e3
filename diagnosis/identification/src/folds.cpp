// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/folds.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <map>
#include <string_view>

#include <rths/identification/constants.hpp>

namespace rths::diagnosis {
namespace {

// Rows of a piece. Short pieces give each half a share of the strongest peak. Coarse rows have
// pieces of some rows, whatever their rate is.
Index length_of_piece(const Drive& drive) {
  const auto in_time = static_cast<Index>(kLongestPiece / drive.time_step + 1e-6);
  const Index longest = drive.has_time ? std::max(kLeastRowsOfPiece, in_time) : kLeastRowsOfPiece;
  return std::clamp<Index>(drive.rows() / kPieces, 1, longest);
}

// Whether a law may depend on a recorded quantity, by its role or its name among the states.
bool is_state(std::string_view name) {
  constexpr std::string_view kStates[] = {"auxiliary.", "vertical_force", "axial load",
                                          "temperature"};
  return std::any_of(std::begin(kStates), std::end(kStates),
                     [&](std::string_view state) { return name.starts_with(state); });
}

// Which third of its range a state has in the middle of each piece.
void add_thirds(const VectorXd& state, Index piece, std::vector<std::size_t>& strata) {
  const double low = state.minCoeff(), range = state.maxCoeff() - low;
  const bool varies = range > kSteadyShare * state.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < strata.size(); ++i) {
    const Index row = std::min(static_cast<Index>(i) * piece + piece / 2, state.size() - 1);
    const double share = varies ? (state[row] - low) / range : 0;
    strata[i] = 3 * strata[i] + std::min<std::size_t>(2, static_cast<std::size_t>(3 * share));
  }
}

// Pieces with one amplitude of the motion and one level of the recorded states belong to one
// stratum.
std::vector<std::size_t> strata_of(const Drive& drive, Index piece) {
  std::vector<std::size_t> strata(static_cast<std::size_t>((drive.rows() + piece - 1) / piece));
  if (drive.displacement.size() > 0) add_thirds(drive.displacement.rowwise().norm(), piece, strata);
  for (const auto& [name, state] : drive.states)
    if (is_state(name) && state.size() == drive.rows()) add_thirds(state, piece, strata);
  return strata;
}

// Whether the number of a piece belongs to the second half. The order of Thue and Morse (number of
// ones in the binary number) has no period, so that no half sees the same part of each period of a
// motion.
bool is_second(std::size_t number) { return std::popcount(number) % 2 == 1; }

// Which pieces belong to the second half: by their order in the record, or, if one half then has
// less than a quarter of a stratum, by their order in their stratum.
std::vector<bool> second_half(const std::vector<std::size_t>& strata) {
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> counts;  // all, in the second half
  std::vector<bool> by_record, by_stratum;
  for (std::size_t i = 0; i < strata.size(); ++i) {
    auto& [all, second] = counts[strata[i]];
    by_stratum.push_back(is_second(all));
    by_record.push_back(is_second(i));
    ++all;
    second += by_record.back() ? 1 : 0;
  }
  const bool is_even = std::all_of(counts.begin(), counts.end(), [](const auto& stratum) {
    const auto [all, second] = stratum.second;
    return all < kFewPieces || (4 * second >= all && 4 * (all - second) >= all);
  });
  return is_even ? by_record : by_stratum;
}

struct Halves {
  ArrayXd first, second;
};

Halves halves_of(const Drive& drive) {
  const Index piece = length_of_piece(drive);
  const auto second = second_half(strata_of(drive, piece));
  Halves halves{ArrayXd(drive.rows()), {}};
  for (Index row = 0; row < drive.rows(); ++row)
    halves.first[row] = second[static_cast<std::size_t>(row / piece)] ? 0 : 1;
  halves.second = 1 - halves.first;
  return halves;
}

// Rows near gaps of a record are in no fold.
void bar_gaps(const Problem& problem, Fold& fold) {
  for (auto& share : fold.shares) {
    const ArrayXd& present = problem.drive(share.record).present;
    if (present.size() == 0) continue;
    share.weight = share.weight.size() > 0 ? ArrayXd{share.weight * present} : present;
  }
}

struct DriverRange {
  double low = 1e300, high = -1e300;
  void include(const std::vector<double>& values) {
    const auto [least, most] = std::minmax_element(values.begin(), values.end());
    low = std::min(low, *least);
    high = std::max(high, *most);
  }
  [[nodiscard]] double width() const { return high - low; }
};

// The first recorded state that varies far less within one of two groups of records than in both.
std::string undetermined_in(const std::vector<const Record*>& one,
                            const std::vector<const Record*>& other) {
  for (const Channel& channel : one[0]->channels) {
    if (!is_state(channel.role)) continue;
    DriverRange all;
    std::vector<double> widths;
    for (const auto* group : {&one, &other}) {
      DriverRange own;
      for (const Record* record : *group)
        if (const Channel* same = record->find(channel.role); same && !same->values.empty())
          own.include(same->values);
      all.low = std::min(all.low, own.low);
      all.high = std::max(all.high, own.high);
      widths.push_back(own.width());
    }
    const double size = std::max(std::abs(all.low), std::abs(all.high));
    if (all.width() > kSteadyShare * size &&
        *std::min_element(widths.begin(), widths.end()) < kDeterminedShare * all.width())
      return channel.role;
  }
  return "";
}

// Every second record.
std::vector<const Record*> alternate(const std::vector<const Record*>& records, std::size_t from) {
  std::vector<const Record*> chosen;
  for (std::size_t i = from; i < records.size(); i += 2) chosen.push_back(records[i]);
  return chosen;
}

}  // namespace

Split split_of(const std::vector<Record>& records) {
  Split split;
  std::vector<const Record*> held;
  for (const auto& record : records) {
    if (record.use == Use::Fit) split.records.push_back(&record);
    if (record.use == Use::HeldOut) held.push_back(&record);
  }
  const bool is_one_scored = held.size() == 2 && split.records.size() < kManyRecords;
  if (is_one_scored) {
    split.undetermined = undetermined_in(split.records, {held[0]});
    split.records.push_back(held[0]);
    held.erase(held.begin());
  } else if (split.records.size() >= kManyRecords) {
    split.undetermined = undetermined_in(alternate(split.records, 0), alternate(split.records, 1));
  }
  split.by_record = is_one_scored && split.undetermined.empty();
  split.held = held;
  return split;
}

Folds folds_of(const Split& split, const Problem& problem) {
  Folds folds;
  const std::size_t count = problem.records();
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_scored = problem.record(i).use == Use::HeldOut;
    if (split.by_record) {
      (is_scored ? folds.second : folds.first).shares.push_back({i, {}});
    } else if (count >= kManyRecords && split.undetermined.empty()) {
      (i % 2 == 1 ? folds.second : folds.first).shares.push_back({i, {}});
    } else {
      Halves halves = halves_of(problem.drive(i));
      folds.first.shares.push_back({i, std::move(halves.first)});
      folds.second.shares.push_back({i, std::move(halves.second)});
    }
    folds.both.shares.push_back({i, {}});
  }
  for (Fold* fold : {&folds.first, &folds.second, &folds.both}) bar_gaps(problem, *fold);
  return folds;
}

}  // namespace rths::diagnosis
