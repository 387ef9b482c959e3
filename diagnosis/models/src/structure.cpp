// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>

#include <rths/maths/decompositions.hpp>

#include "mechanics.hpp"

namespace rths::diagnosis {
namespace {

// [[model.spring]] between = [0, 1], stiffness_N_per_m, damping_N_s_per_m, and tables of terms.
void read_spring(const Config& table, Mechanics& mechanics, DynamicModel& model,
                 std::vector<ModelTerm>& terms) {
  mechanics.add_spring(mechanics.read_spring(table), model);
  const std::string& component = model.connections.back().component;
  model.parameters.push_back({component + ".stiffness",
                              "N/m",
                              table.number("stiffness_N_per_m", 0.0),
                              "stiffness_error",
                              {}});
  model.parameters.push_back({component + ".damping",
                              "N*s/m",
                              table.number_in("damping_N_s_per_m", 0, 1e30, 0.0),
                              "damping_error",
                              {}});
  for (auto& term : read_model_terms(table, component)) terms.push_back(std::move(term));
  table.reject_unknown_keys();
}

Mechanics::Matrices assembled(const Mechanics& mechanics, const VectorXd& values) {
  const Index n = mechanics.masses, springs = static_cast<Index>(mechanics.springs.size());
  Mechanics::Matrices matrices{values.head(n).asDiagonal(), MatrixXd::Zero(n, n),
                               MatrixXd::Zero(n, n), VectorXd::Zero(springs),
                               VectorXd::Zero(springs)};
  for (Index i = 0; i < springs; ++i) {
    const VectorXd stretch = mechanics.stretch(mechanics.springs[static_cast<std::size_t>(i)]);
    matrices.spring_stiffness[i] = values[n + 2 * i];
    matrices.spring_damping[i] = values[n + 2 * i + 1];
    matrices.stiffness += values[n + 2 * i] * stretch * stretch.transpose();
    matrices.damping += values[n + 2 * i + 1] * stretch * stretch.transpose();
  }
  return matrices;
}

constexpr double kSymmetry = 1e-9;  // of the largest entry

MatrixXd read_symmetric(const Config& table, const std::string& key, Index size) {
  const MatrixXd matrix = read_matrix(table, key);
  if (matrix.rows() != matrix.cols() || (size > 0 && matrix.rows() != size))
    table.fail(key, fmt::format("{} has {} rows and {} columns, expected {}", key, matrix.rows(),
                                matrix.cols(),
                                size > 0 ? fmt::format("{} of each", size) : "as many of each"));
  if ((matrix - matrix.transpose()).norm() > kSymmetry * matrix.norm())
    table.fail(key, fmt::format("{} is not symmetric", key));
  return matrix;
}

// An entry of a matrix that is a parameter: not zero, on or above the diagonal.
struct MatrixEntry {
  Index row, column;
};

// Parameters of one of the three matrices: its entries, and a factor on the whole matrix.
class MatrixParameters {
 public:
  MatrixParameters() = default;
  MatrixParameters(const MatrixXd& matrix, const std::string& name, const std::string& unit,
                   DynamicModel& model)
      : size_{matrix.rows()}, first_{static_cast<Index>(model.parameters.size())} {
    model.parameters.push_back({name + ".factor", "-", 1, name + "_error", {}});
    for (Index i = 0; i < size_; ++i)
      for (Index j = i; j < size_; ++j) {
        if (matrix(i, j) == 0) continue;
        entries_.push_back({i, j});
        model.parameters.push_back(
            {fmt::format("{}.{}.{}", name, i + 1, j + 1), unit, matrix(i, j), "", {}});
      }
  }
  [[nodiscard]] MatrixXd at(const VectorXd& values) const {
    MatrixXd matrix = MatrixXd::Zero(size_, size_);
    Index entry = first_ + 1;
    for (const auto& [row, column] : entries_)
      matrix(row, column) = matrix(column, row) = values[first_] * values[entry++];
    return matrix;
  }

 private:
  Index size_ = 0, first_ = 0;
  std::vector<MatrixEntry> entries_;
};

// C = α M + β K, or given as a matrix.
struct Damping {
  bool is_rayleigh = false;
  Index first = 0;
  MatrixParameters matrix;
};

Damping read_damping(const Config& table, Index size, DynamicModel& model) {
  Damping damping;
  damping.is_rayleigh = table.has("rayleigh");
  if (damping.is_rayleigh && table.has("damping"))
    table.fail("rayleigh", "damping is given twice, by a matrix and by rayleigh");
  damping.first = static_cast<Index>(model.parameters.size());
  if (damping.is_rayleigh) {
    const auto numbers = table.numbers("rayleigh");
    if (numbers.size() != 2)
      table.fail("rayleigh", "rayleigh must be [of mass in 1/s, of stiffness in s]");
    model.parameters.push_back({"rayleigh.mass", "1/s", numbers[0], "rayleigh_damping_error", {}});
    model.parameters.push_back(
        {"rayleigh.stiffness", "s", numbers[1], "rayleigh_damping_error", {}});
  } else if (table.has("damping")) {
    damping.matrix = {read_symmetric(table, "damping", size), "damping", "N*s/m", model};
  }
  return damping;
}

// Adds a spring for every coupling of the stiffness matrix, if the case lists no springs.
void find_springs(const MatrixXd& stiffness, Mechanics& mechanics, DynamicModel& model) {
  const double least = kSymmetry * stiffness.cwiseAbs().maxCoeff();
  const VectorXd to_ground = stiffness.rowwise().sum();
  for (Index i = 0; i < stiffness.rows(); ++i)
    if (std::abs(to_ground[i]) > least) mechanics.add_spring({0, i + 1}, model);
  for (Index i = 0; i < stiffness.rows(); ++i)
    for (Index j = i + 1; j < stiffness.rows(); ++j)
      if (std::abs(stiffness(i, j)) > least) mechanics.add_spring({i + 1, j + 1}, model);
}

// The entry of a matrix that belongs to a spring.
double between(const MatrixXd& matrix, const Spring& spring) {
  if (spring.from > 0 && spring.to > 0) return -matrix(spring.from - 1, spring.to - 1);
  return matrix.row(spring.from + spring.to - 1).sum();
}

}  // namespace

DynamicModel read_mass_spring_damper(const Config& table) {
  DynamicModel model;
  Mechanics mechanics;
  const auto masses = table.numbers("masses_kg");
  for (const double mass : masses) {
    if (!(mass > 0))
      table.fail("masses_kg", fmt::format("a mass is {}, expected more than 0", mass));
    const auto number = model.parameters.size() + 1;
    model.parameters.push_back({fmt::format("mass.{}", number), "kg", mass, "mass_error", {}});
  }
  if (masses.empty()) table.fail("masses_kg", "masses_kg is empty");
  mechanics.masses = static_cast<Index>(masses.size());
  mechanics.influence = VectorXd::Ones(mechanics.masses);
  std::vector<ModelTerm> terms;
  for (const auto& spring : table.tables("spring")) read_spring(spring, mechanics, model, terms);
  mechanics.read(table, model);
  read_common(table, model);
  model.terms.insert(model.terms.end(), terms.begin(), terms.end());
  const std::size_t inputs = model.plant_inputs.size();
  model.linear = [mechanics, inputs](const VectorXd& values) {
    return mechanics.system(assembled(mechanics, values), inputs);
  };
  return model;
}

DynamicModel read_structure(const Config& table) {
  DynamicModel model;
  Mechanics mechanics;
  const MatrixXd mass = read_symmetric(table, "mass", 0);
  if (mass.rows() == 0 || !maths::SymmetricFactors{mass}.is_positive_definite())
    table.fail("mass", "mass is not positive definite");
  mechanics.masses = mass.rows();
  const MatrixXd stiffness = read_symmetric(table, "stiffness", mass.rows());
  const MatrixParameters of_mass{mass, "mass", "kg", model};
  const MatrixParameters of_stiffness{stiffness, "stiffness", "N/m", model};
  const Damping damping = read_damping(table, mass.rows(), model);
  const auto influence =
      table.numbers("influence", std::vector<double>(static_cast<std::size_t>(mass.rows()), 1.0));
  if (static_cast<Index>(influence.size()) != mass.rows())
    table.fail("influence",
               fmt::format("influence has {} numbers, expected {}", influence.size(), mass.rows()));
  mechanics.influence = VectorXd::Map(influence.data(), mass.rows());
  std::vector<ModelTerm> terms;
  for (const auto& spring : table.tables("spring")) {
    mechanics.add_spring(mechanics.read_spring(spring), model);
    for (auto& term : read_model_terms(spring, model.connections.back().component))
      terms.push_back(std::move(term));
    spring.reject_unknown_keys();
  }
  if (mechanics.springs.empty()) find_springs(stiffness, mechanics, model);
  mechanics.read(table, model);
  read_common(table, model);
  model.terms.insert(model.terms.end(), terms.begin(), terms.end());
  const std::size_t inputs = model.plant_inputs.size();
  model.linear = [mechanics, inputs, of_mass, of_stiffness, damping](const VectorXd& values) {
    Mechanics::Matrices matrices{of_mass.at(values), {}, of_stiffness.at(values), {}, {}};
    const Index n = mechanics.masses, springs = static_cast<Index>(mechanics.springs.size());
    matrices.damping = damping.is_rayleigh
                           ? MatrixXd{values[damping.first] * matrices.mass +
                                      values[damping.first + 1] * matrices.stiffness}
                           : damping.matrix.at(values);
    if (matrices.damping.rows() == 0) matrices.damping = MatrixXd::Zero(n, n);
    matrices.spring_stiffness = matrices.spring_damping = VectorXd(springs);
    for (Index i = 0; i < springs; ++i) {
      const Spring& spring = mechanics.springs[static_cast<std::size_t>(i)];
      matrices.spring_stiffness[i] = between(matrices.stiffness, spring);
      matrices.spring_damping[i] = between(matrices.damping, spring);
    }
    return mechanics.system(matrices, inputs);
  };
  return model;
}

}  // namespace rths::diagnosis
