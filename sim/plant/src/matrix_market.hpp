// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include <rths/plant/structure.hpp>

namespace rths::plant {

/// A square matrix of a Matrix Market file, coordinate real, symmetric or general.
/// Source: Boisvert, Pozo & Remington, The Matrix Market Exchange Formats, NISTIR 5935 (1996).
/// @throws Error naming file and line   @setup
[[nodiscard]] SparseMatrix read_matrix(const std::filesystem::path& file);
/// The diagonal of a matrix that has no other entries, all of them positive.
/// @throws Error as read_matrix   @setup
[[nodiscard]] VectorXd read_diagonal(const std::filesystem::path& file);

/// The lower triangle, as a symmetric matrix.   @setup
[[nodiscard]] std::string lower_triangle_text(const SparseMatrix& matrix);
[[nodiscard]] std::string diagonal_text(const VectorXd& diagonal);

}  // namespace rths::plant
