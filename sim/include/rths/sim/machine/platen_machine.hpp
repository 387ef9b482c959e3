// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>

#include <Eigen/Core>

#include <rths/core/config.hpp>
#include <rths/core/realtime.hpp>
#include <rths/sim/bearing.hpp>
#include <rths/sim/machine/friction.hpp>
#include <rths/sim/machine/geometry.hpp>
#include <rths/sim/machine/hydraulics.hpp>

namespace rths::sim::machine {

inline constexpr std::size_t kHorizontal = 4;  ///< actuators: two along long, then two along lat
inline constexpr std::size_t kVertical = 4;    ///< actuators, with bearing pads on top
inline constexpr std::size_t kActuators = kHorizontal + kVertical;
inline constexpr std::size_t kArms = 4;  ///< ne, se, nw, sw; an outrigger pad above and one below
/// Friction surfaces: eight outrigger pads, and the vertical bearings together.
inline constexpr std::size_t kSurfaces = 2 * kArms + 1;

/// Limits of the platen's coordinates, ±: long, lat, vert [m], [m/s], [N]; rotations [rad].
struct PlatenLimits {
  Eigen::Vector3d stroke{1.22, 0.61, 0.127};
  Eigen::Vector3d velocity{1.778, 0.762, 0.254};
  Eigen::Vector3d force{8.9e6, 4.45e6, 53.4e6};
  double rotation = 0.034906585;
};

/// A pair of preloaded pads at the end of an arm of the platen, above and below a level floor. Each
/// pushes with preload ± (k δ + c δ̇), and never pulls.
struct Outriggers {
  std::array<Eigen::Vector3d, kArms> arm{};  ///< from the centre of mass, platen's axes [m]
  double preload = 50e3;                     ///< of each pad [N]
  double stiffness = 2e5;                    ///< of each pad [N/m]
  double damping = 2e4;                      ///< of each pad [N·s/m]

  /// Force of a pad that is pushed [N], ≥ 0.   @realtime
  [[nodiscard]] double pad(double push) const RTHS_REALTIME {
    return std::max(0.0, preload + push);
  }
  /// Force of a pair on the platen, upwards [N], when the upper pad is pushed.   @realtime
  [[nodiscard]] double pair(double push) const RTHS_REALTIME { return pad(-push) - pad(push); }
};

/// Friction of the nine surfaces. Each surface carries a ninth of `coulomb` and of `viscous`, and
/// `coefficient` times its normal force.
struct PlatenFriction {
  LuGre law;
  Eigen::Vector2d coulomb{2'100, 5'600};  ///< independent of the load: long, lat [N]
  Eigen::Vector2d viscous{716, 870};      ///< σ₂, sum: long, lat [N·s/m]
  double coefficient = 0.002;             ///< [-]
  double boundary_coefficient = 0.05;     ///< of load beyond the lift capacity [-]
  double lift_pressure = 8.963e6;         ///< of the hydrostatic bearings [Pa]
  double pad_area = 1.6;                  ///< effective, of each bearing [m²]

  /// Load that the hydrostatic bearings lift [N].
  [[nodiscard]] double lift_capacity() const { return kVertical * pad_area * lift_pressure; }
};

/// The specimen's vertical law between platen and reaction frame: a spring that softens with shear,
/// a dashpot, and the height that a pendulum gains.
///     N = max(0, K_v δ + c δ̇),  K_v = K_v0/(1 + 3 u²/(π² r²)),  δ = z + u²/(2 R)
struct VerticalSpecimen {
  double stiffness = 5.446e9;          ///< K_v0 [N/m], > 0
  double damping = 5e6;                ///< c [N·s/m]
  double radius_of_gyration = 0.3492;  ///< r [m]; 0: no softening
  double pendulum_radius = 0;          ///< R [m]; 0: no lift
  double height = 0.37;                ///< [m]
};

/// White normal noise [standard deviations], and the filters of the conditioners (second order,
/// Butterworth).
struct Transducers {
  double displacement_noise = 5e-5;             ///< [m]
  double rotation_noise = 1e-5;                 ///< [rad]
  double force_noise = 5e3;                     ///< [N]
  double vertical_force_noise = 3e4;            ///< [N]
  double moment_noise = 1e4;                    ///< [N·m]
  double acceleration_noise = 0.0490333;        ///< [m/s²]
  double displacement_filter = 300;             ///< [Hz]
  double force_filter = 200;                    ///< [Hz]
  double acceleration_filter = 100;             ///< [Hz]
  Eigen::Vector2d force_offset{2'000, -1'500};  ///< of the table force: long, lat [N]
};

/// The force loop around the displacement loops of the vertical actuators, as in the paper's
/// cascade: ż_ref = gain (N_ref − N)/stiffness.
struct ForceLoop {
  double gain = 6;           ///< [1/s]
  double stiffness = 5.4e9;  ///< assumed, of the specimen [N/m]
};

/// A bearing test machine with six degrees of freedom. docs/theory/platen_machine.md has the
/// equations, and the source of every value of the machine's file.
struct PlatenMachine {
  std::string title;
  Eigen::Vector3d mass{113'371, 116'836, 113'371};  ///< effective: long, lat, vert [kg]
  Eigen::Vector3d inertia{136e3, 223e3, 340e3};     ///< roll, pitch, yaw [kg·m²]
  double depth = 0.5;                               ///< centre of mass to bottom [m]
  double top = 0.5;                                 ///< centre of mass to specimen [m]
  PlatenLimits limits;
  std::array<Eigen::Vector3d, kHorizontal> base{};    ///< swivels on the frame [m]
  std::array<Eigen::Vector3d, kHorizontal> swivel{};  ///< swivels on the platen [m]
  std::array<Eigen::Vector2d, kVertical> foot{};      ///< of the vertical actuators [m]
  Actuator along_long, along_lat, vertical;
  Supply supply;
  Outriggers outriggers;
  PlatenFriction friction;
  Transducers transducers;
  ForceLoop force_loop;
  VerticalSpecimen vertical_specimen;
  double transport_delay = 0.002;  ///< of the references [s]
  bool has_specimen = true;        ///< false: an empty table
  bool has_rollers = false;        ///< in place of a specimen: they carry its load without friction
  Bearing specimen;                ///< its horizontal physics, and its load at the start
  std::uint64_t seed = 1;

  [[nodiscard]] const Actuator& actuator(std::size_t i) const {
    return i < 2 ? along_long : i < kHorizontal ? along_lat : vertical;
  }
  [[nodiscard]] double weight() const;  ///< of the platen [N]
  [[nodiscard]] bool carries_load() const { return has_specimen || has_rollers; }
};

/// Format version of a machine's file, its key `machine`. Bump it when an existing file would
/// change its meaning or no longer load.
inline constexpr int kPlatenMachineFormat = 1;

/// Reads a machine's file. All keys are required but those with a default in the structs above.
/// @throws Error with the place of the first wrong key or value   @setup
[[nodiscard]] PlatenMachine read_platen_machine(const Config& table);

/// Natural frequencies of the platen on its oil columns, at mid-stroke, valves closed, empty table:
/// ascending [Hz].   @setup
[[nodiscard]] Vector6 natural_frequencies(const PlatenMachine& machine);

/// A machine of the family around `nominal`, and the factor on its specimen's stiffness.
struct FamilyMember {
  PlatenMachine machine;
  double specimen_stiffness = 1;  ///< factor [-]
};
inline constexpr int kFamilySize = 200;
/// Draws uniformly: bulk modulus ±20 %, valve frequency ±15 %, dead band 0.5 to 2 %, friction ±50
/// %, specimen stiffness ±30 %. The draw depends only on `index`.
/// @param index  0: nominal; 1 to kFamilySize  @throws Error otherwise   @setup
[[nodiscard]] FamilyMember family_member(const PlatenMachine& nominal, int index);
/// A bearing with all its horizontal stiffnesses multiplied by a factor; strengths stay.   @setup
[[nodiscard]] Bearing with_stiffness(Bearing bearing, double factor);

}  // namespace rths::sim::machine
