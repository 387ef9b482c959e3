// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <rths/core/config.hpp>
#include <rths/replicated/ring.hpp>

namespace rths::replicated {

/// Something that a host or a fault does to a node at a time.
struct Action {
  enum class Kind {
    Write,         ///< store of `value` at longword `index`
    Csr,           ///< write of `value` to register `index`
    Interrupt,     ///< broadcast interrupt `index` with `value`; GT only
    PowerOff,      ///< the node is out of the ring and loses its state
    PowerOn,       ///< with the state after power-up
    CutFibre,      ///< behind the node
    RepairFibre,   ///<
    BitErrorRate,  ///< of all fibres: `rate`
    Delay,         ///< additional delay of the node: `delay`
    Id             ///< sends and receives with id `value`
  };
  Time at{0};
  Kind kind = Kind::Write;
  std::uint32_t node = 0, index = 0, value = 0;
  double rate = 0;
  Time delay{0};
};

/// Does an action to a ring, at its present time.
void act(Ring& ring, const Action& action);

/// Reads kind, node and value of a fault. @param names  of the nodes, by position
/// @throws Error naming the place of a mistake   @setup
[[nodiscard]] Action read_fault(const Config& table, const std::vector<std::string>& names);
/// CSR2 of the protocol that a table names; default "burst".
/// @throws Error naming the place of a mistake   @setup
[[nodiscard]] std::uint32_t read_protocol(const Config& table);

/// A host that stores periodically, and repeats a store that is held off.
struct Traffic {
  std::uint32_t node = 0;
  Time from{0}, until{0}, period{0};
  std::uint32_t longword = 0, longwords = 1;  ///< range that it writes
  bool random = false;                        ///< order of the longwords
};

/// A test of a ring in virtual time.
struct Scenario {
  RingSetup setup;
  std::vector<std::string> names;  ///< of the nodes
  std::vector<Action> actions;     ///< in the order of time; those at time 0 set the cards up
  std::vector<Traffic> traffic;
  Time duration{0};
};

/// Reads a scenario from a TOML file.
/// @throws Error naming the place of a mistake   @setup
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file);

/// The course of a scenario: the ring, and the hosts that act on it.
class Course {
 public:
  explicit Course(Scenario scenario);
  [[nodiscard]] Ring& ring() { return ring_; }
  [[nodiscard]] const Scenario& scenario() const { return scenario_; }
  /// Advances to a time; processes what happens until then, including that time.
  void run_until(Time time);
  /// Number of stores of the traffic so far that were held off at first.
  [[nodiscard]] std::uint64_t stalls() const { return stalls_; }

 private:
  struct Host {
    Time next{0};
    std::uint32_t stored = 0;
    bool held_off = false;
    std::mt19937 random;
    std::uint32_t index = 0;
  };
  void store(const Traffic& traffic, Host& host);

  Scenario scenario_;
  Ring ring_;
  std::vector<Host> hosts_;  ///< one for each traffic
  std::size_t next_action_ = 0;
  std::uint64_t stalls_ = 0;
};

/// Every hop of a scenario as Chrome trace events (JSON), which chrome://tracing and Perfetto show.
[[nodiscard]] std::string trace_of(const Scenario& scenario);
/// Ring, nodes, registers in words, FIFOs and ages at the present time.
[[nodiscard]] std::string show(Course& course);
/// A line with a register and the names of its set bits: "CSR0 8003  receive, transmit, inserted".
[[nodiscard]] std::string csr_line(int index, std::uint32_t value);

}  // namespace rths::replicated
