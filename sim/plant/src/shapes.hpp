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
  static constexpr Index kPanel = 32;  ///< rows that are stored together, padded with 0
  static constexpr Index kParts = 8;   ///< sums of a column, which are added at the end

  explicit Shapes(const MatrixXd& shapes);

  /// Ψ x of two vectors in one pass. @param result  rows × 2, overwritten   @realtime
  void multiply(const VectorXd& first, const VectorXd& second,
                MatrixXd& result) const RTHS_REALTIME;
  /// Ψᵀ x. @param x  rows, up to a multiple of kPanel   @param result  overwritten, by column
  /// @realtime
  void multiply_transposed(const VectorXd& x, VectorXd& result) RTHS_REALTIME;

 private:
  struct alignas(64) Column {  // of a panel
    float rows[kPanel];
  };
  struct alignas(64) Sums {  // of a column, to be added
    double parts[kParts];
  };
  Index rows_, columns_;
  std::vector<Column> panels_;  // in the order in which both products read them
  std::vector<Sums> sums_;
};

}  // namespace rths::plant
