// SPDX-License-Identifier: Apache-2.0
//
// The table. A new row is an entry here and a small function that measures it.
#include <rths/bench/rows.hpp>

#include <algorithm>

#include <fmt/format.h>

#include "peer_rows.hpp"
#include "ring_rows.hpp"

namespace rths::bench {
namespace {

using enum Quantity;

// The tail of everything that fits a line or two.
constexpr Gate kTail{1.25, 1.6};

std::vector<Row> own_rows() {
  return {
      {"raw", 4, "a cache line to and fro; against itself", measure_raw},
      {"raw_pause", 4, "the same, pausing while it waits", measure_raw_paused},
      {"word", 4, "write a word, see it", measure_word, RatioToRaw, Gate{1.05, 1.15}, kTail},
      {"word_pause", 4, "the same, pausing while it waits", measure_word_paused, RatioToRaw,
       Gate{0.95, 1.10}, kTail},
      {"record_60", 60, "a record of one line, read whole", measure_group, RatioToRaw,
       Gate{1.05, 1.25}, kTail},
      {"group_64", 64, "a tear group with its sequence beside the memory", measure_group,
       RatioToRaw, Gate{1.3, 1.6}},
      {"group_256", 256, "the same", measure_group, RatioToRaw, Gate{1.6, 1.9}},
      {"group_1024", 1024, "the same", measure_group, RatioToRaw, Gate{2.4, 2.8}},
      {"write_cost", 4, "write a word, nobody reading; over a plain store [ns]", measure_write_cost,
       ExtraTime, Gate{1.0, 2.5}},
      {"write_under_reader", 56, "write a record that is read all the time; against blackboard",
       measure_write_under_reader, TimesCheaper, Gate{15, 8}, std::nullopt,
       Peer{"rths_peer_blackboard", ""}},
  };
}

// Seven tenths of what is aimed at; of a tie, what the noise of a median leaves of it.
constexpr Gate ahead(double goal) { return {goal, std::max(0.7 * goal, 0.93)}; }

Row peer(const std::string& name, std::uint32_t bytes, const std::string& what,
         const std::string& against, std::optional<Gate> gate) {
  return {
      fmt::format("{}_{}", name, bytes), bytes, what, measure_peer, TimesOurs, gate, std::nullopt,
      Peer{"rths_peer_" + name, against}};
}

std::vector<Row> peer_rows() {
  const std::string iceoryx = "iceoryx 2.0.3, polled";
  const std::string blackboard = "iceoryx2's blackboard algorithm, restated";
  const std::string spsc = "boost::lockfree::spsc_queue";
  const std::string queue = "Boost.Interprocess message_queue, polled";
  return {
      peer("iceoryx", 4, iceoryx, "word", ahead(8)),
      peer("iceoryx", 64, iceoryx, "group_64", ahead(8)),
      peer("iceoryx", 1024, iceoryx, "group_1024", ahead(4)),
      peer("blackboard", 4, blackboard, "word", ahead(1)),
      peer("blackboard", 64, blackboard, "group_64", ahead(2.5)),
      peer("blackboard", 1024, blackboard, "group_1024", ahead(1.1)),
      peer("spsc_queue", 8, spsc, "word", ahead(1.4)),
      peer("spsc_queue", 64, spsc, "group_64", ahead(1.4)),
      peer("message_queue", 8, queue, "word", ahead(8)),
      peer("message_queue", 64, queue, "group_64", ahead(8)),
      peer("zeromq", 64, "ZeroMQ PAIR over ipc, sleeping", "group_64", {}),
      peer("cyclone", 64, "Cyclone DDS, waitset, this host only", "group_64", {}),
  };
}

}  // namespace

std::vector<Row> all_rows() {
  std::vector<Row> rows = own_rows();
  for (Row& row : peer_rows()) rows.push_back(std::move(row));
  return rows;
}

std::vector<UnmeasuredRow> rows_not_measured_yet() {
  return {
      {"any_word", "notice that some word changed, without looking at it: needs journals"},
      {"any_word_pause", "the same, pausing while it waits"},
      {"latch_28", "28 bytes with two copies in a line: needs latches"},
      {"journal_follow", "follow 50 million writes a second without loss: needs journals"},
      {"queue_throughput", "messages of 8 bytes a second, against queues: needs journals"},
      {"wait_spinning", "spin, then sleep, woken while spinning: needs waiting"},
      {"wait_sleeping", "the same, woken from sleep, against a bare futex: needs waiting"},
  };
}

std::vector<Row> select_rows(const std::vector<std::string>& names) {
  std::vector<Row> rows = all_rows();
  std::vector<std::string> wanted = names;
  for (const auto& name : names) {
    const auto row = std::find_if(rows.begin(), rows.end(),
                                  [&](const Row& candidate) { return candidate.name == name; });
    if (row == rows.end()) {
      std::string known;
      for (const Row& candidate : rows) known += " " + candidate.name;
      throw Error{fmt::format("there is no row '{}'; there are{}", name, known)};
    }
    if (row->peer) wanted.push_back(row->peer->against);
  }
  if (!names.empty())
    std::erase_if(rows, [&](const Row& row) {
      return std::find(wanted.begin(), wanted.end(), row.name) == wanted.end();
    });
  return rows;
}

}  // namespace rths::bench
