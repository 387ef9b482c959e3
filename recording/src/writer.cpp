// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <rths/memmap/units.hpp>
#include <rths/recording/recording.hpp>

#include "hdf5.hpp"
#include "writer_lock.hpp"

namespace rths::recording {
namespace {

constexpr hsize_t kRowsPerBatch = 100;  // 0.1 s at 1 kHz: the largest loss after a crash
constexpr hsize_t kRowsPerChunk = 1024;
constexpr double kRounding = 1e-6;  // of steps per row
constexpr const char* kStepSuffix = ".host.step";

// A table that grows by rows.
struct DatasetTable {
  Handle dataset;
  hid_t type = -1;
  hsize_t columns = 0;  ///< 0: one-dimensional

  void append(hsize_t written, hsize_t rows, const void* values) const {
    const hsize_t extent[2] = {written + rows, columns};
    check(H5Dset_extent(dataset.id(), extent), "extending a dataset");
    const Handle file_space{H5Dget_space(dataset.id()), H5Sclose, "HDF5 space"};
    const hsize_t start[2] = {written, 0};
    const hsize_t count[2] = {rows, columns};
    check(H5Sselect_hyperslab(file_space.id(), H5S_SELECT_SET, start, nullptr, count, nullptr),
          "selecting rows");
    const Handle space{H5Screate_simple(columns > 0 ? 2 : 1, count, nullptr), H5Sclose,
                       "HDF5 space"};
    check(H5Dwrite(dataset.id(), type, space.id(), file_space.id(), H5P_DEFAULT, values),
          "writing rows (is the disk full?)");
  }
};

DatasetTable create_table(hid_t group, const std::string& name, hid_t type, hsize_t columns) {
  const int rank = columns > 0 ? 2 : 1;
  const hsize_t none[2] = {0, columns};
  const hsize_t unlimited[2] = {H5S_UNLIMITED, columns};
  const hsize_t chunk[2] = {kRowsPerChunk, columns};
  const Handle space{H5Screate_simple(rank, none, unlimited), H5Sclose, "HDF5 space"};
  const Handle properties{H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "HDF5 properties"};
  check(H5Pset_chunk(properties.id(), rank, chunk), "HDF5 chunks");
  if (type == H5T_NATIVE_DOUBLE)
    check(H5Pset_fill_value(properties.id(), type, &kNoValue), "HDF5 fill value");
  if (type == H5T_NATIVE_INT64)
    check(H5Pset_fill_value(properties.id(), type, &kNoTime), "HDF5 fill value");
  // Without times in the objects, identical runs give identical files.
  check(H5Pset_obj_track_times(properties.id(), false), "HDF5 properties");
  return {Handle{H5Dcreate2(group, name.c_str(), type, space.id(), H5P_DEFAULT, properties.id(),
                            H5P_DEFAULT),
                 H5Dclose, "creating dataset " + name},
          type, columns};
}

// A list of numbers of fixed length.
Handle create_numbers(hid_t file, const char* name, hsize_t count) {
  const Handle space{H5Screate_simple(1, &count, nullptr), H5Sclose, "HDF5 space"};
  return {
      H5Dcreate2(file, name, H5T_NATIVE_INT64, space.id(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
      H5Dclose, std::string{"creating dataset "} + name};
}

void write_numbers(const Handle& dataset, const std::int64_t* numbers, const char* action) {
  check(H5Dwrite(dataset.id(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers), action);
}

Handle create_group(hid_t file, const std::string& name) {
  return {H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
          "creating group " + name};
}

std::filesystem::path unnamed(const std::filesystem::path& path) { return path.string() + ".new"; }

/// A recording gets its name when it is complete enough to be read: a process that dies before
/// leaves no broken recording. The destructor removes a file without its name.
struct Creation {
  std::filesystem::path path;
  ~Creation() { remove_unfinished(path); }
  void finish() const {
    std::error_code error;
    std::filesystem::rename(unnamed(path), path, error);
    if (error) throw Error{path.string() + ": creating the recording failed: " + error.message()};
  }
};

// A group with space for links, so that an addition to a finished recording changes nothing else in
// place.
void create_additions(hid_t meta) {
  constexpr unsigned kMost = 4, kNameLength = 16;
  const Handle properties{H5Pcreate(H5P_GROUP_CREATE), H5Pclose, "HDF5 properties"};
  check(H5Pset_est_link_info(properties.id(), kMost, kNameLength), "HDF5 links");
  const Handle group{H5Gcreate2(meta, kAdditions, H5P_DEFAULT, properties.id(), H5P_DEFAULT),
                     H5Gclose, "creating group for additions"};
}

}  // namespace

struct Writer::File {
  /// Columns and table of a partition.
  struct Block {
    DatasetTable table;
    std::vector<std::size_t> columns;  ///< positions in a row
    std::vector<double> buffer;
  };
  struct StepCounter {
    std::size_t column;
    double per_row;  ///< most steps of the node in a row's period
    std::int64_t drops = 0;
    double last = 0;
  };

  std::filesystem::path path;
  WriterLock lock;
  Handle file;
  DatasetTable time;
  std::vector<Block> blocks;
  std::vector<std::int64_t> time_buffer;
  DatasetTable event_time, event_signal, event_value;
  std::vector<std::int64_t> event_times;
  std::vector<std::int32_t> event_signals;
  std::vector<double> event_values;
  std::vector<std::size_t> event_columns;
  std::vector<double> last_values;
  Handle drops;
  std::vector<StepCounter> counters;
  Handle rows_missing;
  std::int64_t rows_missing_count = 0;
  hsize_t rows = 0, events = 0;

  void create() {
    silence_hdf5();
    const Handle access = without_lock();
    // Single-writer mode needs the newest structures of the file format.
    check(H5Pset_libver_bounds(access.id(), H5F_LIBVER_LATEST, H5F_LIBVER_LATEST), "HDF5 version");
    file = Handle{H5Fcreate(unnamed(path).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access.id()),
                  H5Fclose, path.string() + ": creating the recording"};
    write_text_attribute(file.id(), "recording_format", std::to_string(kRecordingFormat));
  }

  void create_blocks(const memmap::Map& map, const std::vector<SignalId>& signals) {
    time = create_table(file.id(), "time", H5T_NATIVE_INT64, 0);
    write_text_attribute(time.dataset.id(), "units", "ns");
    const Handle group = create_group(file.id(), "signals");
    for (const auto& partition : map.partitions()) {
      Block block;
      std::vector<std::string> names;
      std::vector<std::string> units;
      for (std::size_t i = 0; i < signals.size(); ++i) {
        const auto& entry = map.entry(signals[i]);
        if (entry.partition->name != partition.name) continue;
        block.columns.push_back(i);
        names.push_back(entry.name);
        units.push_back(memmap::parse_unit(entry.signal->unit).si);
      }
      if (block.columns.empty()) continue;
      block.table =
          create_table(group.id(), partition.name, H5T_NATIVE_DOUBLE, block.columns.size());
      write_text_list_attribute(block.table.dataset.id(), "names", names);
      write_text_list_attribute(block.table.dataset.id(), "units", units);
      blocks.push_back(std::move(block));
    }
  }

  void create_events(const memmap::Map& map, const std::vector<SignalId>& signals) {
    const Handle group = create_group(file.id(), "events");
    event_time = create_table(group.id(), "time", H5T_NATIVE_INT64, 0);
    event_signal = create_table(group.id(), "signal", H5T_NATIVE_INT32, 0);
    event_value = create_table(group.id(), "value", H5T_NATIVE_DOUBLE, 0);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < signals.size(); ++i) {
      if (!map.entry(signals[i]).signal->event) continue;
      event_columns.push_back(i);
      names.push_back(map.entry(signals[i]).name);
    }
    last_values.assign(event_columns.size(), std::nan(""));
    write_text_list_attribute(event_signal.dataset.id(), "names", names);
  }

  // Each node counts its steps in a monitor; a skipped count is a step without a row.
  void create_drops(const memmap::Map& map, const std::vector<SignalId>& signals,
                    const std::map<std::string, double>& steps_per_row) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < signals.size(); ++i) {
      const std::string& name = map.entry(signals[i]).name;
      const std::string& node = map.entry(signals[i]).partition->node;
      const auto per_row = steps_per_row.find(node);
      if (!name.ends_with(kStepSuffix) || per_row == steps_per_row.end()) continue;
      // A node that is slower than the rows, or no multiple of them, makes whole steps.
      counters.push_back({i, std::ceil(per_row->second - kRounding)});
      names.push_back(node);
    }
    drops = create_numbers(file.id(), "drops", counters.size());
    rows_missing = create_numbers(file.id(), kRowsMissing, 1);
    write_text_list_attribute(drops.id(), "names", names);
  }

  void note_changes(Duration at, std::span<const double> row) {
    for (std::size_t i = 0; i < event_columns.size(); ++i) {
      const double value = row[event_columns[i]];
      if (!std::isnan(last_values[i]) && value != last_values[i]) {
        event_times.push_back(at.count());
        event_signals.push_back(static_cast<std::int32_t>(i));
        event_values.push_back(value);
      }
      last_values[i] = value;
    }
    // A row that comes a little late has a few more of several steps, and the next one fewer.
    for (auto& counter : counters) {
      const double count = row[counter.column];
      const double missing = std::floor((count - counter.last) / counter.per_row) - 1;  // rows
      if (counter.last > 0 && missing > 0) counter.drops += std::lround(missing * counter.per_row);
      counter.last = count;
    }
  }

  // Writes the time last, so that a row without values does not count.
  void flush() {
    silence_hdf5();  // each thread has its own setting
    if (!time_buffer.empty()) {
      for (auto& block : blocks) {
        block.table.append(rows, time_buffer.size(), block.buffer.data());
        block.buffer.clear();
      }
      time.append(rows, time_buffer.size(), time_buffer.data());
      rows += time_buffer.size();
      time_buffer.clear();
    }
    if (!event_times.empty()) {
      event_time.append(events, event_times.size(), event_times.data());
      event_signal.append(events, event_signals.size(), event_signals.data());
      event_value.append(events, event_values.size(), event_values.data());
      events += event_times.size();
      event_times.clear();
      event_signals.clear();
      event_values.clear();
    }
    std::vector<std::int64_t> counts;
    for (const auto& counter : counters) counts.push_back(counter.drops);
    if (!counts.empty()) write_numbers(drops, counts.data(), "writing drops");
    // Flushing only datasets leaves the end of the file in memory: unreadable after a crash.
    write_numbers(rows_missing, &rows_missing_count, "writing the number of missing rows");
    check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL),
          path.string() + ": flushing the recording (is the disk full?)");
    if (!lock.is_at(path))
      throw Error{path.string() + ": was removed or replaced while it was written"};
  }
};

Writer::Writer(const std::filesystem::path& path, const memmap::Map& map,
               const std::vector<SignalId>& signals, const RecordingInfo& info)
    : file_{std::make_unique<File>()} {
  const Creation creation{path};
  file_->path = path;
  file_->create();
  file_->create_blocks(map, signals);
  file_->create_events(map, signals);
  file_->create_drops(map, signals, info.steps_per_row);
  write_text_dataset(file_->file.id(), "map", map.to_toml());
  const Handle config = create_group(file_->file.id(), "config");
  for (const auto& [name, text] : info.config) write_text_dataset(config.id(), name, text);
  const Handle meta = create_group(file_->file.id(), "meta");
  for (const auto& [name, text] : info.meta) write_text_attribute(meta.id(), name, text);
  const Handle map_text{H5Dopen2(file_->file.id(), "map", H5P_DEFAULT), H5Dclose, "opening map"};
  write_text_attribute(map_text.id(), "name", map.description().name);
  write_text_attribute(map_text.id(), "version", std::to_string(map.description().version));
  write_text_attribute(map_text.id(), "hash", memmap::hash_text(map.hash()));
  create_additions(meta.id());
  check(H5Fstart_swmr_write(file_->file.id()), path.string() + ": starting single-writer mode");
  creation.finish();
  file_->lock = WriterLock{path};
}

Writer::Writer(Writer&&) noexcept = default;
Writer& Writer::operator=(Writer&&) noexcept = default;

Writer::~Writer() {
  try {
    if (file_) close();
  } catch (const Error&) {  // NOLINT(bugprone-empty-catch)
    // A destructor cannot report errors; `close` does.
  }
}

void Writer::append(Duration time, std::span<const double> row) {
  if (!file_) throw Error{"the recording is closed, or a write failed"};
  file_->time_buffer.push_back(time.count());
  for (auto& block : file_->blocks)
    for (const auto column : block.columns) block.buffer.push_back(row[column]);
  file_->note_changes(time, row);
  if (file_->time_buffer.size() >= kRowsPerBatch) flush();
}

void Writer::flush() {
  try {
    file_->flush();
  } catch (const Error&) {
    // Abandons the file as a crash would; all batches up to the last complete one are readable.
    // Closing would write again, in an order that is safe only if every write succeeds.
    static auto& abandoned = *new std::vector<std::unique_ptr<File>>;
    abandoned.push_back(std::move(file_));
    throw;
  }
}

void Writer::set_rows_missing(std::uint64_t count) {
  if (file_) file_->rows_missing_count = static_cast<std::int64_t>(count);
}

std::uint64_t Writer::rows() const { return file_ ? file_->rows + file_->time_buffer.size() : 0; }

void Writer::close() {
  if (!file_) return;
  flush();
  file_.reset();
}

void remove_unfinished(const std::filesystem::path& file) {
  std::error_code ignored;
  std::filesystem::remove(unnamed(file), ignored);
}

}  // namespace rths::recording
