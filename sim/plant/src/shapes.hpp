// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/core/realtime.hpp>
#include <rths/plant/structure.hpp>

namespace rths::plant {

[[nodiscard]] inline Index up_to_multiple(Index count, Index of) {
  return (count + of - 1) / of * of;
}

/// Shapes of a basis at the bearings: most of the time of a step is two passes over them.
///
/// Single precision lets them stay in the cache of one core. It moves the shapes by 6e-8 of their
/// size. As both products use the same shapes, the reduced plant stays symmetric.
class Shapes {
 public:
  static constexpr Index kLine = 16;    ///< rows of a vector are multiples of it, the rest 0
  static constexpr Index kColumns = 4;  ///< columns of the shapes are multiples of it

  explicit Shapes(const MatrixXd& shapes);

  [[nodiscard]] Index rows() const { return rows_; }
  [[nodiscard]] Index columns() const { return columns_; }
  /// Ψ x of two vectors in one pass. @param result  at least rows × 2, overwritten   @realtime
  void multiply(const VectorXd& first, const VectorXd& second,
                MatrixXd& result) const RTHS_REALTIME;
  /// Ψᵀ x. @param x  rows, up to a multiple of kLine   @param result  overwritten, by column
  /// @realtime
  void multiply_transposed(const VectorXd& x, VectorXd& result) const RTHS_REALTIME;

 private:
  Index rows_, columns_, stride_;
  std::vector<float> values_;  // column by column; each begins on a cache line,
  std::size_t offset_ = 0;     // from here on
};

}  // namespace rths::plant
