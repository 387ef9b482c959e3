// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>

namespace rths::dds {

/// The words that one node may write: single words, and tear groups.
class NodeWords {
 public:
  struct Group {
    TearGroupId id;
    LongwordOffset base;
    std::uint32_t longwords;
    bool latest;  ///< other hosts get its newest values, not each write
  };
  NodeWords(const broker::Ring& ring, const std::string& node);

  /// Visits the present values of all words, in runs of at most `kLongestRun`, and of all groups. A
  /// group that its writer keeps changing is left out; its next write brings it.
  static constexpr std::uint32_t kLongestRun = 4096;
  void visit(const broker::Node& reader,
             const std::function<void(LongwordOffset, std::span<const std::uint32_t>)>& run,
             const std::function<void(const Group&, std::span<const std::uint32_t>)>& group) const;
  /// Hash of all values; empty while a group is being written.
  [[nodiscard]] std::optional<std::uint64_t> hash(const broker::Node& reader) const;
  /// The group that begins at this word and has this length; null if none.
  [[nodiscard]] const Group* group_at(LongwordOffset base, std::size_t longwords) const;
  /// The group that begins at this word; null if none.
  [[nodiscard]] const Group* group_from(LongwordOffset base) const;
  /// The group that has this word; null if none.
  [[nodiscard]] const Group* group_with(LongwordOffset word) const;
  /// True if other hosts get only the newest values of this word.
  [[nodiscard]] bool is_latest(LongwordOffset word) const;

 private:
  struct Range {
    LongwordOffset base;
    std::uint32_t longwords;
    bool latest;
  };
  std::vector<Range> words_;
  std::vector<Group> groups_;
  bool any_latest_ = false;
};

}  // namespace rths::dds
