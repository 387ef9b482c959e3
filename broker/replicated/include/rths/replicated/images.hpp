// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <rths/broker/ring.hpp>
#include <rths/memmap/map.hpp>
#include <rths/replicated/scenario.hpp>

namespace rths::replicated {

/// A fault of the cards of a running ring.
struct Fault {
  std::string node;  ///< in the map; empty for faults of all fibres
  Action action;     ///< its time counts from `Images::begin`
};

/// Cards of a running ring. All fibres have one length.
struct CardOptions {
  std::uint32_t csr2 = 0xC040;  ///< protocol: BURST
  double fibre_m = 10;          ///< from node to node [m]
  bool strict_ids = false;      ///< see RingSetup
  double bit_error_rate = 0;    ///< of each fibre [-]
  std::uint64_t seed = 1;       ///< of the bit errors
  std::vector<Fault> faults;    ///< in the order of time
};

/// Reads the cards of a ring and their faults: the tables [cards] and [[fault]] of an experiment.
/// @param names  of the nodes, for the faults
/// @throws Error naming the place of a mistake   @setup
[[nodiscard]] CardOptions read_cards(const Config& cards, const std::vector<Config>& faults,
                                     const std::vector<std::string>& names);

/// Name of a node's image, for `broker::Ring::attach`. The operator, and programs that only read,
/// use the image with the name of the ring.
[[nodiscard]] std::string image_name(const std::string& ring, const std::string& node);

/// Asks the cards of a running ring for a fault, and waits until it has happened.
/// @param fault  its node by position in the map
/// @throws Error if there is no such ring, or it is shared, or its cards do not answer   @setup
void request_fault(const std::string& ring, const Action& fault);

/// A ring with one memory image per node. Each image is a ring of its own, on which only this node
/// writes. Cards carry its writes to the other images with their own timing; there they are writes
/// of this node, in its order, and wake those who wait for them.
///
/// A tear group changes when its last word has arrived. A node is on the other images from its
/// first message until it leaves its own; its heartbeats there are its messages. One thread.
class Images {
 public:
  /// Images in private memory of this process.   @setup
  [[nodiscard]] static Images in_process(const memmap::Map& map, const CardOptions& options);
  /// Images in shared memory, for other processes. The destructor removes their names.
  /// @throws Error as `broker::Ring::create`   @setup
  [[nodiscard]] static Images create(const std::string& ring, const memmap::Map& map,
                                     const CardOptions& options);
  Images(Images&&) noexcept;
  ~Images();

  /// The image of a node.
  [[nodiscard]] broker::Ring& of(const std::string& node);
  /// Advances the cards to a time, then takes the writes that the nodes have made meanwhile.
  void advance(Time now);
  /// Sets the time from which the faults count; the default is 0.
  void begin(Time origin);
  /// Lines about faults so far, with their times since `begin`.
  [[nodiscard]] const std::vector<std::string>& events() const;
  /// Number of writes that waited because a transmit FIFO was full.
  [[nodiscard]] std::uint64_t stalls() const;

 private:
  struct State;
  explicit Images(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace rths::replicated
