// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/factor.hpp>

#include <suitesparse/cholmod.h>

#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "memory.hpp"

namespace rths::plant {
namespace {

// Of the diagonal. Rounding leaves up to 1e-13 where nothing holds a part, of either sign; a plant
// on post-yield bearings keeps 3e-3.
constexpr double kLeastPivot = 1e-11;
// Beyond the factor itself, for the updates of its largest blocks.
constexpr double kWork = 1.3;

// Squares of the diagonal of a supernodal factor, in the factor's order.
template <class Visit>
void visit_pivots(const cholmod_factor& factor, const Visit& visit) {
  const auto *super = static_cast<const int*>(factor.super),
             *rows = static_cast<const int*>(factor.pi),
             *first = static_cast<const int*>(factor.px);
  const auto* values = static_cast<const double*>(factor.x);
  for (std::size_t s = 0; s < factor.nsuper; ++s) {
    const int height = rows[s + 1] - rows[s];
    for (int k = 0; k < super[s + 1] - super[s]; ++k) {
      const double root = values[first[s] + k * height + k];
      visit(super[s] + k, root * root);
    }
  }
}

[[noreturn]] void throw_not_positive(int row) {
  throw Error{fmt::format(
      "the matrix is not positive definite at row {}: expected a structure on its bearings without "
      "a part that moves freely",
      row + 1)};
}

}  // namespace

struct Factor::Cholmod {
  cholmod_common common{};
  cholmod_factor* factor = nullptr;
  cholmod_dense *x = nullptr, *y = nullptr, *e = nullptr;  // kept between solutions
  std::size_t rows = 0;

  Cholmod() {
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.print = 0;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;  // a third fewer entries than AMD for solids
    common.postorder = 1;
  }
  ~Cholmod() {
    for (auto* dense : {&x, &y, &e}) cholmod_free_dense(dense, &common);
    cholmod_free_factor(&factor, &common);
    cholmod_finish(&common);
  }
  Cholmod(const Cholmod&) = delete;
  Cholmod& operator=(const Cholmod&) = delete;

  void require_memory() const {
    if (common.status == CHOLMOD_OUT_OF_MEMORY || common.status == CHOLMOD_TOO_LARGE)
      throw Error{fmt::format("no memory to factorise a matrix of {} rows", rows)};
  }
};

Factor::Factor(const SparseMatrix& matrix) : cholmod_{std::make_unique<Cholmod>()} {
  SparseMatrix lower = matrix.triangularView<Eigen::Lower>();
  lower.makeCompressed();
  cholmod_sparse sparse{};
  sparse.nrow = sparse.ncol = cholmod_->rows = static_cast<std::size_t>(lower.rows());
  sparse.nzmax = static_cast<std::size_t>(lower.nonZeros());
  sparse.p = lower.outerIndexPtr();
  sparse.i = lower.innerIndexPtr();
  sparse.x = lower.valuePtr();
  sparse.stype = -1;
  sparse.itype = CHOLMOD_INT;
  sparse.xtype = CHOLMOD_REAL;
  sparse.dtype = CHOLMOD_DOUBLE;
  sparse.sorted = sparse.packed = 1;
  cholmod_->factor = cholmod_analyze(&sparse, &cholmod_->common);
  cholmod_->require_memory();
  if (cholmod_->factor == nullptr) throw Error{"the matrix cannot be analysed for its factor"};
  require_memory(fmt::format("the factor of a matrix of {} rows", cholmod_->rows),
                 kWork * sizeof(double) * static_cast<double>(entries()));
  cholmod_factorize(&sparse, cholmod_->factor, &cholmod_->common);
  cholmod_->require_memory();
  const auto* order = static_cast<const int*>(cholmod_->factor->Perm);
  if (const std::size_t column = cholmod_->factor->minor; column < cholmod_->rows)
    throw_not_positive(order[column]);
  // By rounding, the last pivots of a singular matrix are small instead of zero.
  const VectorXd diagonal = matrix.diagonal();
  visit_pivots(*cholmod_->factor, [&](int column, double pivot) {
    if (!(pivot > kLeastPivot * diagonal[order[column]])) throw_not_positive(order[column]);
  });
}
Factor::~Factor() = default;
Factor::Factor(Factor&&) noexcept = default;
Factor& Factor::operator=(Factor&&) noexcept = default;

void Factor::solve(const VectorXd& b, VectorXd& x) {
  cholmod_dense right{};
  right.nrow = right.nzmax = right.d = cholmod_->rows;
  right.ncol = 1;
  right.x = const_cast<double*>(b.data());
  right.xtype = CHOLMOD_REAL;
  right.dtype = CHOLMOD_DOUBLE;
  cholmod_solve2(CHOLMOD_A, cholmod_->factor, &right, nullptr, &cholmod_->x, nullptr, &cholmod_->y,
                 &cholmod_->e, &cholmod_->common);
  cholmod_->require_memory();
  x.resize(b.size());
  std::memcpy(x.data(), cholmod_->x->x, cholmod_->rows * sizeof(double));
}

std::size_t Factor::entries() const {
  const cholmod_factor& factor = *cholmod_->factor;
  return factor.is_super != 0 ? factor.xsize : factor.nzmax;
}

}  // namespace rths::plant
