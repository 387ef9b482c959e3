// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include <rths/session/progress.hpp>

namespace rths::session {

/// Counts the long steps of a task for its progress.
class NumberedSteps {
 public:
  NumberedSteps(const Progress& progress, int count) : progress_{progress}, count_{count} {}
  void begin(const std::string& name) {
    ++number_;
    if (progress_.step) progress_.step(number_, count_, name);
  }

 private:
  const Progress& progress_;
  int count_;
  int number_ = 0;
};

inline void note(const Progress& progress, const std::string& line) {
  if (progress.note) progress.note(line);
}

}  // namespace rths::session
