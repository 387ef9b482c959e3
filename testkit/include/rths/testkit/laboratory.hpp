// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <rths/testkit/expectation.hpp>
#include <rths/testkit/signals.hpp>

namespace rths::testkit {

/// A program of a test. In its arguments, {ring} and {node} are replaced by the names of its ring
/// and its node; its environment has them as RTHS_RING and RTHS_NODE, and for programs of the cards
/// as RTHS_SCRAMNET_… and RTHS_SCGT_….
struct Program {
  std::string node;                  ///< that it plays; empty: none
  std::vector<std::string> command;  ///< program, searched in PATH, and its arguments
  bool is_linked = false;            ///< its messages can be dropped, delayed and damaged
  // NOLINTBEGIN(readability-redundant-member-init): initializers may leave these out
  std::string name = {};              ///< in messages, and of its log; empty: that of the node
  std::filesystem::path folder = {};  ///< in which it runs; empty: the current one
  // NOLINTEND(readability-redundant-member-init)
  double ready_s = 10;  ///< until its node is on the ring [s]
};

/// A ring that no other test sees, and programs on it. The ring is removed and the programs are
/// ended with this object. A thread keeps all changes for a recording.
///
/// Every wait ends at the deadline of the laboratory. Times are from 0 to 1e6 s; others throw
/// Error. One thread.
class Laboratory {
 public:
  /// @param folder  of logs and recording; must exist
  /// @param map     a file, or the name of a built-in map
  /// @param deadline_s  of the whole test [s]
  /// @throws Error if the map cannot be read   @setup
  Laboratory(std::filesystem::path folder, const std::string& map, double deadline_s = 60);
  ~Laboratory();
  Laboratory(const Laboratory&) = delete;
  Laboratory& operator=(const Laboratory&) = delete;

  /// Name of the ring.
  [[nodiscard]] const std::string& name() const;
  [[nodiscard]] const std::filesystem::path& folder() const;
  [[nodiscard]] const std::shared_ptr<SignalRing>& ring() const;

  /// Starts a program and waits until its node is on the ring. Its output is <name>.log.
  /// @throws NotMet if the node is not on the ring in time; Error if its name is taken
  void start(const Program& program);
  /// The test itself plays a node.
  [[nodiscard]] std::unique_ptr<SignalNode> join(const std::string& node);
  /// Value of a signal [SI].
  [[nodiscard]] double read(const std::string& signal);
  /// Output of a program until now.
  [[nodiscard]] std::string log(const std::string& program) const;

  /// Faults of a program. @throws Error if there is no such program
  void kill(const std::string& program);
  void freeze(const std::string& program);  ///< until `thaw`
  void thaw(const std::string& program);
  /// Faults of the messages of a node whose program is linked, until `restore`.
  /// @throws Error if it is not linked, or the signal is not its own
  void drop(const std::string& node);
  void drop_signal(const std::string& signal);
  void delay(const std::string& node, double seconds);
  void flip(const std::string& signal, int bit);  ///< of each later write; bit 0 is the lowest
  void restore(const std::string& node);

  /// Waits until a signal meets a condition, now or by one of the writes within the time [s]. No
  /// write is missed, however short the value lasts. @returns the value [SI]   @throws NotMet
  double expect_within(double seconds, const std::string& signal, const Condition& condition);
  /// As expect_within, with 5 s.
  double eventually(const std::string& signal, const Condition& condition);
  /// Follows a signal for a time [s]. @throws NotMet as soon as it meets the condition
  void never(double seconds, const std::string& signal, const Condition& condition);
  [[nodiscard]] bool has_ended(const std::string& program);
  /// Waits until a program has ended with exit code 0. @throws NotMet
  void expect_end(double seconds, const std::string& program);
  /// @throws NotMet if a program failed that was not killed, or if a word was stored by another
  ///         process than its owner; Error if a link failed
  void check_programs();
  /// The last check of a test: also judges the stores of the last moment, for up to 0.2 s.
  /// @throws NotMet if a word was stored by another process than its owner
  void check_owners();

  /// Ends the programs, removes the ring. The logs stay.
  void close();
  /// Closes, and writes the recording of all changes, run.h5, into the folder.
  void keep();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Folder of the logs of one test, "<name>_<process id>", below the folder of failed tests.
/// @throws Error if it cannot be made   @setup
[[nodiscard]] std::filesystem::path make_test_folder(const std::filesystem::path& kept,
                                                     const std::string& test);
/// Removes it, and the folder of failed tests if that is empty then.
void remove_test_folder(const std::filesystem::path& folder);

}  // namespace rths::testkit
