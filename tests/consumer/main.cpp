// SPDX-License-Identifier: Apache-2.0
#include <cstdint>
#include <cstdio>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/controller/predictor_corrector.hpp>
#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/launch/run.hpp>
#include <rths/memmap/codec.hpp>
#include <rths/report/report.hpp>
#include <rths/sim/bearing.hpp>

// Writes a bearing's force to a ring, using only installed headers and libraries.
int main(int argc, char** argv) {
  if (argc < 2) return 3;
  try {
    const auto map = rths::memmap::load_map(argv[1]);
    auto ring = rths::broker::Ring::in_process(map);
    auto machine = ring.join("srmd", map.hash());
    const auto lead_rubber = rths::Config::parse(
        "[bouc_wen]\ncharacteristic_strength_N = 1e6\npost_yield_stiffness_N_per_m = 4e6\n", "lrb");
    rths::sim::BearingRun bearing{rths::sim::read_bearing(lead_rubber, 9.7e6), 0.001};
    const auto force = bearing.advance({0.1, 0.0}, {0.0, 0.0}, 9.7e6);
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
