// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "parameters.hpp"
#include "random.hpp"

namespace trial {

/// Which recorded quantities an effect contradicts when all else is as measured.
enum class Relation {
  Force,      ///< motion of the platen → force
  Kinematic,  ///< displacement ↔ acceleration
  Actuator,   ///< command → displacement
};

enum class Home { Library, Outside };

/// From where to where a parameter of an effect is drawn.
struct Draw {
  Parameter parameter;
  double low, high;          ///< of the standard size
  bool is_size = false;      ///< the effect grows from nothing with it
  bool either_sign = false;  ///< mirrored at random
};

struct Effect {
  std::string_view name;     ///< as in the library of the diagnosis
  std::string_view part;     ///< bearing, machine, actuator, sensor
  std::string_view channel;  ///< in which it is seen
  Relation relation;
  std::vector<Draw> draws;
  Home home = Home::Library;
  std::string_view form = "";  ///< for effects outside the library: what may be said of it
  std::string_view kin = "";   ///< a term that libraries may have by now and that describes it
};

std::vector<Effect> bearing_effects();
std::vector<Effect> machine_effects();
std::vector<Effect> force_sensor_effects();
std::vector<Effect> other_sensor_effects();
std::vector<Effect> actuator_effects();
std::vector<Effect> outside_effects();

/// All of the above, made once.
const std::vector<Effect>& effects();

/// @throws std::invalid_argument
const Effect& effect(std::string_view name);

/// Puts the effect, `size` times its standard size, into the physics.
void add(const Effect& effect, double size, Random& random, Physics& physics);

/// Takes it out again.
void remove(const Effect& effect, Physics& physics);

}  // namespace trial
