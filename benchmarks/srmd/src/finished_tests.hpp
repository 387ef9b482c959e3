// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <tuple>

#include <rths/bench/srmd_bench.hpp>

namespace rths::bench {

/// Member of the family, record, controller.
using TestName = std::tuple<int, std::string, std::string>;

/// The finished tests of a benchmark. With a file, each is one line of JSON there, and the next
/// run of the same program with the same options has them from the beginning.
class FinishedTests {
 public:
  /// Reads the file, or begins it. A last line without its end is removed.
  /// @param file    empty: none
  /// @param origin  program and options, as JSON: the first line of the file
  /// @throws Error if the file cannot be written, has another origin, or another process writes it
  /// @setup
  FinishedTests(std::filesystem::path file, const std::string& origin);
  FinishedTests(const FinishedTests&) = delete;
  FinishedTests& operator=(const FinishedTests&) = delete;
  ~FinishedTests();

  /// @throws Error if the line cannot be written   @any_thread
  void add(const TestName& name, const SrmdTest& test);
  [[nodiscard]] bool contains(const TestName& name) const;  ///< @any_thread
  [[nodiscard]] std::size_t size() const;                   ///< @any_thread
  /// @throws std::out_of_range if it is not finished   @any_thread
  [[nodiscard]] SrmdTest at(const TestName& name) const;

 private:
  void read(const std::string& origin);
  void write(const std::string& line);

  std::filesystem::path file_;
  int descriptor_ = -1;
  mutable std::mutex mutex_;
  std::map<TestName, SrmdTest> tests_;
};

}  // namespace rths::bench
