// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string>

#include <rths/plant/bearings.hpp>
#include <rths/plant/modes.hpp>

namespace rths::plant {

struct BasisSettings {
  double frequency_limit = 50;     ///< of the modes on post-yield bearings [Hz]
  bool has_static_vectors = true;  ///< without them, local forces of the bearings are lost
  std::size_t tested_bearing = 0;
  bool keeps_all_shapes = false;  ///< of all degrees of freedom, see Basis::all_shapes
};

/// A structure in coordinates q of a reduced basis Ψ, u = Ψ q: the mass is 1 and the stiffness on
/// the bearings' initial springs diagonal.
///
///     modes:   K_L φ = ω² M φ with post-yield springs, up to a frequency
///     static:  K_I⁻¹ Bᵀ g of 6 patterns of each kind of bearings in each direction,
///              K_I⁻¹ M ι,  K_I⁻¹ Bᵀ of the tested one
///     Ψ = W V,  W: their M-orthonormal basis,  WᵀK_I W = V Λ Vᵀ
///
/// Modes alone miss how the mat bends under the forces of its bearings.
struct Basis {
  VectorXd stiffness;                      ///< Λ, of each coordinate [1/s²]
  MatrixXd bearings;                       ///< Ψ at the bearings, 3 × bearings rows [kg^-½]
  MatrixXd floors;                         ///< Ψ at the floors, 3 × floors rows [kg^-½]
  MatrixXd participation;                  ///< Ψᵀ M ι, coordinate × 3 [kg^½]
  VectorXd weights;                        ///< static compression of each bearing [N]
  VectorXd frequencies;                    ///< of the modes on post-yield springs [Hz]
  std::array<double, kDirections> mass{};  ///< of the structure in each direction [kg]
  Index dofs = 0;                          ///< of the structure
  MatrixXd nodes, bearing_places;          ///< for pictures: some nodes; bearings, 3 × each [m]
  MatrixXd shapes;                         ///< first coordinates at these nodes, 3·nodes × modes
  /// Ψ, dof × coordinates; empty unless asked for, and not kept in a file [kg^-½].
  MatrixXd all_shapes;

  [[nodiscard]] Index coordinates() const { return stiffness.size(); }
  /// Of the coordinates: modes on the bearings' initial springs [Hz].
  [[nodiscard]] VectorXd initial_frequencies() const;
  /// Of the mass that moves in long, lat and up, coordinate × 3 [-].
  [[nodiscard]] MatrixXd mass_shares() const;
  [[nodiscard]] Index static_vectors() const { return coordinates() - frequencies.size(); }
  /// A recorded coordinate is q/√M, with the mass M along [kg^-½]: a displacement of the whole
  /// mass.
  [[nodiscard]] double to_metres() const { return 1 / std::sqrt(mass[0]); }
  /// u of some rows of Ψ, by recorded coordinates: a column for each instant [m].
  [[nodiscard]] MatrixXd displacement(const MatrixXd& rows, const MatrixXd& coordinates) const {
    return rows * coordinates / to_metres();
  }
};

/// Name of a recorded coordinate, from 1.   @setup
[[nodiscard]] std::string coordinate_name(Index coordinate);

/// @throws Error if a matrix is not positive definite, if there is no such tested bearing, and as
///         stiffness_of, Structure::on_springs and modes_up_to   @setup
[[nodiscard]] Basis make_basis(const Structure& structure, const BearingSet& bearings,
                               const BasisSettings& settings);

/// Static compression of each bearing under the structure's weight, on a factor of K_I [N]. @setup
[[nodiscard]] VectorXd static_weights(const Structure& structure, const BearingSet& bearings,
                                      Factor& factor);

}  // namespace rths::plant
