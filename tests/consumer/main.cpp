// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdio>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/core/error.hpp>
#include <rths/launch/run.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/report/report.hpp>
#include <rths/sim/lead_rubber.hpp>

// Puts a bearing's force on a ring, with nothing but installed headers and libraries.
int main(int argc, char** argv) {
  if (argc < 2) return 3;
  try {
    const auto map = rths::memmap::load_map(argv[1]);
    auto ring = rths::broker::Ring::in_process(map);
    auto machine = ring.join("srmd", map.hash());
    rths::sim::LeadRubberState state;
    const auto force = advance(rths::sim::LeadRubber{}, state, {0.1, 0.0});
    const auto& entry = map.entry(map.signal("srmd.long.force.fbk"));
    const rths::memmap::Codec codec{*entry.signal};
    std::vector<std::uint32_t> words(entry.partition->longwords);
    words[entry.signal->offset.value() - entry.partition->base.value()] = codec.encode(force[0]);
    if (machine.write_group(ring.tear_group("srmd"), words) != rths::Status::Ok) return 1;
    const double back = codec.decode(machine.read(entry.signal->offset));
    std::printf("%.0f N\n", back);
    return back > 1e6 ? 0 : 1;
  } catch (const rths::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
