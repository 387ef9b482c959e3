// SPDX-License-Identifier: Apache-2.0
#include "node_words.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <xxhash.h>

#include <rths/core/error.hpp>

#include "frame.hpp"

namespace rths::dds {
namespace {

constexpr std::size_t kLargestGroup = kLargestFrame / 4 - 64;  // [longwords]; one frame holds it

}  // namespace

NodeWords::NodeWords(const broker::Ring& ring, const std::string& node) {
  for (const auto& partition : ring.map().partitions()) {
    if (partition.node != node) continue;
    any_latest_ = any_latest_ || partition.latest;
    if (!partition.tear_group) {
      words_.push_back({partition.base, partition.longwords, partition.latest});
      continue;
    }
    if (partition.longwords > kLargestGroup)
      throw Error{
          fmt::format("partition '{}' has {} longwords; a tear group that crosses hosts "
                      "has at most {}",
                      partition.name, partition.longwords, kLargestGroup)};
    groups_.push_back(
        {ring.tear_group(partition.name), partition.base, partition.longwords, partition.latest});
  }
}

void NodeWords::visit(
    const broker::Node& reader,
    const std::function<void(LongwordOffset, std::span<const std::uint32_t>)>& run,
    const std::function<void(const Group&, std::span<const std::uint32_t>)>& group) const {
  std::vector<std::uint32_t> values;
  for (const auto& range : words_)
    for (std::uint32_t begin = 0; begin < range.longwords; begin += kLongestRun) {
      values.resize(std::min(kLongestRun, range.longwords - begin));
      const auto base = advance(range.base, begin);
      for (std::uint32_t i = 0; i < values.size(); ++i) values[i] = reader.read(advance(base, i));
      run(base, values);
    }
  for (const auto& one : groups_) {
    values.resize(one.longwords);
    if (reader.read_group(one.id, values) == Status::Ok) group(one, values);
  }
}

std::optional<std::uint64_t> NodeWords::hash(const broker::Node& reader) const {
  std::vector<std::uint32_t> all;
  std::size_t groups = 0;
  visit(
      reader,
      [&](LongwordOffset, std::span<const std::uint32_t> values) {
        all.insert(all.end(), values.begin(), values.end());
      },
      [&](const Group&, std::span<const std::uint32_t> values) {
        all.insert(all.end(), values.begin(), values.end());
        ++groups;
      });
  if (groups != groups_.size()) return std::nullopt;
  return XXH3_64bits(all.data(), 4 * all.size());
}

const NodeWords::Group* NodeWords::group_from(LongwordOffset base) const {
  const auto found = std::find_if(groups_.begin(), groups_.end(),
                                  [&](const Group& group) { return group.base == base; });
  return found == groups_.end() ? nullptr : &*found;
}

const NodeWords::Group* NodeWords::group_at(LongwordOffset base, std::size_t longwords) const {
  const Group* const group = group_from(base);
  return group != nullptr && group->longwords == longwords ? group : nullptr;
}

const NodeWords::Group* NodeWords::group_with(LongwordOffset word) const {
  const auto found = std::find_if(groups_.begin(), groups_.end(), [&](const Group& group) {
    return word >= group.base && word < advance(group.base, group.longwords);
  });
  return found == groups_.end() ? nullptr : &*found;
}

bool NodeWords::is_latest(LongwordOffset word) const {
  if (!any_latest_) return false;
  const auto has = [&](const auto& range) {
    return range.latest && word >= range.base && word < advance(range.base, range.longwords);
  };
  return std::any_of(words_.begin(), words_.end(), has) ||
         std::any_of(groups_.begin(), groups_.end(), has);
}

}  // namespace rths::dds
