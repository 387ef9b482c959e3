// SPDX-License-Identifier: Apache-2.0
#include "ring_of_clients.hpp"

#include <unistd.h>

#include <fmt/format.h>

#include <rths/broker/detail/shared_object.hpp>
#include <rths/core/error.hpp>
#include <rths/memmap/map.hpp>

#include "warning.hpp"

namespace rths::scramnet {
namespace {

// A map must have a node. This map has no partitions, so any client may write its words.
memmap::Map plain_map(const Settings& settings) {
  memmap::MapDescription description;
  description.name = "plain";
  description.size_longwords = static_cast<std::uint32_t>(settings.ring_bytes / 4);
  description.nodes = {{"client", NodeId{0}, ""}};
  return memmap::Map{description};
}

bool exists(const std::string& ring) {
  return access(broker::object_path(ring).c_str(), F_OK) == 0;
}

void announce_plain_ring(const Settings& settings) {
  warn_once("map",
            fmt::format("made ring '{}' without a map; to join a run of this name, start the "
                        "run first; {}MAP gives a new ring a map",
                        settings.ring, settings.variables)
                .c_str());
}

}  // namespace

broker::Ring attach_or_make(const Settings& settings) {
  constexpr int kMostOpens = 3;  // another process may create or remove the ring meanwhile
  for (int attempt = 1;; ++attempt) {
    try {
      if (!exists(settings.ring)) {
        const auto map =
            settings.map.empty() ? plain_map(settings) : memmap::load_map(settings.map);
        const auto made = broker::Ring::create_new(settings.ring, map);
        if (settings.map.empty() && settings.ring_is_chosen) announce_plain_ring(settings);
      }
      return broker::Ring::attach(settings.ring);
    } catch (const Error&) {
      if (attempt == kMostOpens) throw;
    }
  }
}

}  // namespace rths::scramnet
