// SPDX-License-Identifier: Apache-2.0
#include <rths/card/fifo.hpp>

namespace rths::scramnet {

bool push(InterruptFifo& fifo, std::uint32_t byte_address) noexcept {
  const std::uint32_t tail = fifo.tail.load();
  if (tail - fifo.head.load() >= kFifoEntries) {
    fifo.address[(tail - 1) % kFifoEntries].store(byte_address);
    return false;
  }
  fifo.address[tail % kFifoEntries].store(byte_address);
  fifo.tail.store(tail + 1);
  return true;
}

std::optional<std::uint32_t> peek(const InterruptFifo& fifo) noexcept {
  const std::uint32_t head = fifo.head.load();
  if (head == fifo.tail.load()) return std::nullopt;
  return fifo.address[head % kFifoEntries].load();
}

std::optional<std::uint32_t> pop(InterruptFifo& fifo) noexcept {
  for (std::uint32_t head = fifo.head.load(); head != fifo.tail.load();) {
    const std::uint32_t address = fifo.address[head % kFifoEntries].load();
    if (fifo.head.compare_exchange_weak(head, head + 1)) return address;
  }
  return std::nullopt;
}

std::uint32_t size(const InterruptFifo& fifo) noexcept {
  return fifo.tail.load() - fifo.head.load();
}

void clear(InterruptFifo& fifo) noexcept { fifo.head.store(fifo.tail.load()); }

}  // namespace rths::scramnet
