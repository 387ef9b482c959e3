// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include <rths/card/bits.hpp>
#include <rths/card/card.hpp>

#include "sparse_bytes.hpp"

namespace rths::replicated {

/// ACR of a card, by longword: in this process, or in the object of an image.
class AcrCells {
 public:
  explicit AcrCells(std::uint64_t longwords) : own_{longwords} {}
  /// @param cells  as many longwords; null: those of this process
  void share(scramnet::Word* cells) { shared_ = cells; }
  [[nodiscard]] std::uint64_t size() const { return own_.size(); }
  [[nodiscard]] std::uint32_t get(std::uint64_t longword) const {
    if (shared_ != nullptr) return shared_[longword].load(std::memory_order_relaxed);
    return own_.get<std::uint8_t>(longword);
  }
  void set(std::uint64_t longword, std::uint32_t bits) {
    bits &= scramnet::acr::kBits;
    if (shared_ != nullptr)
      shared_[longword].store(bits);
    else
      own_.set(longword, static_cast<std::uint8_t>(bits));
  }
  void clear() {
    if (shared_ == nullptr) return own_.clear();
    for (std::uint64_t i = 0; i < size(); ++i)
      if (shared_[i].load(std::memory_order_relaxed) != 0) shared_[i].store(0);
  }

 private:
  SparseBytes own_;
  scramnet::Word* shared_ = nullptr;
};

}  // namespace rths::replicated
