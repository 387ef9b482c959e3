// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <rths/identification/problem.hpp>

namespace rths::diagnosis {

/// The hypothesis with its free parameters fitted to a fold; unchanged if it has no prediction.
[[nodiscard]] Hypothesis fitted(const Problem& problem, const Hypothesis& hypothesis,
                                const Fold& fold, int iterations);

/// A fit of the hypothesis to a fold; none if the hypothesis has no prediction.
[[nodiscard]] std::optional<Fit> fit_if_possible(const Problem& problem,
                                                 const Hypothesis& hypothesis, const Fold& fold,
                                                 int iterations);

/// Half the sum of squares of each block of a fold [nat].
[[nodiscard]] std::vector<double> scores(const Problem& problem, const Hypothesis& hypothesis,
                                         const Fold& fold);

/// Whether the outputs have one unit: then the standard deviation of all of them scales the error,
/// otherwise each output has its own.
[[nodiscard]] bool have_one_unit(const Relation& relation);
/// Sum of squares of each column.
[[nodiscard]] ArrayXd energy_of(MatrixXd signal, bool about_mean);
/// Root mean square of the outputs over that of another signal [-]. Outputs of different units
/// count alike.
/// @param energy  of the outputs   @param of  energy of the other signal
[[nodiscard]] double relative_size(const Relation& relation, const ArrayXd& energy,
                                   const ArrayXd& of);

/// Smallest change of a prediction that counts, see change_of: integration, filters and sampling
/// may cause as much.
/// Root mean square difference of the predictions of two hypotheses, without free offsets, over the
/// standard deviation of the output [-]. Outputs of different units count alike.
/// @param without_shift  without what a shift in time explains
[[nodiscard]] double change_of(const Problem& problem, const Hypothesis& before,
                               const Hypothesis& after, const Fold& fold,
                               bool without_shift = false);

/// a − b, block by block; as long as the shorter of the two.
[[nodiscard]] std::vector<double> minus(const std::vector<double>& a, const std::vector<double>& b);
[[nodiscard]] double sum(const std::vector<double>& values);

/// Sums of resampled blocks: a block bootstrap of the records, each block with its neighbours.
[[nodiscard]] std::vector<double> resampled_sums(const std::vector<double>& blocks,
                                                 std::uint64_t seed);

}  // namespace rths::diagnosis
