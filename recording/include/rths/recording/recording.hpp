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
#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

namespace rths::recording {

/// Version of the file layout below. Incremented when older readers would misread a file.
///
///     /time            int64 [rows]            nanoseconds since the run began
///     /signals/<p>     float64 [rows × words]  one per partition, SI; attributes names, units
///     /events/time, /events/signal, /events/value      changes of signals marked as events
///     /drops           int64 [nodes]           steps of each node without a row; attribute names
///     /rows_missing    int64                   rows that were due but have no values; older files
///                                              lack it
///     /map             text                    canonical map; attributes name, version, hash
///     /config/<file>   text                    input files of the run
///     /meta            attributes              data that differ between identical runs
///     /meta/added      texts, series           the same, added to the finished recording
inline constexpr int kRecordingFormat = 1;

/// Named texts; the order matters.
using NamedTexts = std::vector<std::pair<std::string, std::string>>;

/// Name of the text of /config with the changes of the command line, one key=value per line.
inline constexpr const char* kOverridesText = "overrides";
/// Name of the text of /config with the assumed model of specimen and machine: the [model] of a
/// case of the diagnosis, as TOML.
inline constexpr const char* kModelText = "model";
/// Name of the text of /config with the assumed model of the specimen alone: a bearing's file.
inline constexpr const char* kSpecimenText = "specimen";

/// Name of the text of /config with nodes, modes and bearings of a large structure, as JSON.
inline constexpr const char* kStructureText = "structure";

struct RecordingInfo {
  NamedTexts config;                            ///< file name, content
  NamedTexts meta;                              ///< time, host, versions
  std::map<std::string, double> steps_per_row;  ///< of each node that /drops counts
};

/// Writes the recording of a run: readable while it grows; complete up to the last batch after a
/// crash.
///
/// HDF5 in single-writer mode, uncompressed, flushed to the file system after each batch. Not for
/// the real-time thread: an append can take milliseconds.   One thread.
class Writer {
 public:
  /// The file has its name as soon as it can be read.
  /// @param signals  signals of a row, in this order
  /// @throws Error if the file cannot be created   @setup
  Writer(const std::filesystem::path& file, const memmap::Map& map,
         const std::vector<SignalId>& signals, const RecordingInfo& info);
  /// Closes the file and ignores write errors. Call `close` to get them.
  ~Writer();
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;

  /// @param row  one value per signal [SI]
  /// @throws Error if the file system refuses, or the file was removed or replaced by another
  void append(Duration time, std::span<const double> row);
  /// Sets the number of rows that were due but have no values. Written with the next batch.
  void set_rows_missing(std::uint64_t count);
  /// Writes the buffered rows and closes the file. @throws Error as `append`
  void close();
  [[nodiscard]] std::uint64_t rows() const;

 private:
  void flush();
  struct File;
  std::unique_ptr<File> file_;
};

/// Reads the recording of a finished, running or crashed run.   @setup
class Reader {
 public:
  /// @throws Error if the file is not a recording, or has another format version
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
  /// All values of a signal [SI]. @throws Error with the most similar known name
  [[nodiscard]] std::vector<double> signal(const std::string& name) const;
  [[nodiscard]] std::string unit(const std::string& name) const;
  /// Text of /config/<file>; empty if absent.
  [[nodiscard]] std::string config(const std::string& file) const;
  [[nodiscard]] std::map<std::string, std::string> meta() const;
  /// A series of /meta: interval and values; empty if absent.
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
  /// Nodes and numbers of their steps without a row.
  [[nodiscard]] std::vector<std::pair<std::string, std::int64_t>> drops() const;
  /// Rows that were due but have no values: the recorder did not run at their time.
  [[nodiscard]] std::int64_t rows_missing() const;

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// Whether two recordings have the same signals with the same values, to the last bit: one is a
/// copy of the other, or both are of the same run in virtual time.
[[nodiscard]] bool hold_same_signals(const Reader& a, const Reader& b);

/// Values of a signal at each count of a counter: value n−1 belongs to count n. Values of missing
/// counts are interpolated linearly.
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
  /// Steps that the node had skipped, in each row; none in an older recording.
  [[nodiscard]] std::vector<double> skipped() const;
  /// Mean time from one scheduled step to the next; those that the node skipped count [s].
  [[nodiscard]] double interval() const;
  /// @throws Error if the recording lacks the signal
  [[nodiscard]] std::vector<double> values(const std::string& signal) const;

 private:
  const Reader& run_;
  std::string node_;  ///< begin of its monitors' names
  std::vector<double> counter_;
  std::size_t count_ = 0;
};

/// Removes the file of a recording whose writer died while it created the file.
void remove_unfinished(const std::filesystem::path& file);
/// The result of `read`; its errors name the file.
template <class Read>
auto of_file(const std::filesystem::path& file, Read read) {
  try {
    return read();
  } catch (const Error& error) {
    const std::string text = error.what();
    if (text.find(file.string()) != std::string::npos) throw;
    throw Error{file.string() + ": " + text};
  }
}
/// Whether a process has the recording open to write it.
[[nodiscard]] bool is_being_written(const std::filesystem::path& file);
/// True if the file begins as an HDF5 file does.
[[nodiscard]] bool is_hdf5(const std::filesystem::path& file);
/// Adds texts, once, and series of equally spaced values to /meta of a recording that is finished
/// or whose writer was killed: all or none. They are added to a copy, which then replaces the file,
/// so programs that have the recording open or locked keep theirs. If there is no space for a copy,
/// they are added in place.   @throws Error   @setup
void add_meta(const std::filesystem::path& file, const NamedTexts& texts,
              const std::vector<std::pair<std::string, Reader::Series>>& series = {});
/// Ending of the name of the temporary copy of a recording.
inline constexpr const char* kCopying = ".copying";
/// Compresses a closed recording without loss: writes a copy beside it, then renames the copy. The
/// copy needs no newer HDF5 than version 1.8.
/// @throws Error if that fails, for example on a full disk; the file is then unchanged   @setup
void compress(const std::filesystem::path& file);
/// Clears the "open for writing" mark of a crashed writer, so that every HDF5 program opens the
/// file. Does not change a file that has a writer, or one truncated by a full disk; `Reader` reads
/// both.
/// @returns true if it cleared the mark   @throws Error if the repair fails
bool repair(const std::filesystem::path& file);

}  // namespace rths::recording
