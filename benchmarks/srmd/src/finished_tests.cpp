// SPDX-License-Identifier: Apache-2.0
#include "finished_tests.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <sstream>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/core/error.hpp>
#include <rths/core/file.hpp>

namespace rths::bench {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SrmdAxis, name, largest, raw_delay, delay, windows, nrms, peak,
                                   feed_forward_overshoot, share_a0_below_1, lowest_a1, highest_a1)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SrmdTest, controller, stable, limit_periods, axes, floor_error)

namespace {

struct Line {
  TestName name;
  SrmdTest test;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Line, name, test)

}  // namespace

FinishedTests::FinishedTests(std::filesystem::path file, const std::string& origin)
    : file_{std::move(file)} {
  if (file_.empty()) return;
  constexpr int kFlags = O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC;
  descriptor_ = open(file_.c_str(), kFlags, 0666);  // NOLINT(cppcoreguidelines-pro-type-vararg)
  if (descriptor_ < 0)
    throw Error{fmt::format("{}: cannot be written: {}", file_.string(),
                            std::generic_category().message(errno))};
  try {
    if (flock(descriptor_, LOCK_EX | LOCK_NB) != 0)
      throw Error{file_.string() + ": another run writes this file; wait for its end"};
    read(origin);
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

FinishedTests::~FinishedTests() {
  if (descriptor_ >= 0) close(descriptor_);
}

void FinishedTests::read(const std::string& origin) {
  std::string content = read_file(file_, kMostTextBytes);
  content.resize(content.rfind('\n') + 1);  // npos + 1 is 0
  if (ftruncate(descriptor_, static_cast<off_t>(content.size())) != 0)
    throw Error{file_.string() + ": cannot be written"};
  if (content.empty()) return write(origin);
  std::istringstream lines{content};
  std::string line;
  std::getline(lines, line);
  if (line != origin)
    throw Error{fmt::format(
        "{}: tests of an interrupted run of another program or with other options: {}, expected "
        "{}; remove the file to begin anew",
        file_.string(), line, origin)};
  for (int number = 2; std::getline(lines, line); ++number) {
    try {
      auto read = nlohmann::json::parse(line).get<Line>();
      tests_.insert_or_assign(std::move(read.name), std::move(read.test));
    } catch (const nlohmann::json::exception& wrong) {
      throw Error{fmt::format("{}:{}: {}, expected a test; remove the file to begin anew",
                              file_.string(), number, wrong.what())};
    }
  }
}

// One call, so that a killed process leaves whole lines; the kernel appends each in one piece.
void FinishedTests::write(const std::string& line) {
  const std::string text = line + "\n";
  const off_t before = lseek(descriptor_, 0, SEEK_END);
  if (::write(descriptor_, text.data(), text.size()) == static_cast<ssize_t>(text.size())) return;
  // Another thread may append its test meanwhile: not behind a piece of this line.
  const bool is_shortened = ftruncate(descriptor_, before) == 0;
  throw Error{file_.string() + (is_shortened ? ": cannot be written" : ": is damaged")};
}

void FinishedTests::add(const TestName& name, const SrmdTest& test) {
  const std::lock_guard lock{mutex_};
  if (descriptor_ >= 0) write(nlohmann::json(Line{name, test}).dump());
  tests_.insert_or_assign(name, test);
}

bool FinishedTests::contains(const TestName& name) const {
  const std::lock_guard lock{mutex_};
  return tests_.contains(name);
}

std::size_t FinishedTests::size() const {
  const std::lock_guard lock{mutex_};
  return tests_.size();
}

SrmdTest FinishedTests::at(const TestName& name) const {
  const std::lock_guard lock{mutex_};
  return tests_.at(name);
}

}  // namespace rths::bench
