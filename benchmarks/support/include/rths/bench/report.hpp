// SPDX-License-Identifier: Apache-2.0
//
// The common parts of all reports.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <rths/bench/machine.hpp>
#include <rths/bench/result.hpp>
#include <rths/bench/statistics.hpp>

namespace rths::bench {

using Json = nlohmann::ordered_json;

[[nodiscard]] Json document(const Machine& machine);
[[nodiscard]] Json document(const Times& times);
[[nodiscard]] Json document(const Interval& interval);

/// A document with its format and these fields. A format is incremented when existing readers would
/// misread the document.
[[nodiscard]] std::string written(int format, const Json& fields);

/// The machine as two lines of text.
[[nodiscard]] std::string to_text(const Machine& machine);
[[nodiscard]] std::string to_text(const Interval& interval);

/// Last lines of a report: the result, and the reasons why it may be inconclusive.
[[nodiscard]] std::string conclusion(GateResult result, const std::vector<std::string>& troubles);

}  // namespace rths::bench
