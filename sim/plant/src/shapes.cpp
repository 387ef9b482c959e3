// SPDX-License-Identifier: Apache-2.0
#include "shapes.hpp"

#include <algorithm>
#include <utility>

// Where one function may have a copy for each generation of processors, chosen when the program
// starts. Address sanitizer does not know the choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define RTHS_FOR_DEFAULT_PROCESSOR [[gnu::target("default"), gnu::optimize("O3")]]
#define RTHS_FOR_PROCESSOR(generation) [[gnu::target("arch=" generation), gnu::optimize("O3")]]
#else
#define RTHS_FOR_DEFAULT_PROCESSOR
#endif

namespace rths::plant {
namespace {

constexpr Index kPanel = Shapes::kPanel, kParts = Shapes::kParts;
constexpr Index kVectors = 4;  // rows that are summed at once, in vectors: they stay in registers

template <Index kLanes>
using Doubles [[gnu::vector_size(static_cast<std::size_t>(kLanes) * sizeof(double))]] = double;

// Written out, because one instruction loads and widens a vector only so.
template <class Vector, Index... kLane>
[[gnu::always_inline]] inline void widen(const float* a, Vector& rows,
                                         std::integer_sequence<Index, kLane...>) {
  rows = Vector{a[kLane]...};
}

// A x and A v of one panel A.
template <Index kLanes>
[[gnu::always_inline]] inline void multiply_in(const float* panel, Index columns, const double* x,
                                               const double* v, double (*products)[kPanel]) {
  using Vector = Doubles<kLanes>;
  for (Index first = 0; first < kPanel; first += kVectors * kLanes) {
    Vector x_sums[kVectors] = {}, v_sums[kVectors] = {};
    const float* a = panel + first;
    for (Index column = 0; column < columns; ++column, a += kPanel)
      for (Index k = 0; k < kVectors; ++k) {
        Vector rows;
        widen(a + k * kLanes, rows, std::make_integer_sequence<Index, kLanes>{});
        x_sums[k] += rows * x[column];
        v_sums[k] += rows * v[column];
      }
    for (Index k = 0; k < kVectors; ++k) {
      reinterpret_cast<Vector*>(products[0] + first)[k] = x_sums[k];
      reinterpret_cast<Vector*>(products[1] + first)[k] = v_sums[k];
    }
  }
}

// sums += Aᵀ x of one panel A: by column, of the rows that are equal modulo kParts.
template <Index kLanes>
[[gnu::always_inline]] inline void add_products_in(const float* a, Index columns, const double* x,
                                                   double* sums) {
  using Vector = Doubles<kLanes>;
  for (Index column = 0; column < columns; ++column, a += kPanel, sums += kParts)
    for (Index part = 0; part < kParts; part += kLanes) {
      Vector sum = *reinterpret_cast<const Vector*>(sums + part);
      for (Index row = part; row < kPanel; row += kParts) {
        Vector rows;
        widen(a + row, rows, std::make_integer_sequence<Index, kLanes>{});
        sum += rows * *reinterpret_cast<const Vector*>(x + row);
      }
      *reinterpret_cast<Vector*>(sums + part) = sum;
    }
}

RTHS_FOR_DEFAULT_PROCESSOR
void multiply_panel(const float* panel, Index columns, const double* x, const double* v,
                    double (*products)[kPanel]) {
  multiply_in<2>(panel, columns, x, v, products);
}
RTHS_FOR_DEFAULT_PROCESSOR
void add_products(const float* panel, Index columns, const double* x, double* sums) {
  add_products_in<2>(panel, columns, x, sums);
}

#ifdef RTHS_FOR_PROCESSOR
RTHS_FOR_PROCESSOR("x86-64-v3")
void multiply_panel(const float* panel, Index columns, const double* x, const double* v,
                    double (*products)[kPanel]) {
  multiply_in<4>(panel, columns, x, v, products);
}
RTHS_FOR_PROCESSOR("x86-64-v3")
void add_products(const float* panel, Index columns, const double* x, double* sums) {
  add_products_in<4>(panel, columns, x, sums);
}
RTHS_FOR_PROCESSOR("x86-64-v4")
void multiply_panel(const float* panel, Index columns, const double* x, const double* v,
                    double (*products)[kPanel]) {
  multiply_in<8>(panel, columns, x, v, products);
}
RTHS_FOR_PROCESSOR("x86-64-v4")
void add_products(const float* panel, Index columns, const double* x, double* sums) {
  add_products_in<8>(panel, columns, x, sums);
}
#endif

}  // namespace

Shapes::Shapes(const MatrixXd& shapes)
    : rows_{shapes.rows()},
      columns_{shapes.cols()},
      panels_(static_cast<std::size_t>(up_to_multiple(rows_, kPanel) / kPanel * columns_)),
      sums_(static_cast<std::size_t>(columns_)) {
  for (Index column = 0; column < columns_; ++column)
    for (Index row = 0; row < rows_; ++row)
      panels_[static_cast<std::size_t>(row / kPanel * columns_ + column)].rows[row % kPanel] =
          static_cast<float>(shapes(row, column));
}

void Shapes::multiply(const VectorXd& first, const VectorXd& second,
                      MatrixXd& result) const noexcept {
  alignas(64) double products[2][kPanel];
  const Column* panel = panels_.data();
  for (Index row = 0; row < rows_; row += kPanel, panel += columns_) {
    multiply_panel(panel->rows, columns_, first.data(), second.data(), products);
    for (Index k = 0; k < 2; ++k)
      std::copy_n(products[k], std::min(kPanel, rows_ - row), result.col(k).data() + row);
  }
}

void Shapes::multiply_transposed(const VectorXd& x, VectorXd& result) noexcept {
  alignas(64) double rows[kPanel];
  std::fill(sums_.begin(), sums_.end(), Sums{});
  // Backwards: the panels that were read last are still in the cache.
  const Column* panel = panels_.data() + panels_.size();
  for (Index row = up_to_multiple(rows_, kPanel) - kPanel; row >= 0; row -= kPanel) {
    panel -= columns_;
    std::copy_n(x.data() + row, kPanel, rows);
    add_products(panel->rows, columns_, rows, sums_.data()->parts);
  }
  for (Index column = 0; column < columns_; ++column) {
    const auto& parts = sums_[static_cast<std::size_t>(column)].parts;
    result[column] = ((parts[0] + parts[1]) + (parts[2] + parts[3])) +
                     ((parts[4] + parts[5]) + (parts[6] + parts[7]));
  }
}

}  // namespace rths::plant
