// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <fstream>
#include <optional>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/text.hpp>
#include <rths/recording/recording.hpp>

#include "hdf5.hpp"
#include "probe.hpp"
#include "replaced_file.hpp"
#include "writer_lock.hpp"

namespace rths::recording {
namespace {

template <class T>
struct NativeType;
template <>
struct NativeType<double> {
  static hid_t id() { return H5T_NATIVE_DOUBLE; }
};
template <>
struct NativeType<std::int64_t> {
  static hid_t id() { return H5T_NATIVE_INT64; }
};
template <>
struct NativeType<std::int32_t> {
  static hid_t id() { return H5T_NATIVE_INT32; }
};

Handle open_dataset(hid_t group, const std::string& name) {
  return {H5Dopen2(group, name.c_str(), H5P_DEFAULT), H5Dclose, "opening dataset " + name};
}

Handle open_group(hid_t file, const std::string& name) {
  return {H5Gopen2(file, name.c_str(), H5P_DEFAULT), H5Gclose, "opening group " + name};
}

std::string path_in_file(const Handle& dataset) {
  std::array<char, 256> path{};
  H5Iget_name(dataset.id(), path.data(), path.size());
  return path.data();
}

template <class T>
std::vector<T> read_all(const Handle& dataset) {
  const Handle space{H5Dget_space(dataset.id()), H5Sclose, "HDF5 space"};
  std::vector<T> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space.id())));
  if (!values.empty())
    check(H5Dread(dataset.id(), NativeType<T>::id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
          "reading dataset " + path_in_file(dataset));
  return values;
}

// Only readers in SWMR mode open a file with the mark of a crashed writer.
Handle open_file(const std::filesystem::path& path) {
  silence_hdf5();
  hid_t file = open_to_read(path, H5F_ACC_RDONLY);
  if (file < 0) file = open_to_read(path, H5F_ACC_RDONLY | H5F_ACC_SWMR_READ);
  return {file, H5Fclose, path.string() + ": is damaged or no recording (HDF5): opening it"};
}

herr_t append_link_name(hid_t, const char* name, const H5L_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

std::vector<std::string> names_in(const Handle& group) {
  std::vector<std::string> names;
  check(H5Literate(group.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_link_name, &names),
        "listing a group");
  return names;
}

herr_t append_attribute_name(hid_t, const char* name, const H5A_info_t*, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

void read_texts(const Handle& group, std::map<std::string, std::string>& texts) {
  std::vector<std::string> names;
  check(H5Aiterate2(group.id(), H5_INDEX_NAME, H5_ITER_NATIVE, nullptr, append_attribute_name,
                    &names),
        "listing /meta");
  for (const auto& name : names) texts[name] = read_text_attribute(group.id(), name);
}

// Older recordings have the additions in /meta itself.
Handle open_additions(const Handle& file) {
  Handle meta = open_group(file.id(), "meta");
  if (H5Lexists(meta.id(), kAdditions, H5P_DEFAULT) <= 0) return meta;
  return open_group(meta.id(), kAdditions);
}

}  // namespace

// Whether each column is compressed by itself, so that it can be read without the others.
bool is_column_by_column(const Handle& table) {
  const Handle properties{H5Dget_create_plist(table.id()), H5Pclose, "HDF5 properties"};
  hsize_t chunk[2] = {0, 0};
  return H5Pget_layout(properties.id()) == H5D_CHUNKED &&
         H5Pget_chunk(properties.id(), 2, chunk) == 2 && chunk[1] == 1;
}

std::vector<double> read_column(const Handle& table, std::size_t index) {
  const Handle space{H5Dget_space(table.id()), H5Sclose, "HDF5 space"};
  hsize_t size[2] = {0, 0};
  H5Sget_simple_extent_dims(space.id(), size, nullptr);
  const hsize_t start[2] = {0, index}, count[2] = {size[0], 1};
  check(H5Sselect_hyperslab(space.id(), H5S_SELECT_SET, start, nullptr, count, nullptr),
        "selecting a column");
  const Handle rows{H5Screate_simple(1, size, nullptr), H5Sclose, "HDF5 space"};
  std::vector<double> values(size[0]);
  check(H5Dread(table.id(), H5T_NATIVE_DOUBLE, rows.id(), space.id(), H5P_DEFAULT, values.data()),
        "reading a dataset");
  return values;
}

struct Reader::File {
  Handle file;
  std::optional<memmap::Map> map;
  std::vector<double> time;
  struct Column {
    std::string partition;
    std::size_t index;
    std::string unit;
  };
  std::map<std::string, Column> columns;
  std::vector<std::string> names;
  /// The uncompressed partition read last; callers tend to read signals of one partition together.
  std::string cached;
  std::vector<double> values;

  void index_partition(const Handle& signals, const std::string& partition) {
    if (H5Lexists(signals.id(), partition.c_str(), H5P_DEFAULT) <= 0) return;
    const Handle dataset = open_dataset(signals.id(), partition);
    // After a crash, tables can differ in length; a row is valid if all tables have it.
    const Handle space{H5Dget_space(dataset.id()), H5Sclose, "HDF5 space"};
    hsize_t extent[2] = {0, 0};
    if (H5Sget_simple_extent_ndims(space.id()) != 2)
      throw Error{"dataset " + partition + " is no table, expected two dimensions"};
    H5Sget_simple_extent_dims(space.id(), extent, nullptr);
    time.resize(std::min<std::size_t>(time.size(), extent[0]));
    const auto signal_names = read_text_list_attribute(dataset.id(), "names");
    const auto units = read_text_list_attribute(dataset.id(), "units");
    if (units.size() != signal_names.size() || extent[1] != signal_names.size())
      throw Error{fmt::format("dataset {} has {} columns, {} names and {} units", partition,
                              extent[1], signal_names.size(), units.size())};
    for (std::size_t i = 0; i < signal_names.size(); ++i) {
      columns[signal_names[i]] = {partition, i, units[i]};
      names.push_back(signal_names[i]);
    }
  }

  [[nodiscard]] std::vector<double> column(const Column& of) {
    if (cached != of.partition) {
      const Handle table = open_dataset(file.id(), "signals/" + of.partition);
      if (is_column_by_column(table)) return read_column(table, of.index);
    }
    const auto& all = load(of.partition);
    const std::size_t columns_in_all = width(of.partition);
    std::vector<double> result(all.size() / columns_in_all);
    for (std::size_t row = 0; row < result.size(); ++row)
      result[row] = all[row * columns_in_all + of.index];
    return result;
  }

  const std::vector<double>& load(const std::string& partition) {
    if (cached != partition) {
      values = read_all<double>(open_dataset(file.id(), "signals/" + partition));
      cached = partition;
    }
    return values;
  }

  // Reads what a caller can ask for.
  void read_everything(const Reader& reader) {
    for (const auto& partition : map->partitions())
      if (width(partition.name) > 0) static_cast<void>(load(partition.name));
    static_cast<void>(reader.meta());
    static_cast<void>(reader.events());
    static_cast<void>(reader.drops());
    static_cast<void>(reader.rows_missing());
    for (const auto& name : names_in(open_group(file.id(), "config")))
      static_cast<void>(reader.config(name));
    for (const auto& name : names_in(open_group(file.id(), "meta")))
      static_cast<void>(reader.meta_series(name));
  }

  [[nodiscard]] std::size_t width(const std::string& partition) const {
    std::size_t count = 0;
    for (const auto& [name, column] : columns) count += column.partition == partition ? 1 : 0;
    return count;
  }
};

Reader::Reader(const std::filesystem::path& path) : file_{std::make_unique<File>()} {
  probe(path, [&] {
    const Reader reader{path};
    reader.file_->read_everything(reader);
  });
  file_->file = open_file(path);
  silence_hdf5();
  if (H5Aexists(file_->file.id(), "recording_format") <= 0)
    throw Error{path.string() +
                ": found an HDF5 file of another kind, expected a recording of a run"};
  const std::string format = read_text_attribute(file_->file.id(), "recording_format");
  if (format != std::to_string(kRecordingFormat))
    throw Error{fmt::format("{}: recording format is {}, this program reads {}", path.string(),
                            format, kRecordingFormat)};
  file_->map =
      memmap::parse_map(read_text_dataset(file_->file.id(), "map"), path.string() + ":map");
  for (const auto ns : read_all<std::int64_t>(open_dataset(file_->file.id(), "time"))) {
    if (ns == kNoTime) break;  // a row that the file system did not write completely
    file_->time.push_back(to_seconds(Duration{ns}));
  }
  const Handle signals = open_group(file_->file.id(), "signals");
  for (const auto& partition : file_->map->partitions())
    file_->index_partition(signals, partition.name);
}

Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

const memmap::Map& Reader::map() const { return *file_->map; }
std::size_t Reader::rows() const { return file_->time.size(); }
const std::vector<double>& Reader::time() const { return file_->time; }
std::vector<std::string> Reader::names() const { return file_->names; }
bool Reader::has(const std::string& signal) const { return file_->columns.count(signal) > 0; }

std::vector<double> Reader::signal(const std::string& name) const {
  const auto found = file_->columns.find(name);
  if (found == file_->columns.end()) {
    throw Error{
        fmt::format("the recording has no signal '{}'{}", name, did_you_mean(name, file_->names))};
  }
  auto result = file_->column(found->second);
  result.resize(std::min(file_->time.size(), result.size()));
  return result;
}

std::string Reader::unit(const std::string& name) const { return file_->columns.at(name).unit; }

std::string Reader::config(const std::string& name) const {
  const Handle group = open_group(file_->file.id(), "config");
  if (H5Lexists(group.id(), name.c_str(), H5P_DEFAULT) <= 0) return "";
  return read_text_dataset(group.id(), name);
}

std::map<std::string, std::string> Reader::meta() const {
  std::map<std::string, std::string> meta;
  read_texts(open_group(file_->file.id(), "meta"), meta);
  if (const Handle additions = open_additions(file_->file);
      H5Lexists(additions.id(), kAddedTexts, H5P_DEFAULT) > 0)
    read_texts(open_group(additions.id(), kAddedTexts), meta);
  return meta;
}

Reader::Series Reader::meta_series(const std::string& name) const {
  const Handle group = open_additions(file_->file);
  if (H5Lexists(group.id(), name.c_str(), H5P_DEFAULT) <= 0) return {};
  const Handle dataset = open_dataset(group.id(), name);
  const std::string interval = read_text_attribute(dataset.id(), "interval_s");
  const auto seconds = number_of(interval);
  if (!seconds)
    throw Error{fmt::format("/meta/{}: interval_s is '{}', expected a number", name, interval)};
  return {*seconds, read_all<double>(dataset)};
}

std::vector<Reader::Event> Reader::events() const {
  const Handle group = open_group(file_->file.id(), "events");
  const Handle signal = open_dataset(group.id(), "signal");
  const auto names = read_text_list_attribute(signal.id(), "names");
  const auto times = read_all<std::int64_t>(open_dataset(group.id(), "time"));
  const auto signals = read_all<std::int32_t>(signal);
  const auto values = read_all<double>(open_dataset(group.id(), "value"));
  std::vector<Event> events;
  const std::size_t count = std::min({times.size(), signals.size(), values.size()});
  for (std::size_t i = 0; i < count; ++i)
    events.push_back({to_seconds(Duration{times[i]}),
                      names.at(static_cast<std::size_t>(signals[i])), values[i]});
  return events;
}

std::vector<std::pair<std::string, std::int64_t>> Reader::drops() const {
  const Handle dataset = open_dataset(file_->file.id(), "drops");
  const auto names = read_text_list_attribute(dataset.id(), "names");
  const auto counts = read_all<std::int64_t>(dataset);
  std::vector<std::pair<std::string, std::int64_t>> drops;
  for (std::size_t i = 0; i < names.size(); ++i) drops.emplace_back(names[i], counts.at(i));
  return drops;
}

std::int64_t Reader::rows_missing() const {
  if (H5Lexists(file_->file.id(), kRowsMissing, H5P_DEFAULT) <= 0) return 0;
  return read_all<std::int64_t>(open_dataset(file_->file.id(), kRowsMissing)).at(0);
}

bool is_hdf5(const std::filesystem::path& path) {
  constexpr std::array<unsigned char, 8> kSignature{0x89, 'H', 'D', 'F', '\r', '\n', 0x1A, '\n'};
  std::array<unsigned char, 8> begin{};
  if (!std::filesystem::is_regular_file(path)) return false;
  std::ifstream file{path, std::ios::binary};
  file.read(reinterpret_cast<char*>(begin.data()), begin.size());
  return file.good() && begin == kSignature;
}

namespace {

// Links a new object into the recording when it is complete on disk: a process that dies before
// leaves the recording as it was.
void link_addition(const Handle& file, const Handle& object, const std::string& name) {
  check(H5Fflush(file.id(), H5F_SCOPE_GLOBAL), "writing " + name);
  const Handle additions = open_additions(file);
  check(H5Olink(object.id(), additions.id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT),
        "adding " + name);
}

void add_series(const Handle& file, const std::string& name, const Reader::Series& series) {
  const hsize_t count = series.values.size();
  const Handle space{H5Screate_simple(1, &count, nullptr), H5Sclose, "HDF5 space"};
  const Handle dataset{
      H5Dcreate_anon(file.id(), H5T_NATIVE_DOUBLE, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Dclose,
      "creating dataset " + name};
  write_text_attribute(dataset.id(), "interval_s", fmt::format("{}", series.interval));
  check(H5Dwrite(dataset.id(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
                 series.values.data()),
        "writing dataset " + name);
  link_addition(file, dataset, name);
}

void add_texts(const Handle& file, const NamedTexts& texts) {
  if (texts.empty()) return;
  const Handle group{H5Gcreate_anon(file.id(), H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                     "creating a group"};
  for (const auto& [name, text] : texts) write_text_attribute(group.id(), name, text);
  link_addition(file, group, kAddedTexts);
}

}  // namespace

void add_meta(const std::filesystem::path& path, const NamedTexts& texts,
              const std::vector<std::pair<std::string, Reader::Series>>& series) {
  const auto add = [&](const std::filesystem::path& target) {
    static_cast<void>(repair(target));  // a killed writer leaves its file open for writing
    silence_hdf5();
    const Handle access = without_lock();
    const Handle file{H5Fopen(target.c_str(), H5F_ACC_RDWR, access.id()), H5Fclose,
                      target.string() + ": opening the recording to add data"};
    add_texts(file, texts);
    for (const auto& [name, values] : series) add_series(file, name, values);
  };
  try {
    replace_file(path, kCopying, [&](const std::filesystem::path& copy) {
      std::filesystem::copy_file(path, copy, std::filesystem::copy_options::overwrite_existing);
      add(copy);
      write_through(copy);
    });
  } catch (const Error&) {  // is the disk full?
    add(path);
  }
}

namespace {

bool repair_here(const std::filesystem::path& path) {
  silence_hdf5();
  if (const hid_t file = open_to_read(path, H5F_ACC_RDONLY); file >= 0) {
    H5Fclose(file);
    return false;
  }
  if (WriterLock::is_held(path)) return false;  // it has a writer: nothing to repair
  // As h5clear does. The property is in the library, but not in its headers.
  const Handle access = without_lock();
  const hbool_t clear = true;
  check(H5Pset(access.id(), "clear_status_flags", &clear), "HDF5 properties");
  const hid_t opened = H5Fopen(path.c_str(), H5F_ACC_RDWR, access.id());
  if (opened < 0) return false;  // truncated by a full disk: only readers open it
  const Handle file{opened, H5Fclose, path.string()};
  // If the writer was killed during a batch, the file is longer than its recorded length, and
  // closing it would truncate it.
  check(H5Fincrement_filesize(file.id(), 0), path.string() + ": repairing the length of the file");
  return true;
}

}  // namespace

bool repair(const std::filesystem::path& path) {
  return in_child(path, [&] { return repair_here(path); });
}

}  // namespace rths::recording
