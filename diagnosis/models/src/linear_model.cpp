// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>

#include "linear_parts.hpp"

namespace rths::diagnosis {
namespace {

// Roots of longer polynomials depend on the last digits of the coefficients.
constexpr std::size_t kMostOrder = 20;

// y = (b₀ sᵐ + … + bₘ) / (a₀ sⁿ + … + aₙ) u, its coefficients as parameters.
struct TransferFunction {
  std::size_t input = 0, output = 0;
  Index numerator = 0, denominator = 0;  // index of their first coefficient among the parameters
  Index zeros = 0, poles = 0;            // m, n
  std::optional<Index> feedthrough;      // index of a feedthrough that may be missing
};

std::size_t index_of(std::vector<std::string>& roles, const std::string& role) {
  const auto found = std::find(roles.begin(), roles.end(), role);
  if (found != roles.end()) return static_cast<std::size_t>(found - roles.begin());
  roles.push_back(role);
  return roles.size() - 1;
}

Index add_coefficients(const Config& table, const std::string& key, const std::string& prefix,
                       DynamicModel& model) {
  const auto first = static_cast<Index>(model.parameters.size());
  const auto numbers = table.numbers(key);
  if (numbers.empty() || numbers[0] == 0)
    table.fail(key, fmt::format("{} must begin with a number that is not 0: that of the highest "
                                "power",
                                key));
  const std::size_t order = numbers.size() - 1;
  if (order > kMostOrder)
    table.fail(key, fmt::format("{} is of order {}, expected at most {}: give a larger system as "
                                "matrices A, B, C",
                                key, order, kMostOrder));
  int number = 0;
  for (const double value : numbers)
    model.parameters.push_back(
        {fmt::format("{}{}.{}", prefix, key, ++number), "1", value, "coefficient_error", {}});
  // One of all coefficients only sets the unit, so it cannot be wrong.
  if (key == "denominator") model.parameters[static_cast<std::size_t>(first)].error.clear();
  return first;
}

TransferFunction read_transfer(const Config& table, const std::string& prefix,
                               DynamicModel& model) {
  TransferFunction transfer;
  transfer.input = index_of(model.inputs, table.text("input"));
  transfer.output = index_of(model.outputs, table.text("output"));
  transfer.numerator = add_coefficients(table, "numerator", prefix, model);
  transfer.zeros = static_cast<Index>(table.numbers("numerator").size()) - 1;
  transfer.denominator = add_coefficients(table, "denominator", prefix, model);
  transfer.poles = static_cast<Index>(table.numbers("denominator").size()) - 1;
  if (transfer.zeros > transfer.poles)
    table.fail("numerator", fmt::format("numerator is of order {}, denominator of order {}: "
                                        "expected at most the denominator's order",
                                        transfer.zeros, transfer.poles));
  if (transfer.zeros < transfer.poles) {
    transfer.feedthrough = static_cast<Index>(model.parameters.size());
    model.parameters.push_back({prefix + "feedthrough", "1", 0, "direct_feedthrough",
                                std::pair{transfer.input, transfer.output}});
  }
  return transfer;
}

// Controllable canonical form, from state `first` on.
void put(const TransferFunction& transfer, const VectorXd& values, Index first,
         LinearSystem& system) {
  const Index n = transfer.poles;
  const VectorXd a = values.segment(transfer.denominator, n + 1) / values[transfer.denominator];
  VectorXd b = VectorXd::Zero(n + 1);
  b.tail(transfer.zeros + 1) =
      values.segment(transfer.numerator, transfer.zeros + 1) / values[transfer.denominator];
  const auto input = static_cast<Index>(transfer.input);
  const auto output = static_cast<Index>(transfer.output);
  for (Index i = 0; i < n; ++i) {
    if (i + 1 < n) system.a(first + i, first + i + 1) = 1;
    system.a(first + n - 1, first + i) = -a[n - i];
    system.c(output, first + i) += b[n - i] - b[0] * a[n - i];
  }
  if (n > 0) system.b(first + n - 1, input) = 1;
  system.d(output, input) += b[0];
  if (transfer.feedthrough) system.d(output, input) += values[*transfer.feedthrough];
}

DynamicModel read_transfers(const Config& table) {
  DynamicModel model;
  std::vector<TransferFunction> transfers;
  const auto tables = table.tables("transfer");
  if (tables.empty()) transfers.push_back(read_transfer(table, "", model));
  for (const auto& one : tables) {
    transfers.push_back(
        read_transfer(one, fmt::format("transfer.{}.", transfers.size() + 1), model));
    one.reject_unknown_keys();
  }
  const auto inputs = static_cast<Index>(model.inputs.size());
  const auto outputs = static_cast<Index>(model.outputs.size());
  finish_linear(
      table,
      [=](const VectorXd& values, Index connections) {
        Index states = 0;
        for (const auto& transfer : transfers) states += transfer.poles;
        LinearSystem system = LinearSystem::zeros(states, inputs, outputs, connections);
        Index first = 0;
        for (const auto& transfer : transfers) {
          put(transfer, values, first, system);
          first += transfer.poles;
        }
        return system;
      },
      model);
  return model;
}

}  // namespace

DynamicModel read_linear(const Config& table) {
  return table.has("A") ? read_state_space(table) : read_transfers(table);
}

}  // namespace rths::diagnosis
