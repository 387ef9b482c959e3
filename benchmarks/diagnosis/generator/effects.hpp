// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>
#include <vector>

#include "parameters.hpp"
#include "random.hpp"

namespace trial {

/// The recorded quantities between which an effect shows.
enum class Relation {
  Force,      ///< motion of the platen → force
  Kinematic,  ///< displacement ↔ acceleration
  Actuator,   ///< command → displacement
};

enum class Home { Library, Outside };

/// Range from which a parameter of an effect is drawn.
struct Draw {
  Parameter parameter;
  double low, high;          ///< at the standard size
  bool is_size = false;      ///< the effect vanishes as this parameter becomes absent
  bool either_sign = false;  ///< with a random sign
};

inline constexpr bool kSize = true, kEitherSign = true;  ///< values of a Draw's last two members

struct Effect {
  std::string_view name;     ///< of the generator; names.py of the trial maps it to the diagnosis
  std::string_view part;     ///< bearing, machine, actuator, sensor
  std::string_view channel;  ///< that shows the effect
  Relation relation;
  std::vector<Draw> draws;
  Home home = Home::Library;
  std::string_view form = "";  ///< expected description of an effect outside the library
  std::string_view kin = "";   ///< term of a later library that describes the effect
};

std::vector<Effect> bearing_effects();
std::vector<Effect> machine_effects();
std::vector<Effect> force_sensor_effects();
std::vector<Effect> other_sensor_effects();
std::vector<Effect> actuator_effects();
std::vector<Effect> outside_effects();

/// All effects above.
const std::vector<Effect>& effects();

/// @throws std::invalid_argument
const Effect& effect(std::string_view name);

/// Adds the effect to the physics, at `size` times its standard size.
void add(const Effect& effect, double size, Random& random, Physics& physics);

/// Removes the effect from the physics.
void remove(const Effect& effect, Physics& physics);

}  // namespace trial
