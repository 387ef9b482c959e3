// SPDX-License-Identifier: Apache-2.0
#include "tiny_recording.hpp"

#include <set>

#include <fmt/format.h>

namespace rths::report {
namespace {

constexpr int kAlignment = 16;  // of the partitions [longwords]

// Each word has a partition's name in common with others, so a partition is written once.
memmap::Map map_of(const std::vector<TinyWord>& words) {
  std::set<std::string> nodes, partitions;
  for (const auto& word : words) nodes.insert(word.node);
  std::string text =
      "ringmap = 1\n[ring]\nname = \"tiny\"\nversion = 1\nsize_bytes = 4096\n[nodes]\n";
  int id = 0;
  for (const auto& node : nodes) text += fmt::format("{} = {}\n", node, ++id);
  int offset = 0;
  for (const auto& first : words) {
    if (!partitions.insert(first.partition).second) continue;
    std::string signals;
    int count = 0;
    for (const auto& word : words)
      if (word.partition == first.partition)
        signals += fmt::format("[[partition.signal]]\nname = \"{}\"\noffset = {}\ntype = \"f32\"\n",
                               word.signal, offset + count++);
    text +=
        fmt::format("[[partition]]\nname = \"{}\"\nnode = \"{}\"\noffset = {}\nlongwords = {}\n{}",
                    first.partition, first.node, offset, count, signals);
    offset += (count / kAlignment + 1) * kAlignment;
  }
  return memmap::parse_map(text, "tiny");
}

}  // namespace

void TinyRecording::write(const std::filesystem::path& file) const {
  const memmap::Map map = map_of(words);
  recording::RecordingInfo info{{}, {{"ending", ending}, {"clock", "virtual"}}, {}};
  if (!experiment.empty()) {
    info.meta.emplace_back("experiment", "tiny.toml");
    info.config.emplace_back("tiny.toml", experiment);
  }
  if (!specimen.empty()) info.config.emplace_back(recording::kSpecimenText, specimen);
  std::vector<SignalId> signals;
  for (const auto& word : words) signals.push_back(map.signal(word.partition + "." + word.signal));
  recording::Writer writer{file, map, signals, info};
  std::vector<double> row(words.size());
  for (int i = 0; i < rows; ++i) {
    const double time = i * interval;
    for (std::size_t k = 0; k < words.size(); ++k) row[k] = words[k].value(time);
    writer.append(from_seconds(time), row);
  }
  writer.close();
}

}  // namespace rths::report
