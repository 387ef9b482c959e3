// SPDX-License-Identifier: Apache-2.0
#include "dynamic_model.hpp"

namespace rths::diagnosis {

LinearSystem LinearSystem::zeros(Index states, Index inputs, Index outputs, Index connections) {
  LinearSystem system;
  system.a = MatrixXd::Zero(states, states);
  system.b = MatrixXd::Zero(states, inputs);
  system.e = MatrixXd::Zero(states, connections);
  system.c = MatrixXd::Zero(outputs, states);
  system.d = MatrixXd::Zero(outputs, inputs);
  system.h = MatrixXd::Zero(outputs, connections);
  system.p = system.r = MatrixXd::Zero(connections, states);
  system.q = system.s = system.t = MatrixXd::Zero(connections, inputs);
  system.stiffness = system.damping = VectorXd::Zero(connections);
  return system;
}

VectorXd DynamicModel::values() const {
  VectorXd result(static_cast<Index>(parameters.size()));
  for (Index i = 0; i < result.size(); ++i)
    result[i] = parameters[static_cast<std::size_t>(i)].value;
  return result;
}

}  // namespace rths::diagnosis
