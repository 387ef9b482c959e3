// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

namespace rths::session {

/// Keeps other processes from writing results into a folder until it is destroyed. The kernel
/// releases the lock if the process dies. Results of an earlier run that a killed one had set aside
/// are in their place again.
class FolderLock {
 public:
  /// @throws Error that names the process with the lock, or the reason why the folder is not
  ///         writable   @setup
  explicit FolderLock(const std::filesystem::path& folder);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
};

/// A recording, or that of the run in a folder.
/// @throws Error if the folder has none   @setup
[[nodiscard]] std::filesystem::path recording_in(const std::filesystem::path& file_or_folder);

/// Creates a folder and its parents. @throws Error if that fails   @setup
void create_folder(const std::filesystem::path& folder);

/// Creates a folder and its parents; the destructor removes those that it made and that are empty.
class NewFolder {
 public:
  /// @throws Error if that fails   @setup
  explicit NewFolder(const std::filesystem::path& folder);
  ~NewFolder();
  NewFolder(const NewFolder&) = delete;
  NewFolder& operator=(const NewFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  ///< innermost first
};

/// Output folder of a run, locked until it is destroyed. Results of an earlier run are lost only
/// when the new run begins; if it does not begin, the destructor restores everything.
class RunFolder {
 public:
  /// A new folder named by the time, `runs`/<UTC>, and later the link `runs`/latest to it.
  /// @throws Error if the folder cannot be created   @setup
  explicit RunFolder(const std::filesystem::path& runs);
  /// The given folder itself.
  /// @param replaces  whether results of an earlier run are replaced
  /// @throws Error if the folder is in use, cannot be written, or holds such results   @setup
  RunFolder(const std::filesystem::path& folder, bool replaces);
  ~RunFolder();
  RunFolder(const RunFolder&) = delete;
  RunFolder& operator=(const RunFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }
  /// Call it when all nodes are ready: removes earlier results, and makes `latest` this folder.
  /// @throws Error if the link cannot be made   @setup
  void begin();
  [[nodiscard]] bool has_begun() const { return has_begun_; }

 private:
  std::filesystem::path folder_;
  std::filesystem::path link_;               ///< empty: no link
  std::vector<std::filesystem::path> made_;  ///< folders that did not exist, innermost first
  std::optional<FolderLock> lock_;
  bool has_begun_ = false;
};

}  // namespace rths::session
