// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rths/sim/ground_motion.hpp>
#include <rths/sim/isolated_plant.hpp>
#include <rths/sim/substructure.hpp>

namespace rths::sim {

/// Source of the vertical restoring force of the plant.
enum class VerticalFeedback {
  Model,    ///< a spring and a dashpot, solved exactly: the specimen's force has no influence
  Measured  ///< the specimen's force, integrated by α-OS: a hybrid test of the vertical axis too
};

/// How a structure is analysed.
struct AnalysisSettings {
  GroundMotion motion;
  double bearing_initial_stiffness = 0;  ///< of the tested bearing [N/m]
  double time_step = 0.01;               ///< between targets [s]
  double alpha = -0.05;                  ///< of α-OS [-]
  VerticalFeedback vertical = VerticalFeedback::Model;
  int substeps = 1;  ///< of the integration between targets
};

/// What a picture of a structure shows: some of its nodes, its first modes, and its bearings.
struct StructureSketch {
  Eigen::Matrix3Xd nodes, bearings;  ///< places: long, lat and up [m]
  Eigen::VectorXd loads;             ///< of each bearing at rest [N]
  std::size_t tested = 0;            ///< bearing
  /// Modes on the bearings' initial stiffness: motion of the nodes, 3·nodes × modes, of any size.
  Eigen::MatrixXd shapes;
  Eigen::VectorXd frequencies;  ///< [Hz]
  Eigen::MatrixXd mass_shares;  ///< of the mass that moves in long, lat and up, modes × 3 [-]
};

/// A structure on bearings, one of which is the specimen. Each analysis of it is a substructure of
/// its own, whose monitors are the accelerations of the ground and of the floors.
class StructureModel {
 public:
  virtual ~StructureModel() = default;

  /// @throws Error if it cannot be analysed in this way   @setup
  [[nodiscard]] virtual std::unique_ptr<Substructure> analysis(
      const AnalysisSettings& settings) const = 0;
  /// The same structure without isolation; its targets are 0.   @setup
  [[nodiscard]] virtual std::unique_ptr<Substructure> analysis_on_fixed_base(
      const AnalysisSettings& settings) const = 0;
  [[nodiscard]] virtual std::vector<std::string> floors() const = 0;  ///< names
  [[nodiscard]] virtual double weight() const = 0;                    ///< on the tested bearing [N]
  /// Whether horizontal motion varies the load of the tested bearing.
  [[nodiscard]] virtual bool overturns() const = 0;
  /// Its size and weight in a line, for a user to check their units; empty: none is needed.
  [[nodiscard]] virtual std::string summary() const { return ""; }
  /// None for a structure that is too small for a picture.
  [[nodiscard]] virtual std::optional<StructureSketch> sketch() const { return std::nullopt; }
  /// Of a structure that is small enough to solve in every frequency; null for others.
  [[nodiscard]] virtual const PlantMatrices* matrices() const { return nullptr; }
};

/// Sticks on bearings that all move alike.
class StickModel final : public StructureModel {
 public:
  /// @throws Error as `assemble`   @setup
  explicit StickModel(const IsolatedPlant& plant);
  explicit StickModel(PlantMatrices plant);

  [[nodiscard]] std::unique_ptr<Substructure> analysis(
      const AnalysisSettings& settings) const override;
  [[nodiscard]] std::unique_ptr<Substructure> analysis_on_fixed_base(
      const AnalysisSettings& settings) const override;
  [[nodiscard]] std::vector<std::string> floors() const override { return plant_.floor_names; }
  [[nodiscard]] double weight() const override;
  [[nodiscard]] bool overturns() const override;
  [[nodiscard]] const PlantMatrices* matrices() const override { return &plant_; }

 private:
  PlantMatrices plant_;
};

}  // namespace rths::sim
