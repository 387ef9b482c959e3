// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/control_points.hpp>
#include <rths/adapters/opensees.hpp>

#include "specimen.hpp"

namespace rths::adapters {

/// The words between OpenFresco and the controller that our elements need: which ports they are,
/// and what is written to and read from them.
class OpfWords {
 public:
  /// Without control points of the user's own, words that no element needs are left alone.
  /// @throws Error if the laboratory lacks a word that an element needs, or two want the same
  OpfWords(const ControlPoints& points, const std::vector<OpenSeesElement>& elements);

  /// In the order of their words: what is read, what is written.
  [[nodiscard]] std::vector<Port> feedbacks() const;
  [[nodiscard]] std::vector<Port> commands() const;

  /// Whether it matters where everything stands before the test.
  [[nodiscard]] bool is_relative_to_measured() const;
  /// Where everything stands before the test: what is relative to that, is from now on.
  void start(std::span<const double> feedbacks);
  /// The words that no element moves: where they are measured to be, if they are relative to that.
  void write_idle(std::span<double> commands) const;
  /// An element's first trial: likewise.
  void start(std::size_t element, const Specimen::Command& first);
  /// Measured along the axes of an element. Displacements: none if the map has no words for them.
  [[nodiscard]] Measured measured(std::size_t element, std::span<const double> feedbacks) const;
  /// Writes what an element commands, and the time of the trial.
  /// @throws Error if a value leaves the limits of its control point; nothing more is written then
  void write(std::size_t element, const Specimen::Command& command, double time,
             std::span<double> commands);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// A word with what it belongs to.
  struct Word {
    ControlSignal signal;
    std::size_t element = kNone;
    std::size_t axis = 0;
    double sign = 1;
    bool is_load = false;
    double offset = 0;
  };
  void bind(const OpenSeesElement& element, std::size_t number);
  [[nodiscard]] static Word& word(std::vector<Word>& words, const OpenSeesElement& element,
                                  const std::string& axis, Quantity quantity);
  [[nodiscard]] static double value_of(const Word& word, const Specimen::Command& command);

  std::vector<Word> commands_, feedbacks_;
  /// Of each element: how many axes, and whether their displacements are measured.
  struct Axes {
    Eigen::Index count = 0;
    bool has_displacement = false;
  };
  std::vector<Axes> axes_;
};

}  // namespace rths::adapters
