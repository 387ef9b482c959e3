// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <rths/cases/case.hpp>

#include <rths/identification/relation.hpp>
#include "support/files.hpp"

namespace rths::diagnosis::test_support {

/// Columns of a recording by name.
using Columns = std::map<std::string, std::vector<double>>;

/// A random signal in a frequency band: sines with random phases.
[[nodiscard]] std::vector<double> random_signal(unsigned seed, std::size_t samples,
                                                double time_step, double low_Hz, double high_Hz,
                                                double rms);
[[nodiscard]] std::vector<double> noise(unsigned seed, std::size_t samples, double deviation);

/// Solves x' = rate(t, x): classic Runge-Kutta, 20 steps between samples. Independent of the
/// library.
/// @param after  called with the state after each step
/// @returns x by sample
[[nodiscard]] std::vector<Eigen::VectorXd> integrated(
    const std::function<Eigen::VectorXd(double, const Eigen::VectorXd&)>& rate,
    const Eigen::VectorXd& start, std::size_t samples, double time_step,
    const std::function<void(const Eigen::VectorXd&)>& after = {});

/// Linear interpolation of a signal between its samples.
[[nodiscard]] std::function<double(double)> interpolated(const std::vector<double>& samples,
                                                         double time_step);

/// A case in a temporary folder.
class CaseFolder {
 public:
  void write(const std::string& file, const Columns& columns) const;
  [[nodiscard]] Case load(const std::string& toml) const;
  [[nodiscard]] const std::filesystem::path& path() const { return folder_.path(); }

 private:
  test::TemporaryFolder folder_;
};

/// The prediction of a hypothesis on a record.
[[nodiscard]] Eigen::MatrixXd prediction(const Relation& relation, const Hypothesis& hypothesis,
                                         const Record& record);

/// Root mean square of the difference, over the root mean square of b.
[[nodiscard]] double relative_error(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace rths::diagnosis::test_support
