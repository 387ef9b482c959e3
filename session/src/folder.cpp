// SPDX-License-Identifier: Apache-2.0
#include <rths/session/folder.hpp>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <iterator>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <rths/cases/case.hpp>
#include <rths/core/error.hpp>
#include <rths/recording/recording.hpp>
#include <rths/report/diagnosis.hpp>
#include <rths/report/report.hpp>

namespace rths::session {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLockFile = ".lock";
// Results of an earlier run until the new one begins, and while they are removed.
constexpr const char* kSetAside = ".earlier";
constexpr const char* kDiscarded = ".discarded";
constexpr int kMostAttempts = 1000;

constexpr const char* kResults[] = {report::kRunFile,
                                    report::kRealTimeFile,
                                    report::kUncompensatedFile,
                                    report::kNumericalFile,
                                    report::kImprovedFile,
                                    diagnosis::kHeldOutFile,
                                    report::kVerdictFile,
                                    report::kDiagnosisPage,
                                    report::kFragmentFile,
                                    report::kImprovedFolder,
                                    report::kPredictionFolder,
                                    report::kMotionFile,
                                    "report.html",
                                    "report.json"};

// The holder of a lock may have removed the file between opening and locking it.
bool is_same_file(int descriptor, const fs::path& file) {
  struct stat opened {};
  struct stat named {};
  return fstat(descriptor, &opened) == 0 && stat(file.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

int open_lock(const fs::path& file) {
  constexpr int kFlags = O_RDWR | O_CREAT | O_CLOEXEC;
  return open(file.c_str(), kFlags, 0666);  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

bool try_to_lock(int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  return fcntl(descriptor, F_SETLK, &whole) == 0;  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

std::string holder_of(int descriptor) {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  // NOLINTNEXTLINE(cppcoreguidelines-pro-type-vararg)
  const bool is_known = fcntl(descriptor, F_GETLK, &whole) == 0 && whole.l_pid > 0;
  return is_known ? fmt::format("process {}", whole.l_pid) : "another process";
}

bool has_results(const fs::path& folder) {
  return std::any_of(std::begin(kResults), std::end(kResults),
                     [&](const char* file) { return fs::exists(folder / file); });
}

void move_results(const fs::path& from, const fs::path& to) {
  for (const char* file : kResults)
    if (fs::exists(from / file)) fs::rename(from / file, to / file);
}

void remove_results(const fs::path& folder) {
  std::error_code ignored;
  for (const std::string file : kResults) {
    fs::remove_all(folder / file, ignored);
    fs::remove(folder / (file + recording::kCopying), ignored);
  }
}

// Undoes `set_aside`, also that of a process that was killed before its run began.
void restore_earlier(const fs::path& folder) {
  if (!fs::exists(folder / kSetAside)) return;
  remove_results(folder);
  move_results(folder / kSetAside, folder);
  fs::remove(folder / kSetAside);
}

void set_aside(const fs::path& folder) {
  fs::create_directory(folder / kSetAside);
  move_results(folder, folder / kSetAside);
  remove_results(folder);
}

// The rename makes the removal one step for `restore_earlier`.
void discard_earlier(const fs::path& folder) {
  std::error_code ignored;
  fs::remove_all(folder / kDiscarded, ignored);
  if (!fs::exists(folder / kSetAside)) return;
  fs::rename(folder / kSetAside, folder / kDiscarded);
  fs::remove_all(folder / kDiscarded, ignored);
}

// The folder and its parents that do not exist, innermost first.
std::vector<fs::path> missing_folders(fs::path folder) {
  std::vector<fs::path> missing;
  for (; !folder.empty() && !fs::exists(folder); folder = folder.parent_path())
    missing.push_back(folder);
  return missing;
}

// Creates a folder named by the time; a number distinguishes runs of the same second.
fs::path make_stamped(const fs::path& runs) {
  const std::string stamp = fmt::format("{:%Y-%m-%dT%H%M%SZ}", fmt::gmtime(std::time(nullptr)));
  for (int attempt = 1; attempt <= kMostAttempts; ++attempt) {
    const auto folder = runs / (attempt == 1 ? stamp : fmt::format("{}.{}", stamp, attempt));
    create_folder(runs);
    std::error_code error;
    if (fs::create_directory(folder, error)) return folder;
    if (error)
      throw Error{fmt::format("{}: cannot be created: {}", folder.string(), error.message())};
  }
  throw Error{fmt::format("{}: has {} runs of this second", runs.string(), kMostAttempts)};
}

// Without a moment at which the link is missing.
void switch_link(const fs::path& link, const fs::path& target) {
  const fs::path next =
      link.parent_path() / fmt::format(".{}.{}", link.filename().string(), getpid());
  std::error_code error;
  fs::remove(next, error);
  fs::create_symlink(target, next, error);
  if (!error) fs::rename(next, link, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove(next, ignored);
  throw Error{fmt::format("{}: cannot be linked to {}: {}", link.string(), target.string(),
                          error.message())};
}

}  // namespace

// A record lock, because children do not inherit it.
FolderLock::FolderLock(const fs::path& folder) : file_{folder / kLockFile} {
  for (int attempt = 0; attempt < kMostAttempts; ++attempt) {
    descriptor_ = open_lock(file_);
    if (descriptor_ < 0)
      throw Error{fmt::format("{}: cannot be written: {}", folder.string(), std::strerror(errno))};
    if (!try_to_lock(descriptor_)) {
      const std::string holder = holder_of(descriptor_);
      close(descriptor_);
      throw Error{fmt::format("{}: is in use by {}, expected a folder that no process writes to",
                              folder.string(), holder)};
    }
    if (is_same_file(descriptor_, file_)) {
      restore_earlier(folder);
      return;
    }
    close(descriptor_);
  }
  throw Error{fmt::format("{}: cannot be locked", folder.string())};
}

FolderLock::~FolderLock() {
  unlink(file_.c_str());
  close(descriptor_);
}

std::filesystem::path recording_in(const std::filesystem::path& file_or_folder) {
  if (!std::filesystem::is_directory(file_or_folder)) return file_or_folder;
  auto recording = file_or_folder / report::kRunFile;
  if (!std::filesystem::exists(recording))
    throw Error{fmt::format("{}: the folder has no {}, expected that of a run",
                            file_or_folder.string(), report::kRunFile)};
  return recording;
}

void create_folder(const fs::path& folder) {
  if (folder.empty()) throw Error{"the folder for the results has no name"};
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    throw Error{fmt::format("{}: cannot be created: {}", folder.string(), error.message())};
}

NewFolder::NewFolder(const fs::path& folder)
    : made_{missing_folders(folder.has_filename() ? folder : folder.parent_path())} {
  create_folder(folder);
}

NewFolder::~NewFolder() {
  std::error_code ignored;
  for (const auto& folder : made_) fs::remove(folder, ignored);
}

RunFolder::RunFolder(const fs::path& runs) : link_{runs / "latest"} {
  made_ = missing_folders(runs);
  folder_ = make_stamped(runs);
  made_.insert(made_.begin(), folder_);
  lock_.emplace(folder_);
}

RunFolder::RunFolder(const fs::path& folder, bool replaces)
    : folder_{folder.has_filename() ? folder : folder.parent_path()} {
  made_ = missing_folders(folder_);
  create_folder(folder_);
  lock_.emplace(folder_);
  if (!has_results(folder_)) return;
  if (!replaces)
    throw Error{
        fmt::format("{}: holds the results of an earlier run, expected another folder, or "
                    "--force to replace them",
                    folder_.string())};
  set_aside(folder_);
}

void RunFolder::begin() {
  if (!link_.empty()) switch_link(link_, folder_.filename());
  discard_earlier(folder_);
  has_begun_ = true;
}

RunFolder::~RunFolder() {
  if (has_begun_) return;
  try {
    remove_results(folder_);
    restore_earlier(folder_);
  } catch (const fs::filesystem_error&) {  // NOLINT(bugprone-empty-catch)
    // The next run in this folder tries again.
  }
  lock_.reset();
  std::error_code ignored;
  for (const auto& folder : made_) fs::remove(folder, ignored);
}

}  // namespace rths::session
