// SPDX-License-Identifier: Apache-2.0
#include "shapes.hpp"

#include <algorithm>
#include <cstdint>

// One copy of a function for each generation of processors, chosen when the program starts. Address
// sanitizer does not know the choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RTHS_FOR_ALL_PROCESSORS \
  [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default"), gnu::optimize("O3")]]
#else
#define RTHS_FOR_ALL_PROCESSORS
#endif

namespace rths::plant {
namespace {

constexpr Index kLine = Shapes::kLine;
constexpr Index kBlock = 512;  // rows whose results stay in the first cache

// y += A x and w += A v for four columns of A.
RTHS_FOR_ALL_PROCESSORS
void add_columns(const float* a, Index stride, Index rows, const double* x, const double* v,
                 double* __restrict y, double* __restrict w) {
  const float *a0 = a, *a1 = a + stride, *a2 = a1 + stride, *a3 = a2 + stride;
  const double x0 = x[0], x1 = x[1], x2 = x[2], x3 = x[3];
  const double v0 = v[0], v1 = v[1], v2 = v[2], v3 = v[3];
  for (Index i = 0; i < rows; ++i) {
    const double b0 = a0[i], b1 = a1[i], b2 = a2[i], b3 = a3[i];
    y[i] += b0 * x0 + b1 * x1 + b2 * x2 + b3 * x3;
    w[i] += b0 * v0 + b1 * v1 + b2 * v2 + b3 * v3;
  }
}

// Aᵀ x for four columns of A. The sums of 16 rows that belong together are added in a fixed order.
RTHS_FOR_ALL_PROCESSORS
void add_products(const float* a, Index stride, Index rows, const double* x, double* result) {
  double sums[4][kLine] = {};
  for (Index i = 0; i < rows; i += kLine)
    for (Index column = 0; column < 4; ++column)
      for (Index k = 0; k < kLine; ++k)
        sums[column][k] += static_cast<double>(a[column * stride + i + k]) * x[i + k];
  for (Index column = 0; column < 4; ++column) {
    double sum = 0;
    for (const double part : sums[column]) sum += part;
    result[column] = sum;
  }
}

}  // namespace

Shapes::Shapes(const MatrixXd& shapes)
    : rows_{shapes.rows()}, columns_{shapes.cols()}, stride_{up_to_multiple(rows_, kLine)} {
  values_.assign(static_cast<std::size_t>(stride_ * columns_ + kLine), 0.0F);
  constexpr std::uintptr_t kBytes = kLine * sizeof(float);
  const auto address = reinterpret_cast<std::uintptr_t>(values_.data());
  offset_ = static_cast<std::size_t>((kBytes - address % kBytes) % kBytes) / sizeof(float);
  for (Index column = 0; column < columns_; ++column)
    for (Index row = 0; row < rows_; ++row)
      values_[offset_ + static_cast<std::size_t>(column * stride_ + row)] =
          static_cast<float>(shapes(row, column));
}

void Shapes::multiply(const VectorXd& first, const VectorXd& second,
                      MatrixXd& result) const noexcept {
  const float* const shapes = values_.data() + offset_;
  result.setZero();
  for (Index row = 0; row < rows_; row += kBlock) {
    const Index rows = std::min(kBlock, rows_ - row);
    for (Index column = 0; column < columns_; column += kColumns)
      add_columns(shapes + column * stride_ + row, stride_, rows, first.data() + column,
                  second.data() + column, result.col(0).data() + row, result.col(1).data() + row);
  }
}

void Shapes::multiply_transposed(const VectorXd& x, VectorXd& result) const noexcept {
  const float* const shapes = values_.data() + offset_;
  for (Index column = 0; column < columns_; column += kColumns)
    add_products(shapes + column * stride_, stride_, stride_, x.data(), result.data() + column);
}

}  // namespace rths::plant
