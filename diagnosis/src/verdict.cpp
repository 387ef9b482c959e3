// SPDX-License-Identifier: Apache-2.0
#include <rths/diagnosis/verdict.hpp>

namespace rths::diagnosis {

std::string name_of(Outcome outcome) {
  switch (outcome) {
    case Outcome::Missing:
      return "missing";
    case Outcome::None:
      return "none";
    case Outcome::Unknown:
      break;
  }
  return "unknown";
}

std::string name_of(Part part) {
  switch (part) {
    case Part::Numerical:
      return "numerical";
    case Part::Actuator:
      return "actuator";
    case Part::Machine:
      return "machine";
    case Part::Bearing:
      return "bearing";
    case Part::Structure:
      return "structure";
    case Part::Sensor:
      break;
  }
  return "sensor";
}

}  // namespace rths::diagnosis
