// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <rths/identification/signal.hpp>

namespace rths::diagnosis {

/// Removes a sine from the samples of a sensor at rest, if two or more stretches have one of the
/// same frequency that carries more than a quarter of the energy of each. A sensor has no such
/// noise, but a pump or a fan is heard at rest.
/// @param stretches  with zero mean
/// @returns its frequency [Hz]; 0: there is none
double remove_line(std::vector<Stretch>& stretches);

}  // namespace rths::diagnosis
