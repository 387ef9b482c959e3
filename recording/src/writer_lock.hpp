// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rths::recording {

/// Marks a recording as being written. The kernel releases the lock when the process ends. The
/// library's own lock ends when single-writer mode begins.
class WriterLock {
 public:
  WriterLock() = default;
  explicit WriterLock(const std::filesystem::path& file);
  WriterLock(WriterLock&& other) noexcept;
  WriterLock& operator=(WriterLock&& other) noexcept;
  ~WriterLock();

  /// False if the file was removed or replaced by another.
  [[nodiscard]] bool is_at(const std::filesystem::path& file) const;
  /// True if a process, including this one, holds the lock of a file.
  [[nodiscard]] static bool is_held(const std::filesystem::path& file);

 private:
  int descriptor_ = -1;
};

}  // namespace rths::recording
