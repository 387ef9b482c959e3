// SPDX-License-Identifier: Apache-2.0
#include <rths/verdict/verdict.hpp>

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

}  // namespace rths::diagnosis
