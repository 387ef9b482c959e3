// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "linear_parts.hpp"

namespace rths::diagnosis {
namespace {

// The entries of a matrix as parameters "A.1.2".
Index add_entries(const MatrixXd& matrix, const std::string& name, DynamicModel& model) {
  const auto first = static_cast<Index>(model.parameters.size());
  for (Index i = 0; i < matrix.rows(); ++i)
    for (Index j = 0; j < matrix.cols(); ++j)
      model.parameters.push_back(
          {fmt::format("{}.{}.{}", name, i + 1, j + 1), "1", matrix(i, j), "", {}});
  return first;
}

MatrixXd entries_at(const VectorXd& values, Index first, Index rows, Index columns) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(values.data() + first, rows, columns);
}

MatrixXd read_sized(const Config& table, const std::string& key, Index rows, Index columns) {
  const MatrixXd matrix = read_matrix(table, key);
  if (matrix.rows() != rows || matrix.cols() != columns)
    table.fail(key, fmt::format("{} is {} by {}, expected {} by {}", key, matrix.rows(),
                                matrix.cols(), rows, columns));
  return matrix;
}

}  // namespace

DynamicModel read_state_space(const Config& table) {
  DynamicModel model;
  model.inputs = table.texts("inputs");
  model.outputs = table.texts("outputs");
  const auto inputs = static_cast<Index>(model.inputs.size());
  const auto outputs = static_cast<Index>(model.outputs.size());
  if (inputs == 0) table.fail("inputs", "inputs is empty");
  if (outputs == 0) table.fail("outputs", "outputs is empty");
  const MatrixXd square = read_matrix(table, "A");
  const Index n = square.rows();
  const Index a = add_entries(read_sized(table, "A", n, n), "A", model);
  const Index b = add_entries(read_sized(table, "B", n, inputs), "B", model);
  const Index c = add_entries(read_sized(table, "C", outputs, n), "C", model);
  const MatrixXd direct =
      table.has("D") ? read_sized(table, "D", outputs, inputs) : MatrixXd::Zero(outputs, inputs);
  const Index d = add_entries(direct, "D", model);
  for (Index i = 0; i < outputs; ++i)
    for (Index j = 0; j < inputs; ++j)
      if (direct(i, j) == 0) {
        auto& parameter = model.parameters[static_cast<std::size_t>(d + i * inputs + j)];
        parameter.error = "direct_feedthrough";
        parameter.joins = {static_cast<std::size_t>(j), static_cast<std::size_t>(i)};
      }
  finish_linear(
      table,
      [=](const VectorXd& values, Index connections) {
        LinearSystem system = LinearSystem::zeros(n, inputs, outputs, connections);
        system.a = entries_at(values, a, n, n);
        system.b = entries_at(values, b, n, inputs);
        system.c = entries_at(values, c, outputs, n);
        system.d = entries_at(values, d, outputs, inputs);
        return system;
      },
      model);
  return model;
}

}  // namespace rths::diagnosis
