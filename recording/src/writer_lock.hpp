// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace rths::recording {

/// Says that a recording is being written, for as long as it lives; the kernel lets go of it when
/// the process dies. The library's own lock ends where single-writer mode begins.
class WriterLock {
 public:
  WriterLock() = default;
  explicit WriterLock(const std::filesystem::path& file);
  WriterLock(WriterLock&& other) noexcept;
  WriterLock& operator=(WriterLock&& other) noexcept;
  ~WriterLock();

  /// True if somebody, this process included, holds the lock of a file.
  [[nodiscard]] static bool is_held(const std::filesystem::path& file);

 private:
  int descriptor_ = -1;
};

}  // namespace rths::recording
