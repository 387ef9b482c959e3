// SPDX-License-Identifier: Apache-2.0
//
// The algorithm of iceoryx2's blackboard, reimplemented: two cells and a counter of writes. The
// writer fills the inactive cell and increments the counter. A reader copies the active cell and
// checks by a compare-exchange that the counter is unchanged. So every read also writes: readers
// need writable memory and take the counter's cache line from the writer.
#include <atomic>
#include <cstddef>
#include <vector>

#include <rths/bench/write_cost.hpp>
#include <rths/core/error.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr std::uint32_t kLargest = 1024;  // [bytes]

/// One value, packed as in iceoryx2: counter and cells share lines.
struct Board {
  std::atomic<std::uint64_t> write_cell{1};  ///< the next cell to write is this modulo 2
  std::byte cells[2 * kLargest] = {};
};

struct Boards {
  alignas(128) Board near;
  alignas(128) Board far;
};

void store(Board& board, const void* value, std::size_t bytes) {
  const std::uint64_t count = board.write_cell.load(std::memory_order_relaxed);
  std::memcpy(board.cells + count % 2 * bytes, value, bytes);
  board.write_cell.fetch_add(1, std::memory_order_release);
}

// Tries once; false if the writer interfered.
bool load(Board& board, void* value, std::size_t bytes) {
  std::uint64_t count = board.write_cell.load(std::memory_order_acquire);
  std::memcpy(value, board.cells + (count - 1) % 2 * bytes, bytes);
  return board.write_cell.compare_exchange_strong(count, count, std::memory_order_seq_cst,
                                                  std::memory_order_relaxed);
}

class BoardEnd {
 public:
  BoardEnd(Boards& boards, bench::Side side, std::uint32_t bytes)
      : out_{side == bench::Side::Near ? boards.near : boards.far},
        in_{side == bench::Side::Near ? boards.far : boards.near},
        sent_(bytes),
        received_(bytes) {}
  void send(std::uint32_t number) {
    fill(number);
    write();
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    return load(in_, received_.data(), received_.size()) &&
           number_of(received_.data(), received_.size()) == number;
  }
  void fill(std::uint32_t number) { mark(sent_.data(), sent_.size(), number); }
  void write() { store(out_, sent_.data(), sent_.size()); }
  void read() { static_cast<void>(load(in_, received_.data(), received_.size())); }

 private:
  Board& out_;
  Board& in_;
  std::vector<std::byte> sent_, received_;
};

template <class Measure>
bench::Times with_boards(const Request& request, Measure measure) {
  if (request.bytes > kLargest) throw Error{"expected up to 1024 bytes"};
  const bench::Shared<Boards> boards;
  return measure(request.setup, [&](bench::Side side) {
    return BoardEnd{*boards, side, request.bytes};
  });
}

bench::Times round_trips(const Request& request) {
  return with_boards(request, [](const bench::Setup& setup, auto make_end) {
    return bench::round_trips(setup, make_end);
  });
}

template <std::uint32_t gap>
bench::Times writes(const Request& request) {
  return with_boards(request, [](const bench::Setup& setup, auto make_end) {
    return bench::write_times_under_reader(setup, gap, make_end);
  });
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  using namespace rths::peers;
  return run_peer(argc, argv,
                  {{"round_trips", round_trips},
                   {"writes_each_200", writes<200>},
                   {"writes_each_1000", writes<1000>}});
}
