// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>

#include <rths/plant/structure.hpp>

namespace rths::plant {

/// Cholesky factor of a sparse symmetric positive definite matrix, by CHOLMOD.
class Factor {
 public:
  /// @throws Error naming the first row whose pivot is not positive, or below 1e-11 of its
  /// diagonal:
  ///         a part moves freely; and if there is no memory   @setup
  explicit Factor(const SparseMatrix& matrix);
  ~Factor();
  Factor(Factor&&) noexcept;
  Factor& operator=(Factor&&) noexcept;
  Factor(const Factor&) = delete;
  Factor& operator=(const Factor&) = delete;

  /// Solves for one right side. After the first call, it allocates nothing.
  /// @param x  overwritten; may be the same as b
  void solve(const VectorXd& b, VectorXd& x);

  [[nodiscard]] std::size_t entries() const;  ///< numbers of the factor

 private:
  struct Cholmod;
  std::unique_ptr<Cholmod> cholmod_;
};

}  // namespace rths::plant
