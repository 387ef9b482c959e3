// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/folds.hpp>

#include <algorithm>
#include <bit>
#include <cstdint>

#include <rths/identification/constants.hpp>

namespace rths::diagnosis {
namespace {

// Weights that select half of the pieces of a record. Short pieces give each half a share of the
// strongest peak. The order of Thue and Morse (number of ones in the binary number of a piece) has
// no period, so that no half sees the same part of each period of a motion.
ArrayXd half_of_pieces(const Drive& drive, bool odd) {
  const auto longest = static_cast<Index>(kLongestPiece / drive.time_step + 1e-6);
  const Index piece = std::clamp<Index>(drive.rows() / kPieces, 1, std::max<Index>(1, longest));
  ArrayXd weight(drive.rows());
  for (Index row = 0; row < drive.rows(); ++row) {
    const auto number = static_cast<std::uint64_t>(row / piece);
    weight[row] = (std::popcount(number) % 2 == 1) == odd ? 1 : 0;
  }
  return weight;
}

// Rows near gaps of a record are in no fold.
void bar_gaps(const Problem& problem, Fold& fold) {
  for (auto& share : fold.shares) {
    const ArrayXd& present = problem.drive(share.record).present;
    if (present.size() == 0) continue;
    share.weight = share.weight.size() > 0 ? ArrayXd{share.weight * present} : present;
  }
}

}  // namespace

Split split_of(const std::vector<Record>& records) {
  Split split;
  std::vector<const Record*> held;
  for (const auto& record : records) {
    if (record.use == Use::Fit) split.records.push_back(&record);
    if (record.use == Use::HeldOut) held.push_back(&record);
  }
  split.by_record = held.size() == 2 && split.records.size() < kManyRecords;
  if (split.by_record) {
    split.records.push_back(held[0]);
    held.erase(held.begin());
  }
  split.held = held;
  return split;
}

Folds folds_of(const Split& split, const Problem& problem) {
  Folds folds;
  const std::size_t count = problem.records();
  for (std::size_t i = 0; i < count; ++i) {
    const bool is_second = problem.record(i).use == Use::HeldOut;
    if (split.by_record) {
      (is_second ? folds.second : folds.first).shares.push_back({i, {}});
    } else if (count >= kManyRecords) {
      (i % 2 == 1 ? folds.second : folds.first).shares.push_back({i, {}});
    } else {
      folds.first.shares.push_back({i, half_of_pieces(problem.drive(i), false)});
      folds.second.shares.push_back({i, half_of_pieces(problem.drive(i), true)});
    }
    folds.both.shares.push_back({i, {}});
  }
  for (Fold* fold : {&folds.first, &folds.second, &folds.both}) bar_gaps(problem, *fold);
  return folds;
}

}  // namespace rths::diagnosis
