// SPDX-License-Identifier: Apache-2.0
#include <rths/fmi/fmu_files.hpp>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zip.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>
#include <rths/core/interrupted.hpp>

namespace rths::fmi {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDescription = "modelDescription.xml";
constexpr const char* kPrefix = "rths-fmu-";
constexpr const char* kLockEnding = ".lock";
constexpr std::uint64_t kMostFiles = 100'000, kMostBytes = 4ULL << 30U;  // of a packed FMU
#if defined(__x86_64__)
constexpr const char* kPlatform2 = "linux64";
constexpr const char* kPlatform3 = "x86_64-linux";
#else
constexpr const char* kPlatform2 = "aarch64-linux";
constexpr const char* kPlatform3 = "aarch64-linux";
#endif

/// A packed FMU.
class Archive {
 public:
  explicit Archive(const fs::path& file) : file_{file.string()} {
    int code = 0;
    zip_.reset(zip_open(file.c_str(), ZIP_RDONLY, &code));
    if (zip_) return;
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    const std::string reason = zip_error_strerror(&error);
    zip_error_fini(&error);
    throw Error{fmt::format("{}: cannot be read as an FMU: {}", file_, reason)};
  }

  [[nodiscard]] std::string text(const char* name, std::uint64_t most_bytes) const {
    const auto index = zip_name_locate(zip_.get(), name, 0);
    if (index < 0) throw Error{fmt::format("{}: has no {}, expected an FMU", file_, name)};
    std::string content;
    read(static_cast<std::uint64_t>(index), most_bytes,
         [&](const char* bytes, std::size_t count) { content.append(bytes, count); });
    return content;
  }

  void unpack(const fs::path& folder) const {
    const auto count = static_cast<std::uint64_t>(zip_get_num_entries(zip_.get(), 0));
    if (count > kMostFiles)
      throw Error{fmt::format("{}: has {} files, expected at most {}", file_, count, kMostFiles)};
    std::uint64_t left = kMostBytes;
    for (std::uint64_t i = 0; i < count; ++i) {
      const char* name = zip_get_name(zip_.get(), i, 0);
      const fs::path path = inside(name != nullptr ? name : "");
      if (!path.has_filename()) continue;
      fs::create_directories((folder / path).parent_path());
      std::ofstream out{folder / path, std::ios::binary};
      left -= read(i, left, [&](const char* bytes, std::size_t size) {
        out.write(bytes, static_cast<std::streamsize>(size));
      });
      if (!out.flush())
        throw Error{fmt::format("{}: {} cannot be written: {}", file_, (folder / path).string(),
                                std::strerror(errno))};
    }
  }

 private:
  struct Closed {
    void operator()(zip_t* zip) const { zip_discard(zip); }
    void operator()(zip_file_t* file) const { zip_fclose(file); }
  };

  // A name that leaves the folder is refused.
  [[nodiscard]] fs::path inside(const std::string& name) const {
    const fs::path path = fs::path{name}.lexically_normal();
    if (name.empty() || path.is_absolute() || *path.begin() == "..")
      throw Error{fmt::format("{}: holds a file '{}', expected names inside the FMU", file_, name)};
    return path;
  }

  template <class Take>
  std::uint64_t read(std::uint64_t index, std::uint64_t most_bytes, Take take) const {
    const std::unique_ptr<zip_file_t, Closed> entry{zip_fopen_index(zip_.get(), index, 0)};
    if (!entry) throw Error{fmt::format("{}: {}", file_, zip_strerror(zip_.get()))};
    std::vector<char> buffer(1U << 16U);
    std::uint64_t all = 0;
    for (;;) {
      stop_if_interrupted();
      const auto count = zip_fread(entry.get(), buffer.data(), buffer.size());
      if (count < 0)
        throw Error{
            fmt::format("{}: {}", file_, zip_error_strerror(zip_file_get_error(entry.get())))};
      if (count == 0) return all;
      all += static_cast<std::uint64_t>(count);
      if (all > most_bytes)
        throw Error{fmt::format("{}: is larger than {} bytes when unpacked", file_, kMostBytes)};
      take(buffer.data(), static_cast<std::size_t>(count));
    }
  }

  std::string file_;
  std::unique_ptr<zip_t, Closed> zip_;
};

// The lock of a living process cannot be taken. A lock file that another process has just removed
// has no name, and one of another user is left alone.
bool take_lock(int lock) {
  struct stat state {};
  return flock(lock, LOCK_EX | LOCK_NB) == 0 && fstat(lock, &state) == 0 && state.st_nlink > 0 &&
         state.st_uid == geteuid();
}

void remove_left_folders(const fs::path& parent) noexcept {
  std::error_code end;
  for (fs::directory_iterator entry{parent, end}; !end && entry != fs::directory_iterator{};
       entry.increment(end)) {
    std::error_code error;
    const fs::path lock_file = entry->path();
    if (!lock_file.filename().string().starts_with(kPrefix) || lock_file.extension() != kLockEnding)
      continue;
    const int lock = open(lock_file.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
    if (lock < 0) continue;
    if (take_lock(lock)) {
      fs::remove_all(fs::path{lock_file}.replace_extension(), error);
      fs::remove(lock_file, error);
    }
    close(lock);
  }
}

// Platforms of its binaries, for a message.
std::vector<std::string> platforms_in(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator{folder / "binaries", error})
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace

FmuFiles::FmuFiles(const fs::path& file) {
  if (fs::is_directory(file)) {
    folder_ = fs::absolute(file);
    return;
  }
  const Archive archive{file};
  const fs::path parent = temporary_folder();
  remove_left_folders(parent);
  std::string name;
  do {
    if (lock_ >= 0) close(lock_);
    name = (parent / kPrefix).string() + "XXXXXX" + kLockEnding;
    lock_ = mkostemps(name.data(), static_cast<int>(std::strlen(kLockEnding)), O_CLOEXEC);
    if (lock_ < 0)
      throw Error{fmt::format("{}: no temporary folder in {}: {}", file.string(), parent.string(),
                              std::strerror(errno))};
  } while (!take_lock(lock_));
  lock_file_ = name;
  folder_ = fs::path{name}.replace_extension();
  try {
    if (mkdir(folder_.c_str(), S_IRWXU) != 0)
      throw Error{fmt::format("{}: {}", folder_.string(), std::strerror(errno))};
    archive.unpack(folder_);
  } catch (const fs::filesystem_error& error) {
    remove();
    throw Error{fmt::format("{}: {}", file.string(), error.what())};
  } catch (...) {
    remove();
    throw;
  }
}

FmuFiles::~FmuFiles() {
  remove();
  if (!lock_file_.empty()) remove_left_folders(lock_file_.parent_path());
}

void FmuFiles::remove() noexcept {
  if (lock_file_.empty()) return;
  std::error_code error;
  fs::remove_all(folder_, error);
  fs::remove(lock_file_, error);
  close(lock_);
}

ModelDescription read_description(const fs::path& file) {
  if (fs::is_directory(file)) {
    if (!fs::exists(file / kDescription))
      throw Error{fmt::format("{}: has no {}, expected an FMU", file.string(), kDescription)};
    const fs::path place = file / kDescription;
    return parse_description(read_file(place, kMostTextBytes), place.string());
  }
  check_is_file(file);
  return parse_description(Archive{file}.text(kDescription, kMostTextBytes),
                           file.string() + ": " + kDescription);
}

fs::path library_in(const fs::path& folder, const ModelDescription& description) {
  const char* platform = description.version == 2 ? kPlatform2 : kPlatform3;
  const fs::path name = fs::path{"binaries"} / platform / (description.identifier + ".so");
  if (fs::exists(folder / name)) return folder / name;
  const auto found = platforms_in(folder);
  throw Error{fmt::format(
      "has no {}: it has {}, expected a binary for Linux", name.string(),
      found.empty() ? "no binaries" : fmt::format("binaries for {}", fmt::join(found, ", ")))};
}

}  // namespace rths::fmi
