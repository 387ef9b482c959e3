// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "library.hpp"
#include "motion_drive.hpp"

namespace rths::diagnosis {

/// Settings of a relation of compositions.
struct CompositionSetup {
  std::string name;  ///< "motion to force"
  Part part = Part::Bearing;
  MotionChannels channels;
  SampleRates pace;
  bool has_free_offsets = false;
  std::vector<std::string> without;  ///< excluded kinds
  // NOLINTBEGIN(readability-redundant-member-init): initializers may leave these out
  std::vector<std::size_t> axes = {};  ///< predicted: 0 long, 1 lat
  Hypothesis base = {};
  // NOLINTEND(readability-redundant-member-init)
};

/// A relation that predicts a measurement from a motion by terms, one after the other. It models
/// the bearing and its machine (motion → force), an actuator (command → displacement), or an
/// accelerometer (displacement → acceleration).
class CompositionRelation final : public Relation {
 public:
  /// @param records  set the natural scales   @throws Error if one lacks a channel
  CompositionRelation(CompositionSetup setup, const std::vector<const Record*>& records);

  [[nodiscard]] const std::string& name() const override { return setup_.name; }
  [[nodiscard]] Part part() const override { return setup_.part; }
  [[nodiscard]] const std::vector<std::pair<std::string, std::string>>& outputs() const override {
    return outputs_;
  }
  [[nodiscard]] bool has_free_offsets() const override { return setup_.has_free_offsets; }
  [[nodiscard]] const Hypothesis& base() const override { return setup_.base; }
  [[nodiscard]] std::vector<Candidate> candidates(const Hypothesis& model) const override;
  [[nodiscard]] std::vector<std::string> drivers() const override;
  [[nodiscard]] std::unique_ptr<Drive> prepare(const Record& record) const override;
  [[nodiscard]] std::vector<std::unique_ptr<Drive>> disturbed(const Drive& drive,
                                                              const Record& noise) const override;
  [[nodiscard]] std::unique_ptr<Simulator> simulator(const Hypothesis& hypothesis,
                                                     const Drive& drive) const override;

 private:
  [[nodiscard]] int rotations() const;  ///< realisations made of one draw of noise

  CompositionSetup setup_;
  std::vector<std::pair<std::string, std::string>> outputs_;
  NaturalScale scale_;                     ///< of all axes together
  std::vector<NaturalScale> axis_scales_;  ///< of each one
};

}  // namespace rths::diagnosis
