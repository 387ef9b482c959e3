// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <rths/broker/detail/process.hpp>

namespace rths::broker {

/// A mapped range. Until it is unmapped, lost pages are handled as `OnLostMemory` says.
class Mapping {
 public:
  Mapping() = default;
  Mapping(std::byte* address, std::uint64_t bytes, std::atomic<bool>& lost);
  Mapping(Mapping&& other) noexcept { swap(other); }
  Mapping& operator=(Mapping&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Mapping();
  [[nodiscard]] std::byte* address() const { return address_; }

 private:
  void swap(Mapping& other) noexcept {
    std::swap(address_, other.address_);
    std::swap(bytes_, other.bytes_);
  }
  std::byte* address_ = nullptr;
  std::uint64_t bytes_ = 0;
};

/// Whether a process may change an object, or only reads it.
enum class ObjectAccess { ReadWrite, ReadOnly };

/// The shared-memory object of a ring. Any program may have made it, and may change or truncate it
/// at any time.
class SharedObject {
 public:
  /// Creates an object of this size without a name, writable for owner and group as far as the
  /// umask permits. @throws Error if memory is short
  [[nodiscard]] static SharedObject create(std::uint64_t bytes);
  /// Gives the object the name of a ring, at which others find it from now on.
  /// @throws Error if the name is taken
  void publish(const std::string& ring) const;
  /// @throws Error with the reason of the system
  [[nodiscard]] static SharedObject open(const std::string& ring,
                                         ObjectAccess access = ObjectAccess::ReadWrite);
  /// The same, to remove or replace the object: until it is closed, no process can join the ring.
  /// Empty if a process is on it, or another one removes it.
  [[nodiscard]] static std::optional<SharedObject> open_to_remove(const std::string& ring);
  SharedObject(SharedObject&& other) noexcept;
  SharedObject& operator=(SharedObject&&) = delete;
  ~SharedObject();

  /// The processes on the ring.
  [[nodiscard]] Members members() const { return Members{descriptor_}; }
  /// @throws Error if the object is locked
  [[nodiscard]] std::unique_ptr<Membership> enter() const;
  /// Present size [B]; 0 if it is not known.
  [[nodiscard]] std::uint64_t size() const;
  /// Copies bytes. @returns false if the object is shorter
  [[nodiscard]] bool read(std::uint64_t begin, void* to, std::size_t bytes) const;
  /// Reserves space. @throws Error if memory is short
  void reserve(std::uint64_t begin, std::uint64_t bytes) const;
  /// @throws Error if the range cannot be mapped
  [[nodiscard]] Mapping map(std::uint64_t begin, std::uint64_t bytes) const;
  /// True if this object has the name of the ring now.
  [[nodiscard]] bool has_name(const std::string& ring) const;
  /// True once a page of a mapping was lost.
  [[nodiscard]] const std::atomic<bool>& lost() const { return *lost_; }

 private:
  explicit SharedObject(int descriptor, ObjectAccess access = ObjectAccess::ReadWrite);
  int descriptor_;
  ObjectAccess access_;
  dev_t device_ = 0;
  ino_t inode_ = 0;
  std::unique_ptr<std::atomic<bool>> lost_ = std::make_unique<std::atomic<bool>>(false);
};

/// @throws Error if no ring can have this name: it is that of a file
void check_ring_name(const std::string& ring);
/// Name of the shared-memory object of a ring.
[[nodiscard]] std::string object_name(const std::string& ring);
/// Its path in the file system.
[[nodiscard]] std::string object_path(const std::string& ring);
/// Names of the rings of this host, sorted.
[[nodiscard]] std::vector<std::string> ring_names();
/// Removes the name of a ring. @returns false if there was none, or it may not be removed
bool remove_object(const std::string& ring);

}  // namespace rths::broker
