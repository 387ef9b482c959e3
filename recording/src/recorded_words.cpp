// SPDX-License-Identifier: Apache-2.0
#include <rths/recording/recorded_words.hpp>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/memmap/codec.hpp>

namespace rths::recording {
namespace {

// Rows without a number before the first one have the initial value of the map.
std::vector<std::uint32_t> encoded(const memmap::Signal& signal,
                                   const std::vector<double>& values) {
  const memmap::Codec codec{signal};
  std::vector<std::uint32_t> words;
  words.reserve(values.size());
  std::uint32_t last = codec.encode(codec.to_si(signal.initial));
  for (const double value : values) {
    if (!std::isnan(value)) last = codec.encode(value);
    words.push_back(last);
  }
  return words;
}

bool are_whole(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(),
                     [](double value) { return std::isnan(value) || value == std::round(value); });
}

// What a reader has of a word after the fault: nothing newer than the row it returns.
void drop(std::size_t first, std::size_t end, std::vector<std::uint32_t>& words) {
  for (std::size_t row = std::max<std::size_t>(first, 1); row < end; ++row)
    words[row] = words[row - 1];
}

void flip(std::size_t first, std::size_t end, int bit, std::vector<std::uint32_t>& words) {
  for (std::size_t row = first; row < end; ++row) words[row] ^= std::uint32_t{1} << bit;
}

void delay(const std::vector<double>& time, std::size_t first, std::size_t end, double by,
           std::vector<std::uint32_t>& words) {
  const std::vector<std::uint32_t> sent = words;
  std::size_t arrived = 0;
  for (std::size_t row = first; row < end; ++row) {
    while (arrived + 1 < time.size() && time[arrived + 1] <= time[row] - by) ++arrived;
    // Writes before the fault had no delay.
    words[row] = sent[std::max(arrived, first == 0 ? 0 : first - 1)];
  }
}

}  // namespace

std::vector<RecordedWord> words_of(const Reader& run, const std::string& node) {
  static_cast<void>(run.map().node(node));
  if (run.rows() == 0) throw Error{"the recording has no rows"};
  std::vector<RecordedWord> measured, whole;
  for (const auto& entry : run.map().signals()) {
    if (entry.partition->node != node || !run.has(entry.name)) continue;
    const auto values = run.signal(entry.name);
    (are_whole(values) ? whole : measured).push_back({entry, encoded(*entry.signal, values)});
  }
  measured.insert(measured.end(), std::make_move_iterator(whole.begin()),
                  std::make_move_iterator(whole.end()));
  if (measured.empty()) throw Error{fmt::format("the recording has no word of node '{}'", node)};
  return measured;
}

void apply(const MessageFault& fault, const std::vector<double>& time,
           std::vector<RecordedWord>& words) {
  const auto row_at = [&](double t) {
    return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), t) - time.begin());
  };
  const std::size_t first = row_at(fault.at),
                    end = fault.lasting ? row_at(fault.at + *fault.lasting) : time.size();
  for (auto& word : words) {
    if (!fault.signal.empty() && word.entry.name != fault.signal) continue;
    if (fault.kind == "drop") drop(first, end, word.words);
    if (fault.kind == "flip") flip(first, end, fault.bit, word.words);
    if (fault.kind == "delay") delay(time, first, end, fault.delay, word.words);
  }
}

}  // namespace rths::recording
