// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <rths/memmap/codec.hpp>
#include <rths/memmap/map.hpp>

namespace rths::test {

/// Bytes of a ring from word 0 to the map's last signal. The k-th signal by offset, from 0, holds
/// k + 1/2 in its unit, or k for integers; all other words are 0. The image shows type and offset
/// of each word; the map's hash covers units and names.
inline std::string image_of(const memmap::Map& map) {
  std::vector<std::uint32_t> words(map.signals().back().signal->offset.value() + 1);
  for (std::size_t k = 0; k < map.signals().size(); ++k) {
    const memmap::Signal& signal = *map.signals()[k].signal;
    const memmap::Codec codec{signal};
    const double half = signal.type == memmap::WordType::F32 ? 0.5 : 0.0;
    words[signal.offset.value()] = codec.encode(codec.to_si(static_cast<double>(k) + half));
  }
  std::string image(words.size() * sizeof words[0], '\0');
  std::memcpy(image.data(), words.data(), image.size());
  return image;
}

}  // namespace rths::test
