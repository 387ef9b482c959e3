// SPDX-License-Identifier: Apache-2.0
#include <rths/identification/record.hpp>

namespace rths::diagnosis {

std::string family_of(std::string_view role) { return std::string{role.substr(0, role.find('.'))}; }

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
