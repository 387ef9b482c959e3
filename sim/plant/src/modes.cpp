// SPDX-License-Identifier: Apache-2.0
#include <rths/plant/modes.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Spectra/SymEigsSolver.h>
#include <fmt/format.h>

#include <rths/core/error.hpp>

#include "memory.hpp"

namespace rths::plant {
namespace {

constexpr double kTolerance = 1e-8;
constexpr Index kMostRestarts = 100;
constexpr Index kFirstModes = 64;
// The number of modes of a plant grows as f²; a few too many cost less than another search.
constexpr double kGrowth = 2.2, kLeastMore = 1.25, kMostMore = 8;

/// M^½ K⁻¹ M^½: its largest values are the inverses of the lowest ω².
class Flexibility {
 public:
  using Scalar = double;

  Flexibility(Factor& factor, const VectorXd& mass) : factor_{factor}, root_{mass.cwiseSqrt()} {}
  [[nodiscard]] Index rows() const { return root_.size(); }
  [[nodiscard]] Index cols() const { return root_.size(); }
  [[nodiscard]] const VectorXd& root() const { return root_; }
  void perform_op(const double* in, double* out) const {  // NOLINT: the name is Spectra's
    load_ = VectorXd::Map(in, rows()).cwiseProduct(root_);
    factor_.solve(load_, motion_);
    VectorXd::Map(out, rows()) = motion_.cwiseProduct(root_);
  }

 private:
  Factor& factor_;
  VectorXd root_;
  mutable VectorXd load_, motion_;
};

}  // namespace

StructureModes lowest_modes(Factor& factor, const VectorXd& mass, Index count) {
  Flexibility flexibility{factor, mass};
  const Index basis = std::min(mass.size(), 2 * count + 20);
  // The basis of the search, and the modes as it returns them and as they are kept.
  require_memory(
      fmt::format("the search for {} modes of {} degrees of freedom", count, mass.size()),
      8.0 * static_cast<double>(mass.size() * (basis + 2 * count)));
  Spectra::SymEigsSolver<Flexibility> solver{flexibility, count, basis};
  solver.init();
  const Index found = solver.compute(Spectra::SortRule::LargestAlge, kMostRestarts, kTolerance,
                                     Spectra::SortRule::LargestAlge);
  if (found < count || solver.info() != Spectra::CompInfo::Successful)
    throw Error{fmt::format("{} of {} modes were found", found, count)};
  StructureModes modes;
  modes.frequencies = solver.eigenvalues().cwiseInverse().cwiseSqrt() / (2 * std::numbers::pi);
  modes.shapes = flexibility.root().cwiseInverse().asDiagonal() * solver.eigenvectors();
  return modes;
}

StructureModes modes_up_to(Factor& factor, const VectorXd& mass, double frequency) {
  const Index most = mass.size() / 2;
  for (Index count = std::min(kFirstModes, most);;) {
    StructureModes modes = lowest_modes(factor, mass, count);
    const auto below = (modes.frequencies.array() <= frequency).count();
    if (below < count) {
      modes.frequencies.conservativeResize(below + 1);
      modes.shapes.conservativeResize(Eigen::NoChange, below + 1);
      return modes;
    }
    if (count == most)
      throw Error{fmt::format(
          "more than {} modes lie below {:g} Hz: is the stiffness in N/m? Then lower the limit",
          most, frequency)};
    const double more = std::clamp(std::pow(frequency / modes.frequencies[count - 1], kGrowth),
                                   kLeastMore, kMostMore);
    count = std::min(most, static_cast<Index>(more * static_cast<double>(count)));
  }
}

}  // namespace rths::plant
