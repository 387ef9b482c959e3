// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <rths/core/ids.hpp>

namespace rths::memmap {

/// Version of the map file format. Incremented when a valid file would change its meaning or no
/// longer load.
inline constexpr int kMapFormat = 1;

/// Type of the 32 bits of a longword.
enum class WordType : std::uint8_t { I32, U32, F32 };

[[nodiscard]] const char* to_text(WordType type) noexcept;

/// One longword with a name, a type and a unit. Its full name is "<partition>.<name>".
struct Signal {
  std::string name;                                ///< dotted, without the partition's name
  LongwordOffset offset;                           ///< in the ring's memory
  WordType type = WordType::F32;                   ///< type of the 32 bits
  std::string unit = "1";                          ///< as UDUNITS spells it
  std::optional<std::pair<double, double>> range;  ///< lowest and highest value [unit]
  double initial = 0;                              ///< value when the ring is created [unit]
  std::vector<std::pair<std::string, std::int64_t>> values;  ///< names of an integer's values
  bool interrupt = false;                                    ///< a write raises a network interrupt
  bool event = false;  ///< a change is listed in a run's events
  std::string where;   ///< position in the file, for messages
};

/// A run of consecutive longwords that exactly one node may write.
///
/// With one writer per longword the ring needs no locks: readers and writers never wait.
/// @invariant [base, base + longwords) lies inside the map and overlaps no other partition
struct Partition {
  std::string name;
  std::string node;  ///< the writer
  LongwordOffset base;
  std::uint32_t longwords = 0;
  bool tear_group = false;      ///< always read and written whole
  bool latest = false;          ///< other hosts get its newest values, not each write
  std::vector<Signal> signals;  ///< in order of offset
  std::string where;
};

/// A member of the ring.
struct MapNode {
  std::string name;
  NodeId id;
  std::string where;
};

/// Content of a map file, not yet checked.
struct MapDescription {
  std::string name;
  std::uint32_t version = 1;  ///< of this map: incremented with every change of its layout
  std::uint32_t size_longwords = 0;
  std::vector<MapNode> nodes;
  std::vector<Partition> partitions;
  std::string where;  ///< position in the file, for messages
};

/// A signal and its partition.
struct SignalEntry {
  std::string name;  ///< full: "srmd.long.displ.fbk"
  const Signal* signal;
  const Partition* partition;
};

/// The meaning of every word of a ring: a checked memory map, constant after construction.
class Map {
 public:
  /// @throws Error "file:line:column: …", a line for each rule that the description breaks   @setup
  explicit Map(MapDescription description);
  Map(const Map& other) : Map(other.description_) {}
  Map(Map&&) noexcept = default;
  Map& operator=(const Map&) = delete;
  Map& operator=(Map&&) noexcept = default;
  ~Map() = default;

  [[nodiscard]] const MapDescription& description() const { return description_; }
  [[nodiscard]] const std::vector<Partition>& partitions() const { return description_.partitions; }
  /// All signals, in order of offset.
  [[nodiscard]] const std::vector<SignalEntry>& signals() const { return signals_; }
  /// Their names, in the same order.
  [[nodiscard]] std::vector<std::string> signal_names() const;

  /// @throws Error with the closest known signal
  [[nodiscard]] SignalId signal(const std::string& full_name) const;
  [[nodiscard]] std::optional<SignalId> find_signal(const std::string& full_name) const;
  [[nodiscard]] const SignalEntry& entry(SignalId id) const { return signals_[id.value()]; }
  /// @throws Error with a list of the nodes
  [[nodiscard]] NodeId node(const std::string& name) const;
  /// Name of a node, or its number if the map has no such node.
  [[nodiscard]] std::string node_name(NodeId id) const;
  /// The partition of a longword; null if none.
  [[nodiscard]] const Partition* partition_at(LongwordOffset offset) const;

  /// The map in its canonical spelling, which reads back as the same map.
  [[nodiscard]] std::string to_toml() const;
  /// Hash of the canonical spelling: equal exactly when two maps mean the same.
  [[nodiscard]] std::uint64_t hash() const { return hash_; }

 private:
  MapDescription description_;
  std::vector<SignalEntry> signals_;
  std::unordered_map<std::string, std::uint32_t> by_name_;
  std::uint64_t hash_ = 0;
};

/// Reads and checks a map file.
/// @throws Error "file:line:column: …", a line for each mistake   @setup
[[nodiscard]] Map load_map(const std::filesystem::path& file);
/// The same from text; messages show `name` as the file.
[[nodiscard]] Map parse_map(std::string_view text, const std::string& name);

/// A map's hash as text: sixteen hexadecimal digits.
[[nodiscard]] std::string hash_text(std::uint64_t hash);

}  // namespace rths::memmap
