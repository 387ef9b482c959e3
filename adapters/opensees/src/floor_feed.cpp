// SPDX-License-Identifier: Apache-2.0
#include "floor_feed.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::adapters {

FloorFeed::FloorFeed(std::size_t floors) : step_(kFirst + 2 * floors), next_(step_.size()) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC | O_NONBLOCK) != 0)
    throw Error{fmt::format("there is no pipe for the floors: {}", std::strerror(errno))};
  reading_ = ends[0];
  writing_ = ends[1];
}

FloorFeed::~FloorFeed() {
  close_writing_end();
  close(reading_);
}

void FloorFeed::close_writing_end() {
  if (writing_ >= 0) close(writing_);
  writing_ = -1;
}

void FloorFeed::receive() {
  const auto bytes = std::as_writable_bytes(std::span{next_});
  for (;;) {
    const auto left = bytes.subspan(filled_);
    const ssize_t got = read(reading_, left.data(), left.size());
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return;
    filled_ += static_cast<std::size_t>(got);
    if (filled_ < bytes.size()) continue;
    step_ = next_;
    filled_ = 0;
  }
}

}  // namespace rths::adapters
