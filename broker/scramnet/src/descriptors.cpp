// SPDX-License-Identifier: Apache-2.0
//
// The card's descriptors. Clients call ioctl and open of the C library. The vendor's command
// numbers 1 and 2 have another meaning in the kernel and must not reach it. This library is linked
// before the C library, so its ioctl and open are found first: they handle the card's descriptors
// and pass everything else to the kernel.
#include <linux/fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cstdarg>
#include <cstring>
#include <mutex>

#include "plus_state.hpp"

#include <scrplus.h>

namespace rths::scramnet {
namespace {

// The card's descriptors with their inodes: a descriptor number may be closed and reused.
struct Known {
  std::atomic<int> descriptor{-1};
  ino_t inode = 0;
};
constexpr std::size_t kMostDescriptors = 64;
std::array<Known, kMostDescriptors> known;
std::atomic<std::size_t> known_count{0};
std::mutex opening;

bool is_file(int descriptor, ino_t inode) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && status.st_ino == inode;
}

bool is_ours(int descriptor) noexcept {
  for (std::size_t i = 0; i < known_count.load(); ++i)
    if (known[i].descriptor.load() == descriptor && is_file(descriptor, known[i].inode))
      return true;
  return false;
}

bool remember(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return false;
  for (std::size_t i = 0; i < kMostDescriptors; ++i) {
    Known& entry = known[i];
    const int old = entry.descriptor.load();
    if (old >= 0 && is_file(old, entry.inode)) continue;
    entry.inode = status.st_ino;
    entry.descriptor.store(descriptor);
    if (i >= known_count.load()) known_count.store(i + 1);
    return true;
  }
  return false;
}

bool is_interrupt_device(const char* path) {
  return path != nullptr && Scramnet_config.scram_int_dev != nullptr &&
         std::strcmp(path, Scramnet_config.scram_int_dev) == 0;
}

int open_device() noexcept {
  BoardError error{};
  if (take_board(error) != nullptr) return open_descriptor();
  errno = ENODEV;
  return -1;
}

int open_any(int folder, const char* path, int flags, mode_t mode) noexcept {
  if (is_interrupt_device(path)) return open_device();
  return static_cast<int>(syscall(SYS_openat, folder, path, flags, mode));
}

}  // namespace

int open_descriptor() noexcept {
  const std::lock_guard lock{opening};
  const int descriptor = memfd_create("scramnet", MFD_CLOEXEC);
  if (descriptor >= 0 && remember(descriptor)) return descriptor;
  if (descriptor >= 0) close(descriptor);
  return -1;
}

}  // namespace rths::scramnet

using namespace rths::scramnet;

namespace {

// The argument is present only if the flags may create a file.
mode_t mode_of(int flags, va_list arguments) {
  constexpr int kMakes = O_CREAT | __O_TMPFILE;
  return (flags & kMakes) != 0 ? va_arg(arguments, mode_t) : 0;
}

}  // namespace

extern "C" {

int ioctl(int descriptor, unsigned long command, ...) noexcept {
  va_list arguments;
  va_start(arguments, command);
  void* argument = va_arg(arguments, void*);
  va_end(arguments);
  if (is_ours(descriptor)) return control_card(command, argument);
  return static_cast<int>(syscall(SYS_ioctl, descriptor, command, argument));
}

int open(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_any(AT_FDCWD, path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_any(AT_FDCWD, path, flags | O_LARGEFILE, mode);
}

int openat(int folder, const char* path, int flags, ...) {
  va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = mode_of(flags, arguments);
  va_end(arguments);
  return open_any(folder, path, flags, mode);
}
}
