// SPDX-License-Identifier: Apache-2.0
//
// Our own ring through the vendor's API: words stored and loaded through the pointer that the
// vendor's library returns.
#include <unistd.h>

#include <cstdlib>
#include <memory>

#include <scrplus.h>

#include <rths/broker/ring.hpp>
#include <rths/core/error.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr unsigned kThere = 0;
constexpr unsigned kBack = 32;  // [longwords]: on another pair of lines

volatile unsigned* plug_in_card() {
  if (sp_scram_init(0) < 0) throw Error{"sp_scram_init failed"};
  scr_csr_write(SCR_CSR0, 0x8003);  // on the ring: insert, transmit, receive
  return reinterpret_cast<volatile unsigned*>(get_base_mem());
}

class PointerEnd {
 public:
  explicit PointerEnd(bench::Side side)
      : memory_{plug_in_card()},
        out_{side == bench::Side::Near ? kThere : kBack},
        in_{side == bench::Side::Near ? kBack : kThere} {}
  void send(std::uint32_t number) { memory_[out_] = number; }
  [[nodiscard]] bool arrived(std::uint32_t number) const { return memory_[in_] == number; }

 private:
  volatile unsigned* memory_;
  unsigned out_, in_;
};

bench::Times round_trips(const Request& request) {
  const std::string ring = "bench_vendor_" + std::to_string(getpid());
  setenv("RTHS_SCRAMNET_RING", ring.c_str(), 1);
  const auto remove_ring = [](const std::string* name) { broker::remove_ring(*name); };
  const std::unique_ptr<const std::string, decltype(remove_ring)> removal{&ring, remove_ring};
  return bench::round_trips(request.setup, [](bench::Side side) { return PointerEnd{side}; });
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  return rths::peers::run_peer(argc, argv, {{"round_trips", rths::peers::round_trips}});
}
