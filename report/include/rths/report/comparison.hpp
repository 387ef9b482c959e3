// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace rths::report {

/// How far a signal may be from the baseline. A value is within the tolerance if the baseline has a
/// value within max(absolute, relative |baseline|) of it, at most `time` earlier or later.
struct Tolerance {
  double absolute = 0;  ///< [SI unit of the signal]
  double relative = 0;  ///< [-]
  double time = 0;      ///< [s]
};

struct ComparisonSettings {
  std::vector<std::string> patterns;                       ///< of names; empty: all
  std::vector<std::pair<std::string, std::string>> pairs;  ///< names in baseline and other
  std::optional<Tolerance> tolerance;                      ///< none: nothing is judged
  std::string aligned;  ///< signal whose delay is removed from all; empty: none
  double search = 0.2;  ///< largest delay that is looked for [s]
  double from = -std::numeric_limits<double>::infinity();  ///< times of the baseline [s]
  double to = std::numeric_limits<double>::infinity();
};

/// The simplest change of the baseline that leaves little of the difference.
enum class Resemblance {
  None,
  Unit,    ///< factor between two units
  Sign,    ///< negative
  Scale,   ///< factor
  Offset,  ///< constant added
  Delay,   ///< shift in time
  Other    ///< no relation: another motion, or another quantity
};
[[nodiscard]] const char* name_of(Resemblance resemblance);

/// A signal beside that of the baseline, on the times of the baseline that both have. SI.
struct ComparedSignal {
  std::string name, other_name, unit;
  std::size_t samples = 0;  ///< compared rows
  bool is_equal = false;    ///< to the last bit, at all times that both have
  /// Rows with a number in one of both alone. Rows without a number in either are left out.
  std::size_t unmatched = 0;
  double peak = 0, other_peak = 0;
  double rms = 0;               ///< of the difference
  double relative_rms = 0;      ///< of the rms of the baseline, about its mean [-]
  double largest = 0;           ///< difference
  double largest_at = 0;        ///< its time [s]
  std::optional<double> delay;  ///< of the other behind the baseline [s]
  double gain = 1;              ///< of the other on the baseline, at this delay [-]
  Resemblance resemblance = Resemblance::None;
  std::string explanation;  ///< of the resemblance, with its size; empty: none
  /// Where the tolerance is first broken [s]; none: nowhere, or not judged.
  std::optional<double> broken_at;
  std::size_t broken_samples = 0;
};

/// A key of the experiment, or a file, that differs. Empty: absent.
struct ComparedSetting {
  std::string key, baseline, other;
};

struct ComparedRuns {
  std::filesystem::path baseline, other;
  std::vector<ComparedSetting> settings;
  std::vector<ComparedSignal> signals;  ///< outside their tolerance, then the most different
  std::vector<std::string> only_baseline, only_other;
  double from = 0, to = 0;                                ///< compared times [s]
  std::array<double, 2> baseline_times{}, other_times{};  ///< first and last of each [s]
  double shift = 0;  ///< removed from all times of the other [s]
  bool is_judged = false;

  [[nodiscard]] std::size_t equal() const;   ///< signals
  [[nodiscard]] std::size_t broken() const;  ///< signals
};

/// Compares the signals of two recordings, or of a recording and a table, by their names; two
/// recordings of different maps by their roles.
/// @param baseline, other  run.h5, or any file of a table with a column of time
/// @throws Error if a file cannot be read, if there is no common signal, if two units are of
///         different quantities, or if the times do not overlap   @setup
[[nodiscard]] ComparedRuns compare(const std::filesystem::path& baseline,
                                   const std::filesystem::path& other,
                                   const ComparisonSettings& settings);

/// Values of a signal and of its baseline at the same times. SI.
struct PairedValues {
  std::vector<double> time, baseline, other;
};

/// The values of signals of a comparison, as it was made. Reads the files anew.
/// @param names  of signals in the baseline   @throws Error as compare   @setup
[[nodiscard]] std::vector<PairedValues> values_of(const ComparedRuns& comparison,
                                                  const std::vector<std::string>& names);

/// As lines for a terminal.
/// @param most  signals to list
[[nodiscard]] std::string text_of(const ComparedRuns& comparison, std::size_t most);
/// As one JSON document, without the samples.
/// @param why  object of JSON that explains the difference; empty: none
[[nodiscard]] std::string json_of(const ComparedRuns& comparison, const std::string& why = "");

/// As one page that needs no network: settings, figures, and curves with their difference.
/// @param most  signals with curves
/// @param why  as for json_of   @throws Error as compare   @setup
[[nodiscard]] std::string comparison_page(const ComparedRuns& comparison, std::size_t most,
                                          const std::string& why = "");

}  // namespace rths::report
