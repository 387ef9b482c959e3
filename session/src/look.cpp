// SPDX-License-Identifier: Apache-2.0
#include "look.hpp"

#include <algorithm>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/core/interrupted.hpp>
#include <rths/core/text.hpp>
#include <rths/recording/recording.hpp>
#include <rths/recording/roles.hpp>

namespace rths::session {
namespace {

using recording::Reader;

// Wall time. A record that scores itself is cut into pieces, and blocks of a second are resampled.
constexpr double kLeastMotion = 8;  // [s]

/// Data of a test so far.
struct Progressed {
  double time = 0;    ///< model time [s]
  double motion = 0;  ///< wall time since the first target [s]; 0: none has come
};

Progressed progress_of(const Reader& run, double rate) {
  const auto roles = recording::roles_of(run);
  const auto& rows = run.time();
  const auto target = run.signal(roles.new_target);
  const auto is_one = [](double word) { return word > 0; };
  const auto first =
      static_cast<std::size_t>(std::find_if(target.begin(), target.end(), is_one) - target.begin());
  if (first >= rows.size()) return {};
  const double motion = rows.back() - rows[first];
  const auto time = run.has(roles.time) ? run.signal(roles.time) : std::vector<double>{};
  const double reached = time.empty() ? 0 : *std::max_element(time.begin(), time.end());
  return {reached > 0 ? reached : motion / rate, motion};
}

std::string missing_for_a_verdict(const Progressed& so_far) {
  if (so_far.motion <= 0)
    return "no target has come yet, so that nothing has moved; a verdict needs "
           "motion";
  return fmt::format("{:.1f} s of motion are recorded, expected at least {:g} s", so_far.motion,
                     kLeastMotion);
}

// The answers stand together, since those of the next look follow.
std::string text_of(const diagnosis::Verdict& verdict) {
  std::string text = report::answers_text(verdict);
  replace_all(text, "\n\n", "\n");
  return text;
}

}  // namespace

LiveTest live_test_of(const std::filesystem::path& recording) {
  return recording::of_file(recording, [&] {
    const Reader run{recording};
    if (run.config(recording::kModelText).empty())
      throw Error{"found no model of the simulation, expected a test that has one"};
    const auto roles = recording::roles_of(run);
    const auto moves = [&](const recording::AxisRoles& axis) {
      return run.has(axis.command) && run.has(axis.machine_displacement);
    };
    if (std::none_of(roles.axes.begin(), roles.axes.end(), moves) || !run.has(roles.new_target))
      throw Error{
          fmt::format("the map '{}' has no command and displacement of an axis, expected "
                      "those of the test's [roles], such as '{}' and '{}'",
                      run.map().description().name, roles.axes.at(0).command,
                      roles.axes.at(0).machine_displacement)};
    LiveTest test;
    test.recording = recording;
    if (const auto experiment = recording::recorded_experiment(run)) {
      test.rate = experiment->number("rate", 1);
      test.duration = experiment->number("duration_s", 0);
    }
    return test;
  });
}

std::string Look::to_text() const {
  return fmt::format("{} {} {}", static_cast<int>(kind), time, text);
}

Look Look::from_text(const std::string& text) {
  const auto first = text.find(' ');
  const auto second = first == std::string::npos ? first : text.find(' ', first + 1);
  if (second == std::string::npos)
    return {Kind::Failed, 0, "its process has ended without a result"};
  const auto number = [&](std::size_t from, std::size_t to) {
    return number_of(text.substr(from, to - from)).value_or(0);
  };
  const auto kind = static_cast<Kind>(static_cast<int>(number(0, first)));
  return {kind, number(first + 1, second), text.substr(second + 1)};
}

Look look_at(const LiveTest& test, const std::filesystem::path& folder, const DiagnoseSettings& how,
             TestState state, std::optional<double> last) {
  Look look;
  look.time = last.value_or(0);
  try {
    const auto so_far = progress_of(Reader{test.recording}, test.rate);
    look.time = so_far.time;
    if (so_far.motion < kLeastMotion)
      return {Look::Kind::TooEarly, so_far.time, missing_for_a_verdict(so_far)};
    if (state == TestState::Running && last && so_far.time <= *last)
      return {Look::Kind::Paused, so_far.time, "no new data since the last look"};
    DiagnoseSettings settings = how;
    settings.source = test.recording;
    const auto found = diagnose_into(folder, case_of(settings), settings, state, {});
    return {Look::Kind::Verdict, so_far.time, text_of(found.verdict)};
  } catch (const Error& error) {
    look.text = error.what();
  } catch (const std::filesystem::filesystem_error& error) {
    look.text = error.what();
  }
  return look;
}

}  // namespace rths::session
