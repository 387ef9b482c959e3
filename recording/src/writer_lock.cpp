// SPDX-License-Identifier: Apache-2.0
#include "writer_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <fstream>
#include <utility>

#include <rths/recording/recording.hpp>

namespace rths::recording {
namespace {

int open_to_lock(const std::filesystem::path& file) {
  return open(file.c_str(), O_RDONLY | O_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
}

// Whether the superblock says that the file is open for writing (HDF5 file format, superblock
// versions 2 and 3: "file consistency flags").
bool is_marked(const std::filesystem::path& file) {
  constexpr std::size_t kVersion = 8, kFlags = 11;
  constexpr unsigned kOpenForWriting = 1, kOneWriter = 4;
  std::array<char, kFlags + 1> begin{};
  if (!is_hdf5(file) || !std::ifstream{file, std::ios::binary}.read(begin.data(), begin.size()))
    return false;
  const auto flags = static_cast<unsigned char>(begin[kFlags]);
  return begin[kVersion] >= 2 && (flags & (kOpenForWriting | kOneWriter)) != 0;
}

}  // namespace

// A shared lock admits readers, whose library also takes a shared lock. Writers need an exclusive
// lock, which this one prevents.
WriterLock::WriterLock(const std::filesystem::path& file) : descriptor_{open_to_lock(file)} {
  if (descriptor_ >= 0) flock(descriptor_, LOCK_SH | LOCK_NB);
}

WriterLock::WriterLock(WriterLock&& other) noexcept
    : descriptor_{std::exchange(other.descriptor_, -1)} {}

WriterLock& WriterLock::operator=(WriterLock&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

WriterLock::~WriterLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool WriterLock::is_at(const std::filesystem::path& file) const {
  struct stat opened {};
  struct stat named {};
  if (fstat(descriptor_, &opened) != 0) return true;  // unknown
  if (stat(file.c_str(), &named) != 0) return errno != ENOENT;
  return opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

bool WriterLock::is_held(const std::filesystem::path& file) {
  const int descriptor = open_to_lock(file);
  if (descriptor < 0) return false;
  const bool free = flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  close(descriptor);
  return !free;
}

// Readers may hold a lock, too, and a crashed writer leaves its mark.
bool is_being_written(const std::filesystem::path& file) {
  return is_marked(file) && WriterLock::is_held(file);
}

}  // namespace rths::recording
