// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/record.hpp>

#include <vector>

#include <rths/identification/relation.hpp>

namespace rths::diagnosis {

ArrayXd Drive::compared() const {
  ArrayXd weight = present.size() > 0 ? present : ArrayXd::Ones(rows());
  weight.head(first_row).setZero();
  return weight;
}

MatrixXd Drive::compared_rows(const MatrixXd& signal) const {
  if (present.size() == 0) return signal.bottomRows(rows() - first_row);
  std::vector<Index> taken;
  for (Index row = first_row; row < rows(); ++row)
    if (present[row] != 0) taken.push_back(row);
  return signal(taken, Eigen::all);
}

std::string family_of(std::string_view role) { return std::string{role.substr(0, role.find('.'))}; }

bool is_predicted(std::string_view role) { return role.starts_with(kPredicted); }

std::string prediction_of(std::string_view role) { return std::string{kPredicted}.append(role); }

bool is_measured(std::string_view role) {
  return !is_predicted(role) && !role.starts_with("command.") && !role.starts_with("input.") &&
         !role.starts_with("auxiliary.");
}

std::string name_of(Use use) {
  if (use == Use::Fit) return "fit";
  return use == Use::HeldOut ? "held_out" : "reference";
}

std::size_t Record::samples() const { return channels.empty() ? 0 : channels[0].values.size(); }

const Channel* Record::find(const std::string& role) const {
  for (const auto& channel : channels)
    if (channel.role == role) return &channel;
  return nullptr;
}

VectorXd values_of(const Channel& channel) {
  return VectorXd::Map(channel.values.data(), static_cast<Index>(channel.values.size()));
}

}  // namespace rths::diagnosis
