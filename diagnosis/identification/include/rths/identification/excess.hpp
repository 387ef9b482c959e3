// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include <rths/identification/problem.hpp>

namespace rths::diagnosis {

/// A residual, and realisations of its noise: rows × outputs each.
struct Seen {
  MatrixXd residual;
  std::vector<MatrixXd> noise;
};

/// The residual of a problem's first record that neither the hypothesis' free parameters nor free
/// offsets can explain. It is divided by the size of the noise at each time. One filter whitens it
/// at all times, so that residuals at different times are comparable.
/// @throws Error if there is no prediction
[[nodiscard]] Seen seen_at(const Problem& problem, const Hypothesis& hypothesis);

/// The same of a hypothesis that is complete, in place of the measurement: without noise.
/// @throws Error if there is no prediction
[[nodiscard]] Seen seen_at(const Problem& problem, const Hypothesis& hypothesis,
                           const Hypothesis& complete);

using Energies = std::vector<double>;  ///< by cell

/// Energy of a residual and expected energy of its noise, by cell.
class Cells {
 public:
  /// @param energies  returns the energies of a signal, by cell
  Cells(const Seen& seen, const std::function<Energies(const MatrixXd&)>& energies);

  [[nodiscard]] std::size_t size() const { return energy_.size(); }
  [[nodiscard]] bool is_empty(std::size_t cell) const { return energy_[cell] == 0; }
  [[nodiscard]] double beyond_noise(std::size_t cell) const {
    return energy_[cell] - expected_[cell];
  }
  /// Fraction of a cell's energy that is not noise: 0 … 1.
  [[nodiscard]] double signal_share(std::size_t cell) const;
  /// Shares of the energy that is beyond the noise and its scatter.
  [[nodiscard]] std::vector<double> shares() const;
  /// The smallest set of cells that holds most of the excess.
  [[nodiscard]] std::vector<bool> place() const;

 private:
  Energies energy_, expected_, scatter_;
};

/// Energies by cell of rows and outputs. Cells beyond the last are ignored.
[[nodiscard]] std::function<Energies(const MatrixXd&)> by_row(
    std::size_t cells, const Drive& drive,
    const std::function<std::size_t(Index row, Index output)>& cell_of);

/// Energies by frequency band, of signals padded to twice their length.
class Bands {
 public:
  /// @param edges  [Hz]
  Bands(const std::vector<double>& edges, const Drive& drive);
  [[nodiscard]] Energies energies(const MatrixXd& signal) const;
  /// The signal with each band multiplied by a weight, and without the frequencies outside the
  /// bands.
  [[nodiscard]] MatrixXd weighed(const MatrixXd& signal, std::vector<double> weights) const;

 private:
  [[nodiscard]] std::size_t band(Index bin) const { return band_[static_cast<std::size_t>(bin)]; }
  [[nodiscard]] VectorXcd transformed(const VectorXd& signal) const;

  Index rows_, length_;
  std::size_t count_;
  std::vector<std::size_t> band_;  // of every bin; count_: beyond all edges
};

}  // namespace rths::diagnosis
