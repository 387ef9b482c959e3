// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include <rths/adapters/adapter.hpp>
#include <rths/adapters/control_points.hpp>
#include <rths/adapters/opensees.hpp>

#include "specimen.hpp"

namespace rths::adapters {

/// The words between OpenFresco and the controller that the elements use: their ports, the values
/// written to them and the values read from them.
class OpfWords {
 public:
  /// Without declared control points, only words that an element uses become ports.
  /// @throws Error if the map lacks a word that an element needs, or two axes use the same word
  OpfWords(const ControlPoints& points, const std::vector<OpenSeesElement>& elements);

  /// Ports to read and to write, in the order of their words.
  [[nodiscard]] std::vector<Port> feedbacks() const;
  [[nodiscard]] std::vector<Port> commands() const;

  /// Whether any signal is relative to the measurement before the test.
  [[nodiscard]] bool is_relative_to_measured() const;
  /// Takes the measurement before the test: the start position, and the offsets of signals that are
  /// relative to it.
  void set_start(std::span<const double> feedbacks);
  /// Writes the commands of axes without an element: their start position if relative to it, else
  /// 0.
  void write_unused(std::span<double> commands) const;
  /// Sets the offsets of signals that are relative to an element's first trial.
  void set_first_trial(std::size_t element, const Specimen::Command& first);
  /// Returns the measurement along the axes of an element; without displacements if the map lacks
  /// them.
  [[nodiscard]] Measurement measured(std::size_t element, std::span<const double> feedbacks) const;
  /// Whether a command moves an element from its start position by more than `distance` [m, rad].
  [[nodiscard]] bool is_away(std::size_t element, const Specimen::Command& command,
                             double distance) const;
  /// @throws Error if a command moves an element by more than `largest` from its start [m, rad]
  void require_near_start(std::size_t element, const Specimen::Command& command,
                          double largest) const;
  /// Writes an element's commands and the time of the trial.
  /// @throws Error if a value exceeds its word or the limits of its control point; the rest is not
  ///         written
  void write(std::size_t element, const Specimen::Command& command, double time,
             std::span<double> commands);

 private:
  static constexpr std::size_t kNone = static_cast<std::size_t>(-1);
  /// A word and the axis that uses it.
  struct Word {
    ControlSignal signal;
    std::size_t element = kNone;
    std::size_t axis = 0;
    double sign = 1;
    bool is_load = false;
    double offset = 0;
    double start = 0;  ///< of a displacement: measured before the test

    void claim(std::size_t by_element, std::size_t by_axis, double with_sign);
  };
  void bind(const OpenSeesElement& element, std::size_t number);
  void bind_axis(const OpenSeesElement& element, std::size_t number, const MovedAxis& axis,
                 std::size_t k);
  // Not every laboratory has velocities, accelerations and measured displacements.
  void bind_optional(std::size_t number, const std::string& axis, std::size_t k);
  [[nodiscard]] static Word& word(std::vector<Word>& words, const OpenSeesElement& element,
                                  const std::string& axis, OpfQuantity quantity);
  [[nodiscard]] static double moved_from_start(const Word& word, const Specimen::Command& command);
  [[nodiscard]] static double value_of(const Word& word, const Specimen::Command& command);

  std::vector<Word> commands_, feedbacks_;
  /// Of each element: the number of axes, and whether their displacements are measured.
  struct Axes {
    Eigen::Index count = 0;
    bool has_displacement = false;
  };
  std::vector<Axes> axes_;
};

}  // namespace rths::adapters
