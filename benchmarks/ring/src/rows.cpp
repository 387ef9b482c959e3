// SPDX-License-Identifier: Apache-2.0
//
// The table of rows. A new row is an entry here and a small function that measures it.
#include <rths/bench/rows.hpp>

#include <algorithm>

#include <fmt/format.h>

#include "peer_rows.hpp"
#include "ring_rows.hpp"

namespace rths::bench {
namespace {

using enum Quantity;

// The tail gate of all data that fits one or two cache lines.
constexpr Gate kTail{1.25, 1.6};

Peer program(const std::string& name) { return {"rths_peer_" + name, ""}; }

std::vector<Row> own_rows() {
  return {
      {"raw", 4, "a cache line there and back; against itself", measure_raw},
      {"raw_pause", 4, "the same, pausing while waiting", measure_raw_paused},
      {"vendor_store", 4, "a word stored and loaded through the vendor's pointer", measure_peer,
       RatioToRaw, Gate{1.05, 1.15}, std::nullopt, program("vendor")},
      {"word", 4, "write a word, read it", measure_word, RatioToRaw, Gate{1.05, 1.15}, kTail},
      {"word_pause", 4, "the same, pausing while waiting", measure_word_paused, RatioToRaw,
       Gate{0.95, 1.10}, kTail},
      {"any_word", 4, "write one of many words, find it through the journal", measure_any_word,
       RatioToRaw, Gate{1.05, 1.20}, kTail},
      {"any_word_pause", 4, "the same, pausing while waiting", measure_any_word_paused, RatioToRaw,
       Gate{0.95, 1.10}, kTail},
      {"latch_28", 28, "a group of two copies in one line, read whole", measure_group, RatioToRaw,
       Gate{1.10, 1.25}, kTail},
      {"record_60", 60, "a group of one line, read whole", measure_group, RatioToRaw,
       Gate{1.05, 1.25}, kTail},
      {"group_64", 64, "a group in a pair of lines, read whole", measure_group, RatioToRaw,
       Gate{1.15, 1.4}},
      {"group_256", 256, "a group of five lines, read whole", measure_group, RatioToRaw,
       Gate{1.6, 1.9}},
      {"group_1024", 1024, "a group of 17 lines, read whole", measure_group, RatioToRaw,
       Gate{2.4, 2.8}},
      {"wait_spinning", 4, "wait for a word, spinning", measure_wait_spinning, RatioToRaw,
       Gate{1.05, 1.2}},
      {"wait_sleeping", 4, "wait for a word, sleeping; against a bare futex", measure_wait_sleeping,
       RatioToOther, Gate{1.15, 1.4}},
      {"write_cost", 4, "write a word without readers; extra time over a plain store [ns]",
       measure_write_cost, ExtraTime, Gate{1.0, 2.5}},
      {"write_under_reader_1000", 56,
       "write a record every 1000 ns under a reader; against blackboard",
       measure_write_under_reader_1000, TimesCheaper, Gate{15, 8}, std::nullopt,
       program("blackboard")},
      {"write_under_reader_200", 56, "the same, every 200 ns", measure_write_under_reader_200,
       TimesCheaper, Gate{15, 8}, std::nullopt, program("blackboard")},
      {"journal_follow", 4, "write words to a follower that loses none; time of a word [ns]",
       measure_journal_follow, Time, Gate{20, 50}},
      {"queue_throughput", 8, "a stream of words through a journal; against spsc_queue",
       measure_queue_throughput, TimesCheaper, Gate{2, 1.3}, std::nullopt, program("spsc_queue")},
  };
}

// The limit is 0.7 of the goal, but at least 0.93, a tie less the noise of a median.
constexpr Gate ahead(double goal) { return {goal, std::max(0.7 * goal, 0.93)}; }

Row peer(const std::string& name, std::uint32_t bytes, const std::string& description,
         const std::string& against, std::optional<Gate> gate) {
  return {fmt::format("{}_{}", name, bytes),
          bytes,
          description,
          measure_peer,
          TimesOurs,
          gate,
          std::nullopt,
          Peer{"rths_peer_" + name, against}};
}

std::vector<Row> peer_rows() {
  const std::string iceoryx = "iceoryx 2.0.3, polled";
  const std::string blackboard = "iceoryx2's blackboard algorithm, reimplemented";
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
      peer("cyclone", 64, "Cyclone DDS, waitset, loopback device", "group_64", {}),
  };
}

}  // namespace

std::vector<Row> all_rows() {
  std::vector<Row> rows = own_rows();
  for (Row& row : peer_rows()) rows.push_back(std::move(row));
  return rows;
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
      throw Error{fmt::format("there is no row '{}', expected one of{}", name, known)};
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
