// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstring>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/dds/gateway.hpp>

#include "broker/src/layout.hpp"
#include "support/ring_maps.hpp"

namespace rths::test {

/// A host of a test: a ring with its own name, and a gateway.
class RingHost {
 public:
  RingHost(const std::string& name, const memmap::Map& map)
      : name_{name},
        removal_{unique_ring("dds_" + name)},
        ring_{broker::Ring::create(removal_.name, map)} {}

  void start(std::unique_ptr<dds::Carrier> carrier) {
    gateway_ =
        std::make_unique<dds::Gateway>(removal_.name, std::move(carrier),
                                       dds::GatewayOptions{name_, [this](const std::string& line) {
                                                             const std::lock_guard lock{mutex_};
                                                             lines_.push_back(line);
                                                           }});
  }
  void stop() { gateway_.reset(); }
  [[nodiscard]] broker::Ring& ring() { return ring_; }
  [[nodiscard]] const std::string& ring_name() const { return removal_.name; }
  [[nodiscard]] dds::Gateway& gateway() { return *gateway_; }
  [[nodiscard]] std::vector<std::string> lines() {
    const std::lock_guard lock{mutex_};
    return lines_;
  }

 private:
  std::string name_;
  RingRemoval removal_;
  broker::Ring ring_;
  std::mutex mutex_;
  std::vector<std::string> lines_;
  std::unique_ptr<dds::Gateway> gateway_;
};

/// Stores into a word of a ring past every API, as a stray pointer does.
inline void overwrite_word(const std::string& ring, LongwordOffset offset, std::uint32_t value) {
  const int file = shm_open(("/rths." + ring).c_str(), O_RDWR, 0);
  struct stat status {};
  fstat(file, &status);
  const auto bytes = static_cast<std::size_t>(status.st_size);
  auto* const all =
      static_cast<std::byte*>(mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
  const auto* const header = reinterpret_cast<const broker::Header*>(all);
  std::memcpy(all + header->memory_at + 4UL * offset.value(), &value, sizeof value);
  munmap(all, bytes);
  close(file);
}

/// Waits up to ten seconds for a condition.
template <class Condition>
[[nodiscard]] bool becomes_true(const Condition& condition, double seconds = 10) {
  const WallClock clock;
  const TimePoint deadline = clock.now() + from_seconds(seconds);
  while (!condition()) {
    if (clock.now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
  }
  return true;
}

}  // namespace rths::test
