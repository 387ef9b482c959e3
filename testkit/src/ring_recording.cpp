// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>

#include <fmt/format.h>

#include <rths/broker/ring.hpp>
#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/testkit/play.hpp>

#include "recorder.hpp"

namespace rths::testkit {
namespace {

constexpr Duration kDrain = std::chrono::milliseconds{20};
constexpr int kDrainsPerLook = 10;  // at whether the ring is gone

// Another ring may have its name.
bool is_gone(const std::string& ring, int pid) {
  const auto report = broker::inspect_ring(ring);
  return !report || std::none_of(report->occupants.begin(), report->occupants.end(),
                                 [&](const auto& occupant) { return occupant.pid == pid; });
}

}  // namespace

RingRecording record_ring(const std::string& ring, const std::filesystem::path& file, double row,
                          const std::function<bool()>& ends) {
  if (std::filesystem::exists(file))
    throw Error{file.string() + ": exists already, expected a new file"};
  WriteRecorder recorder{ring};
  RowWriter writer{file, recorder.ring(), recorder.first(), from_seconds(row)};
  RingRecording result;
  const auto drain = [&] {
    const auto changes = recorder.taken();
    result.writes += changes.size();
    writer.add(changes);
  };
  WallClock clock;
  for (int i = 1; !ends(); ++i) {
    clock.sleep_until(clock.now() + kDrain);
    drain();
    if (i % kDrainsPerLook == 0 && is_gone(ring, getpid())) break;
  }
  recorder.end();
  drain();
  result.missing = recorder.missing();
  result.foreign_store = recorder.foreign_log().first();
  writer.close(result.missing);
  recording::compress(file);
  result.rows = writer.rows();
  return result;
}

}  // namespace rths::testkit
