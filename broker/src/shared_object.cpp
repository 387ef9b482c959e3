// SPDX-License-Identifier: Apache-2.0
#include <rths/broker/detail/shared_object.hpp>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include <rths/broker/detail/lost_memory.hpp>
#include <rths/core/error.hpp>

namespace rths::broker {
namespace {

constexpr mode_t kForOwnerAndGroup = 0660;
constexpr const char* kFolder = "/dev/shm";  // of POSIX shared memory

std::string path_of(const std::string& ring) { return "/" + object_name(ring); }

[[noreturn]] void fail(int problem) { throw Error{std::strerror(problem)}; }

struct stat status_of(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) fail(errno);
  if (!S_ISREG(status.st_mode)) throw Error{"it is no shared memory"};
  return status;
}

}  // namespace

void check_ring_name(const std::string& ring) {
  if (ring.find('/') != std::string::npos || object_name(ring).size() > NAME_MAX)
    throw Error{fmt::format("no ring can have the name '{}', expected at most {} bytes without '/'",
                            ring, NAME_MAX - object_name("").size())};
}

std::string object_name(const std::string& ring) { return "rths." + ring; }

std::string object_path(const std::string& ring) { return kFolder + path_of(ring); }

std::vector<std::string> ring_names() {
  const std::string prefix = object_name("");
  std::vector<std::string> names;
  std::error_code unreadable;
  for (const auto& file : std::filesystem::directory_iterator{kFolder, unreadable})
    if (const std::string object = file.path().filename().string(); object.starts_with(prefix))
      names.push_back(object.substr(prefix.size()));
  std::sort(names.begin(), names.end());
  return names;
}

bool remove_object(const std::string& ring) { return shm_unlink(path_of(ring).c_str()) == 0; }

Mapping::Mapping(std::byte* address, std::uint64_t bytes, std::atomic<bool>& lost)
    : address_{address}, bytes_{bytes} {
  guard(address, bytes, lost);
}

Mapping::~Mapping() {
  if (address_ == nullptr) return;
  unguard(address_);
  munmap(address_, bytes_);
}

SharedObject::SharedObject(int descriptor, ObjectAccess access)
    : descriptor_{descriptor}, access_{access} {
  if (descriptor < 0) fail(errno);
  try {
    const struct stat status = status_of(descriptor);
    device_ = status.st_dev;
    inode_ = status.st_ino;
  } catch (...) {
    close(descriptor);
    throw;
  }
}

SharedObject::SharedObject(SharedObject&& other) noexcept
    : descriptor_{std::exchange(other.descriptor_, -1)},
      access_{other.access_},
      device_{other.device_},
      inode_{other.inode_},
      lost_{std::move(other.lost_)} {}

SharedObject::~SharedObject() {
  if (descriptor_ >= 0) close(descriptor_);
}

SharedObject SharedObject::create(std::uint64_t bytes) {
  SharedObject object{::open(kFolder, O_TMPFILE | O_RDWR | O_CLOEXEC, kForOwnerAndGroup)};
  if (ftruncate(object.descriptor_, static_cast<off_t>(bytes)) != 0) fail(errno);
  return object;
}

void SharedObject::publish(const std::string& ring) const {
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor_);
  if (linkat(AT_FDCWD, link.c_str(), AT_FDCWD, object_path(ring).c_str(), AT_SYMLINK_FOLLOW) != 0)
    fail(errno);
}

SharedObject SharedObject::open(const std::string& ring, ObjectAccess access) {
  const int mode = access == ObjectAccess::ReadOnly ? O_RDONLY : O_RDWR;
  return SharedObject{shm_open(path_of(ring).c_str(), mode | O_CLOEXEC, 0), access};
}

std::optional<SharedObject> SharedObject::open_to_remove(const std::string& ring) {
  const int descriptor = shm_open(path_of(ring).c_str(), O_RDWR | O_CLOEXEC, 0);
  if (descriptor < 0 && errno == ENOENT) return std::nullopt;
  std::optional object{SharedObject{descriptor}};
  if (!object->members().exclude() || !object->has_name(ring)) object.reset();
  return object;
}

std::unique_ptr<Membership> SharedObject::enter() const {
  return std::make_unique<Membership>(descriptor_);
}

std::uint64_t SharedObject::size() const {
  struct stat status {};
  return fstat(descriptor_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

bool SharedObject::read(std::uint64_t begin, void* to, std::size_t bytes) const {
  for (std::size_t done = 0; done < bytes;) {
    const ssize_t count = pread(descriptor_, static_cast<std::byte*>(to) + done, bytes - done,
                                static_cast<off_t>(begin + done));
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

bool SharedObject::has_name(const std::string& ring) const {
  struct stat named {};
  return lstat(object_path(ring).c_str(), &named) == 0 && named.st_dev == device_ &&
         named.st_ino == inode_;
}

// Pages are reserved in advance: a page that is missing later is lost memory.
void SharedObject::reserve(std::uint64_t begin, std::uint64_t bytes) const {
  const int problem =
      posix_fallocate(descriptor_, static_cast<off_t>(begin), static_cast<off_t>(bytes));
  if (problem != 0) fail(problem);
}

Mapping SharedObject::map(std::uint64_t begin, std::uint64_t bytes) const {
  const int protection = access_ == ObjectAccess::ReadOnly ? PROT_READ : PROT_READ | PROT_WRITE;
  void* address =
      mmap(nullptr, bytes, protection, MAP_SHARED, descriptor_, static_cast<off_t>(begin));
  if (address == MAP_FAILED) fail(errno);
  return {static_cast<std::byte*>(address), bytes, *lost_};
}

}  // namespace rths::broker
