// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <rths/core/clock.hpp>
#include <rths/memmap/map.hpp>

namespace rths::recording {

/// Version of the file layout below. Bumped when a reader of the version before would misread it.
///
///     /time            int64 [rows]            nanoseconds since the run began
///     /signals/<p>     float64 [rows × words]  one per partition, SI; attributes names, units
///     /events/time, /events/signal, /events/value      changes of signals marked as events
///     /drops           int64 [nodes]           steps of each node that no row has; attribute names
///     /map             text                    canonical map; attributes name, version, hash
///     /config/<file>   text                    what the run was started from
///     /meta            attributes              whatever differs between identical runs
inline constexpr int kRecordingFormat = 1;

/// Named texts, in an order that means something.
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// Text of /config that holds what the command line changed, one key=value a line.
inline constexpr const char* kOverridesText = "overrides";
/// Text of /config that holds what the simulation takes specimen and machine for: [model] of a
/// case of the diagnosis, as TOML.
inline constexpr const char* kModelText = "model";

struct RecordingInfo {
  NamedTexts config;                            ///< file name, content
  NamedTexts meta;                              ///< time, host, versions
  std::map<std::string, double> steps_per_row;  ///< of the nodes whose steps rows should all have
};

/// Writes the file of a run: readable while it grows, whole up to the last batch after a crash.
///
/// HDF5 in single-writer mode, uncompressed, flushed to the file system with every batch. Not for
/// the real-time thread: an append may take milliseconds.   One thread.
class Writer {
 public:
  /// @param signals  what a row holds, in its order
  /// @throws Error if the file cannot be created   @setup
  Writer(const std::filesystem::path& file, const memmap::Map& map,
         const std::vector<SignalId>& signals, const RecordingInfo& info);
  /// Closes; what cannot be written then is lost silently. Call `close` to hear of it.
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  /// @param row  as many values as signals [SI]   @throws Error if the file system refuses
  void append(Duration time, std::span<const double> row);
  /// Writes what is buffered and ends the file. @throws Error if the file system refuses
  void close();
  [[nodiscard]] std::uint64_t rows() const;

 private:
  void flush();
  struct File;
  std::unique_ptr<File> file_;
};

/// Reads the file of a run, finished, growing, or left behind by a crash.   @setup
class Reader {
 public:
  /// @throws Error if it is no recording, or of a later format
  explicit Reader(const std::filesystem::path& file);
  ~Reader();
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;

  [[nodiscard]] const memmap::Map& map() const;
  [[nodiscard]] std::size_t rows() const;
  /// Time of each row since the run began [s].
  [[nodiscard]] const std::vector<double>& time() const;
  /// Full names, in order of offset.
  [[nodiscard]] std::vector<std::string> names() const;
  [[nodiscard]] bool has(const std::string& signal) const;
  /// All values of a signal [SI]. @throws Error that names the nearest known signal
  [[nodiscard]] std::vector<double> signal(const std::string& name) const;
  [[nodiscard]] std::string unit(const std::string& name) const;
  /// Text of /config/<file>, empty if there is none.
  [[nodiscard]] std::string config(const std::string& file) const;
  [[nodiscard]] std::map<std::string, std::string> meta() const;
  /// A series of /meta: interval and values; empty if there is none.
  struct Series {
    double interval = 0;
    std::vector<double> values;
  };
  [[nodiscard]] Series meta_series(const std::string& name) const;
  struct Event {
    double time;  ///< [s]
    std::string signal;
    double value;
  };
  [[nodiscard]] std::vector<Event> events() const;
  /// Node and number of its steps that no row has.
  [[nodiscard]] std::vector<std::pair<std::string, std::int64_t>> drops() const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Values of a signal at each count of a counter: value n−1 belongs to count n. Counts that no row
/// has are filled in between their neighbours.
[[nodiscard]] std::vector<double> at_each_count(const std::vector<double>& counter,
                                                const std::vector<double>& signal);

/// One value per tick of a node, up to the end of the test. The reader must outlive it.   @setup
class NodeTicks {
 public:
  /// @param node  "srmd", "xpc"   @throws Error if the recording lacks the node's counter
  NodeTicks(const Reader& run, const std::string& node);
  [[nodiscard]] std::size_t count() const { return count_; }
  /// The node's counter in each row.
  [[nodiscard]] const std::vector<double>& counter() const { return counter_; }
  /// @throws Error if the recording lacks the signal
  [[nodiscard]] std::vector<double> values(const std::string& signal) const;

 private:
  const Reader& run_;
  std::vector<double> counter_;
  std::size_t count_ = 0;
};

/// True if the file begins as an HDF5 file does.
[[nodiscard]] bool is_hdf5(const std::filesystem::path& file);
/// Adds attributes to /meta of a finished recording. @throws Error
void add_meta(const std::filesystem::path& file, const NamedTexts& meta);
/// Adds a series of equally spaced values to /meta of a finished recording. @throws Error
void add_meta_series(const std::filesystem::path& file, const std::string& name, double interval,
                     const std::vector<double>& values);
/// Takes the mark off that a crashed writer leaves, so that every HDF5 program opens the file.
/// Leaves a file alone that is being written, and one that a full disk has cut short: `Reader`
/// reads what is there.
/// @returns true if there was one, and it is gone   @throws Error if the file cannot be mended
bool repair(const std::filesystem::path& file);

}  // namespace rths::recording
