// SPDX-License-Identifier: Apache-2.0
#include <rths/memmap/codec.hpp>

#include <rths/memmap/units.hpp>

namespace rths::memmap {

Codec::Codec(const Signal& signal) : type_{signal.type} {
  const Unit unit = parse_unit(signal.unit);
  scale_ = unit.scale;
  offset_ = unit.offset;
}

}  // namespace rths::memmap
