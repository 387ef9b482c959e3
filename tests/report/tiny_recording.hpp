// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <rths/recording/recording.hpp>

namespace rths::report {

/// A word of a tiny recording: `partition.signal`, written by a node.
struct TinyWord {
  std::string node, partition, signal;
  std::function<double(double time)> value;
};

/// A recording of a few words, as functions of time. It counts no steps of its nodes.
struct TinyRecording {
  std::string experiment;  ///< empty: it holds none
  std::vector<TinyWord> words;
  double interval = 0.01;  ///< of its rows [s]
  int rows = 0;            ///< the first is at time 0
  std::string ending = "completed";
  std::string specimen = {};  ///< the assumed model; empty: none

  void write(const std::filesystem::path& file) const;
};

}  // namespace rths::report
