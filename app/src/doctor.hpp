// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rths::app {

struct DoctorArguments {
  std::string format = "text";          ///< text or json: a line per ring, and one about real time
  std::optional<std::uint32_t> domain;  ///< of DDS: examines the network instead
  std::string interface;
  std::vector<std::string> peers;
};

/// Interfaces of this host, gateways of the domain and their clocks; advice.
/// @returns 0 if a gateway answered, otherwise 1
[[nodiscard]] int doctor_of_network(const DoctorArguments& arguments);

}  // namespace rths::app
