// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <vector>

namespace rths::replicated {

/// Bytes that read as zero until they are written; pages of 4 KiB exist from their first write.
class SparseBytes {
 public:
  explicit SparseBytes(std::uint64_t bytes) : pages_((bytes + kPage - 1) / kPage), bytes_{bytes} {}

  [[nodiscard]] std::uint64_t size() const { return bytes_; }
  /// @pre the value does not cross a page: it is aligned to its size
  template <class Value>
  [[nodiscard]] Value get(std::uint64_t at) const {
    Value value = 0;
    if (const auto& page = pages_[at / kPage])
      std::memcpy(&value, &(*page)[at % kPage], sizeof value);
    return value;
  }
  template <class Value>
  void set(std::uint64_t at, Value value) {
    auto& page = pages_[at / kPage];
    if (!page) {
      if (value == 0) return;
      page = std::make_unique<Page>();
    }
    std::memcpy(&(*page)[at % kPage], &value, sizeof value);
  }
  void clear() {
    for (auto& page : pages_) page.reset();
  }

 private:
  static constexpr std::uint64_t kPage = 4096;
  using Page = std::array<std::byte, kPage>;
  std::vector<std::unique_ptr<Page>> pages_;
  std::uint64_t bytes_;
};

}  // namespace rths::replicated
