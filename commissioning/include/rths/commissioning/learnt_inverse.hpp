// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <rths/controller/inverse_lead.hpp>

namespace rths::commissioning {

/// Coefficients of one axis of an adaptive inverse.
struct LearntAxis {
  std::string name;                          ///< "long", "lat"
  controller::InverseLead::Terms initial;    ///< at the start of the first recording
  controller::InverseLead::Terms learnt;     ///< mean of the last second of all recordings
  controller::InverseLead::Terms deviation;  ///< largest, of a recording from that mean
  controller::InverseLead::Terms drift;      ///< largest change in the second half of a recording
};

/// The coefficients that an adaptive inverse learnt in recorded runs.
struct LearntInverse {
  std::vector<std::filesystem::path> files;
  std::string block;  ///< of the diagram
  std::vector<LearntAxis> axes;
};

/// @param block  type adaptive_inverse, of the controller's diagram
/// @throws Error if a recording lacks the block, or if it learnt nothing there   @setup
[[nodiscard]] LearntInverse learnt_inverse(const std::vector<std::filesystem::path>& files,
                                           const std::string& block);

[[nodiscard]] std::string text_of(const LearntInverse& inverse);
[[nodiscard]] std::string json_of(const LearntInverse& inverse);
/// Initial coefficients of the block, as a file of `constants` of an experiment.
[[nodiscard]] std::string toml_of(const LearntInverse& inverse);

}  // namespace rths::commissioning
