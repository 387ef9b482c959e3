// SPDX-License-Identifier: Apache-2.0
#include "check_records.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/identification/scores.hpp>

namespace rths::diagnosis {
namespace {

// A record that scores itself has 32 pieces. Fewer rows than that leave resampling less than three
// blocks of eight rows, and the test of whiteness hardly more than its 20 lags.
constexpr Index kFewestRows = 32;
// Fourth powers of these sizes, and squares of their ratios, are normal numbers.
constexpr double kSmallest = 1e-50, kLargest = 1e50;  // [SI]
constexpr double kRoundOff = 1e-12;                   // of filters, relative

void check_length(const Record& record) {
  const auto rows = static_cast<Index>(record.samples());
  if (rows < kFewestRows)
    throw Error{fmt::format("{}: the record has {} samples, expected at least {}", record.name,
                            rows, kFewestRows)};
}

void check_sizes(const Channel& channel, const Record& record) {
  double largest = 0;
  for (std::size_t i = 0; i < channel.values.size(); ++i) {
    const double value = channel.values[i];
    if (!(std::abs(value) <= kLargest))
      throw Error{fmt::format("{}: {} is {:g} {} in sample {}, at {:.13g} s, expected {:g} to {:g}",
                              record.name, channel.role, value, channel.unit, i + 1,
                              record.start + static_cast<double>(i) * record.time_step, -kLargest,
                              kLargest)};
    largest = std::max(largest, std::abs(value));
  }
  if (largest > 0 && largest < kSmallest)
    throw Error{fmt::format("{}: the largest value of {} is {:g} {}, expected 0 or at least {:g}",
                            record.name, channel.role, largest, channel.unit, kSmallest)};
}

// A bearing carries its load in the mean; a platen may have no specimen.
void check_compression(const Record& record) {
  if (const std::string text = tension_in(record); !text.empty())
    throw Error{fmt::format("{}: {}", record.name, text)};
}

double largest_of(const Record& record, const std::string& role) {
  const Channel* channel = record.find(role);
  return channel == nullptr ? 0 : values_of(*channel).cwiseAbs().maxCoeff();
}

void check_rows(const Drive& drive, const Record& record, const Relation& relation) {
  const Index rows = drive.rows() - drive.first_row;
  if (rows < kFewestRows)
    throw Error{
        fmt::format("{}: {} compares {} rows of {:g} s, expected at least {}: use a longer "
                    "record, or a shorter settle_s",
                    record.name, relation.name(), rows, drive.time_step, kFewestRows)};
}

bool is_constant(const VectorXd& values) {
  return values.maxCoeff() - values.minCoeff() <= kRoundOff * values.cwiseAbs().maxCoeff();
}

// One axis may be at rest. A free run has a state of its own at its start, and then needs no input.
void check_drivers(const Record& record, const Relation& relation) {
  const auto drivers = relation.drivers();
  if (relation.runs_freely() || drivers.empty()) return;
  for (const auto& role : drivers)
    if (const Channel* driver = record.find(role); driver && !is_constant(values_of(*driver)))
      return;
  throw Error{fmt::format("{}: {} {} constant, expected a channel that varies: it drives the model",
                          record.name, fmt::join(drivers, " and "),
                          drivers.size() == 1 ? "is" : "are")};
}

// Errors are divided by the standard deviation of the outputs.
void check_variation(const Drive& drive, const Record& record, const Relation& relation) {
  std::vector<std::string> constant;
  const auto& outputs = relation.outputs();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto rows =
        drive.measured.col(static_cast<Index>(i)).tail(drive.rows() - drive.first_row);
    if (rows.maxCoeff() - rows.minCoeff() <= kRoundOff * largest_of(record, outputs[i].first))
      constant.push_back(outputs[i].first);
  }
  if (constant.empty() || (have_one_unit(relation) && constant.size() < outputs.size())) return;
  throw Error{fmt::format(
      "{}: {} {} constant, expected a channel that varies: its standard deviation scales the error",
      record.name, fmt::join(constant, " and "), constant.size() == 1 ? "is" : "are")};
}

}  // namespace

std::string tension_in(const Record& record) {
  const Channel* load = record.find("vertical_force");
  if (load == nullptr || load->values.empty()) return "";
  const VectorXd values = values_of(*load);
  const double mean = values.mean();
  // Noise about zero is no tension.
  if (!(mean < 0) || values.maxCoeff() > -mean) return "";
  return fmt::format(
      "vertical_force is negative in the mean ({:.3g} N), expected compression as positive "
      "(\"-column [unit]\" in [channels] reverses the sign)",
      mean);
}

void check_records(const Case& c) {
  for (const auto& record : c.records) {
    if (record.use != Use::Reference) check_length(record);
    for (const auto& channel : record.channels) check_sizes(channel, record);
    if (record.use != Use::Reference && c.model.kind == ModelKind::Bearing)
      check_compression(record);
  }
}

void check_outputs(const Relation& relation, const std::vector<const Record*>& records) {
  double fitted = 0;
  for (const Record* record : records) {
    const auto drive = relation.prepare(*record);
    check_drivers(*record, relation);
    check_rows(*drive, *record, relation);
    check_variation(*drive, *record, relation);
    if (record->use == Use::Fit)
      fitted += static_cast<double>((drive->rows() - drive->first_row) * drive->measured.cols());
  }
  // Each half of the fitted values determines all parameters.
  const auto needed = 2 * relation.base().free.size();
  if (fitted < static_cast<double>(needed))
    throw Error{fmt::format("{}: the fitted records have {} values for {} parameters, expected {}",
                            relation.name(), fitted, relation.base().free.size(), needed)};
}

}  // namespace rths::diagnosis
