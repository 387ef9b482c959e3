// SPDX-License-Identifier: Apache-2.0
#include <rths/commissioning/learnt_inverse.hpp>

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/commissioning/recorded.hpp>
#include <rths/controller/inverse_lead.hpp>
#include <rths/core/axis.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>

namespace rths::commissioning {
namespace {

using controller::kInverseCoefficients;
using Terms = controller::InverseLead::Terms;

constexpr double kMeanOfEnd = 1;  // [s]

double mean_of_end(const std::vector<double>& values, double interval) {
  const auto count = std::clamp<std::size_t>(
      static_cast<std::size_t>(std::llround(kMeanOfEnd / interval)), 1, values.size());
  double sum = 0;
  for (std::size_t i = values.size() - count; i < values.size(); ++i) sum += values[i];
  return sum / static_cast<double>(count);
}

/// Of one recording: at its start, at its middle and at its end.
struct LearntCourse {
  Terms start, middle, end;
};

std::optional<LearntCourse> course_of(const recording::Reader& run, const std::string& block,
                                      const std::string& axis) {
  const std::string begin = recording::roles_of(run).monitor_of_controller() + block + ".";
  const auto named = [&](const char* output) { return begin + output + "." + axis; };
  if (!run.has(named("a0"))) return std::nullopt;
  std::vector<std::string> names{named("learning")};
  for (const auto& coefficient : kInverseCoefficients) names.push_back(named(coefficient.output));
  const auto data = recorded(run, names);
  if (*std::max_element(data.values[0].begin(), data.values[0].end()) == 0) return std::nullopt;
  LearntCourse course;
  for (std::size_t k = 0; k < std::size(kInverseCoefficients); ++k) {
    const auto& values = data.values[k + 1];
    const auto i = static_cast<Eigen::Index>(k);
    course.start[i] = values.front();
    course.middle[i] = values[values.size() / 2];
    course.end[i] = mean_of_end(values, data.interval);
  }
  return course;
}

LearntAxis axis_of(const std::string& name, const std::vector<LearntCourse>& courses) {
  LearntAxis axis{name, courses.front().start, Terms::Zero(), Terms::Zero(), Terms::Zero()};
  for (const auto& course : courses)
    axis.learnt += course.end / static_cast<double>(courses.size());
  for (const auto& course : courses) {
    axis.deviation = axis.deviation.cwiseMax((course.end - axis.learnt).cwiseAbs());
    axis.drift = axis.drift.cwiseMax((course.end - course.middle).cwiseAbs());
  }
  return axis;
}

}  // namespace

LearntInverse learnt_inverse(const std::vector<std::filesystem::path>& files,
                             const std::string& block) {
  LearntInverse found{files, block, {}};
  std::vector<recording::Reader> runs;
  for (const auto& file : files) runs.emplace_back(file);
  for (const std::string& name : names_of(kHorizontal)) {
    std::vector<LearntCourse> courses;
    std::string without;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      const auto course =
          recording::of_file(files[i], [&] { return course_of(runs[i], block, name); });
      if (course)
        courses.push_back(*course);
      else
        without = files[i].string();
    }
    if (courses.size() == files.size() && !courses.empty())
      found.axes.push_back(axis_of(name, courses));
    else if (!courses.empty())
      throw Error{fmt::format("{}: {}: block '{}' did not learn, expected it in all recordings",
                              without, name, block)};
  }
  if (found.axes.empty())
    throw Error{fmt::format(
        "no recording has a block '{}' that learnt, expected an adaptive_inverse of the controller",
        block)};
  return found;
}

std::string text_of(const LearntInverse& inverse) {
  std::string text;
  for (const auto& axis : inverse.axes) {
    text += fmt::format("{:<22}{:>12}{:>12}{:>12}{:>12}\n", axis.name, "initial", "learnt",
                        "deviation", "drift");
    for (std::size_t k = 0; k < std::size(kInverseCoefficients); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      text +=
          fmt::format("  {:<20}{:>12.4g}{:>12.4g}{:>12.2g}{:>12.2g}\n", kInverseCoefficients[k].key,
                      axis.initial[i], axis.learnt[i], axis.deviation[i], axis.drift[i]);
    }
  }
  return text;
}

std::string json_of(const LearntInverse& inverse) {
  nlohmann::ordered_json document{{"block", inverse.block}, {"axes", {}}};
  for (const auto& axis : inverse.axes)
    for (std::size_t k = 0; k < std::size(kInverseCoefficients); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      document["axes"][axis.name][kInverseCoefficients[k].key] = {{"initial", axis.initial[i]},
                                                                  {"learnt", axis.learnt[i]},
                                                                  {"deviation", axis.deviation[i]},
                                                                  {"drift", axis.drift[i]}};
    }
  return document.dump(2) + "\n";
}

// A list of the block begins with long, so a run along lat alone states both axes. A run along long
// alone states one value, which a test along both axes refuses.
std::string toml_of(const LearntInverse& inverse) {
  std::string text =
      "# Initial coefficients of the adaptive inverse, learnt in recorded runs:\n#   rths identify "
      "inverse";
  for (const auto& file : inverse.files) text += " " + file.string();
  const bool has_lat = inverse.axes.back().name == name_of(Axis::Lat);
  if (inverse.axes.front().name == name_of(Axis::Lat))
    text += "\n# long: did not learn; has the values of lat";
  text += fmt::format("\n[{}]\n", inverse.block);
  for (std::size_t k = 0; k < std::size(kInverseCoefficients); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double first = inverse.axes.front().learnt[i], last = inverse.axes.back().learnt[i];
    const char* key = kInverseCoefficients[k].key;
    text += has_lat ? fmt::format("{} = [{:.6g}, {:.6g}]\n", key, first, last)
                    : fmt::format("{} = [{:.6g}]\n", key, first);
  }
  return text;
}

}  // namespace rths::commissioning
