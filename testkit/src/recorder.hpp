// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <rths/broker/watch.hpp>
#include <rths/recording/recording.hpp>
#include <rths/testkit/signals.hpp>

namespace rths::testkit {

/// The first store that was not made by the word's owner, among those that a watch finds. One
/// thread looks, others read.
class ForeignLog {
 public:
  /// @param map  kept by reference   @param begun  time 0 of the text
  ForeignLog(const memmap::Map& map, TimePoint begun) : map_{map}, begun_{begun} {}

  /// Compares all words once.
  void look(broker::Watch& watch);
  /// As one line; empty: none was found.
  [[nodiscard]] std::string first() const;
  /// Whether a store is still to be judged.
  [[nodiscard]] bool has_suspicion() const { return has_suspicion_.load(); }

 private:
  const memmap::Map& map_;
  TimePoint begun_;
  mutable std::mutex mutex_;  ///< of the next one
  std::string first_;
  std::atomic<bool> has_suspicion_{false};
};

/// A change of a word, by its signal.
struct WordChange {
  Duration time;         ///< since the begin
  std::uint32_t signal;  ///< in the order of the map
  std::uint32_t word;
};

/// Writes changes as the rows of a recording. Changes of different signals within `row` share one,
/// with the time of the last.
class RowWriter {
 public:
  /// @param first  values at the begin [SI]   @throws Error if the file cannot be written
  RowWriter(const std::filesystem::path& file, const std::shared_ptr<SignalRing>& ring,
            std::vector<double> first, Duration row);
  void add(const std::vector<WordChange>& changes);
  /// @param missing  writes that were lost   @throws Error if the file cannot be written
  void close(std::uint64_t missing);
  [[nodiscard]] std::uint64_t rows() const { return rows_; }

 private:
  void flush();
  void append(Duration time);

  std::filesystem::path file_;
  std::shared_ptr<SignalRing> ring_;
  recording::Writer writer_;
  std::uint64_t rows_ = 0;
  std::vector<double> row_;
  Duration span_;
  std::vector<bool> has_changed_;
  Duration begin_{0}, last_{0}, written_{0};  ///< of the changes in this row; of the row before
};

/// Takes every change of a ring, in a thread of its own, and journals the stores of programs for
/// the cards, so that others can follow them. Finds stores into words of others.
class WriteRecorder {
 public:
  explicit WriteRecorder(const std::string& ring);
  ~WriteRecorder() { end(); }
  WriteRecorder(const WriteRecorder&) = delete;
  WriteRecorder& operator=(const WriteRecorder&) = delete;

  /// Stores that were not made by the word's owner.
  [[nodiscard]] const ForeignLog& foreign_log() const { return foreign_log_; }
  [[nodiscard]] const std::shared_ptr<SignalRing>& ring() const { return ring_; }
  /// Values at the begin [SI].
  [[nodiscard]] const std::vector<double>& first() const { return first_; }
  /// The changes since the last call, which are forgotten.
  [[nodiscard]] std::vector<WordChange> taken();
  /// Writes that were lost, or for which there was no room.
  [[nodiscard]] std::uint64_t missing() const { return missing_.load(); }
  /// Ends the thread. Twice has no effect.
  void end();
  /// Writes all signals [SI] to a recording. @throws Error if the file cannot be written
  void write(const std::filesystem::path& file);

 private:
  void record();
  void take(const broker::Write& write);

  std::shared_ptr<SignalRing> ring_;
  broker::Node observer_;
  broker::Waiter waiter_;
  std::vector<std::uint32_t> signals_;  ///< by offset; kNone: no signal begins there
  std::vector<double> first_;
  std::mutex mutex_;  ///< of the next one
  std::vector<WordChange> changes_;
  std::atomic<std::uint64_t> missing_{0};
  TimePoint begun_;
  ForeignLog foreign_log_;
  std::optional<broker::Watch> watch_;  ///< from the begin: no later store is taken for the first
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace rths::testkit
