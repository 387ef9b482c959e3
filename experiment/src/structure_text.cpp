// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tables.hpp"

namespace rths::experiment {
namespace {

using Eigen::Index;

// [[x, y, z], …] of a vector of three numbers after the other, in units of 1/`per_unit`.
std::string triples(const Eigen::MatrixXd& values, double per_unit) {
  std::string text = "[";
  for (Index i = 0; i + 2 < values.size(); i += 3)
    text += fmt::format("{}[{:.4g},{:.4g},{:.4g}]", i == 0 ? "" : ",", per_unit * values(i),
                        per_unit * values(i + 1), per_unit * values(i + 2));
  return text + "]";
}

}  // namespace

std::string structure_text(const sim::StructureSketch& sketch) {
  std::string modes;
  for (Index i = 0; i < sketch.frequencies.size(); ++i) {
    const Eigen::VectorXd shape = sketch.shapes.col(i);
    const double largest = shape.cwiseAbs().maxCoeff();
    const Eigen::RowVectorXd shares = 100 * sketch.mass_shares.row(i);
    modes += fmt::format("{}{{\"frequency_Hz\":{:.5g},\"mass_percent\":[{:.3g}],\"shape\":{}}}",
                         i == 0 ? "" : ",", sketch.frequencies[i], fmt::join(shares, ","),
                         triples(shape, largest > 0 ? 1 / largest : 1));
  }
  const Eigen::RowVectorXd loads = 1e-6 * sketch.loads.transpose();
  return fmt::format(
      "{{\"nodes_m\":{},\"bearings_m\":{},\"loads_MN\":[{:.4g}],\"tested\":{},\"modes\":[{}]}}",
      triples(sketch.nodes, 1), triples(sketch.bearings, 1), fmt::join(loads, ","), sketch.tested,
      modes);
}

}  // namespace rths::experiment
