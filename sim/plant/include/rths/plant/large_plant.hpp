// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include <rths/plant/ant.hpp>
#include <rths/plant/large_plant_analysis.hpp>
#include <rths/sim/structure_model.hpp>

namespace rths::plant {

/// A large plant as a test states it.
struct PlantDescription {
  /// Makes the structure; only called if no file knows its basis.
  std::function<Structure()> structure;
  std::string key;  ///< differs for different structures, such as the numbers that define one
  std::vector<std::string> floors;
  BearingSet bearings;                                  ///< under the mean weight
  double frequency_limit = 50;                          ///< of the modes [Hz]
  double damping_ratio = 0.02, damping_frequency = 10;  ///< see PlantSettings
  std::size_t tested_bearing = 0;
  bool is_full = false;  ///< all degrees of freedom in each step, for reference
  bool monitors_coordinates = false, monitors_energy = false;
};

/// The plant family: its floors, and a key of its design. All bearings are alike.   @setup
[[nodiscard]] PlantDescription describe(const AntDesign& design, const sim::Bearing& bearing);

/// Where bases are kept: XDG_CACHE_HOME, otherwise HOME/.cache, otherwise none.
[[nodiscard]] std::optional<std::filesystem::path> cache_folder();

/// A large plant in the coordinates of a reduced basis. A basis takes seconds to minutes; it is
/// kept in a file whose name is the hash of all that it depends on.
class LargePlant final : public sim::StructureModel {
 public:
  /// @param cache  folder of the files; none: nothing is kept
  /// @throws Error as make_basis; not if a file cannot be written   @setup
  LargePlant(PlantDescription description, std::optional<std::filesystem::path> cache);

  [[nodiscard]] std::unique_ptr<sim::Substructure> analysis(
      const sim::AnalysisSettings& settings) const override;
  [[nodiscard]] std::unique_ptr<sim::Substructure> analysis_on_fixed_base(
      const sim::AnalysisSettings& settings) const override;
  [[nodiscard]] std::vector<std::string> floors() const override { return description_.floors; }
  [[nodiscard]] double weight() const override {
    return basis_.weights[static_cast<Index>(description_.tested_bearing)];
  }
  [[nodiscard]] bool overturns() const override { return basis_.weights.size() > 1; }
  [[nodiscard]] std::string summary() const override;
  [[nodiscard]] std::optional<sim::StructureSketch> sketch() const override;

  [[nodiscard]] const Basis& basis() const { return basis_; }
  /// With the shapes of all degrees of freedom, computed again: takes as long as the first time.
  /// @throws Error as make_basis   @setup
  [[nodiscard]] Basis basis_of(const Structure& structure) const;
  [[nodiscard]] const PlantDescription& description() const { return description_; }

 private:
  PlantDescription description_;
  std::optional<std::filesystem::path> cache_;
  Basis basis_;
};

}  // namespace rths::plant
