// SPDX-License-Identifier: Apache-2.0
#include <rths/foreign/runs.hpp>

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <thread>

#include <fmt/format.h>

#include <rths/core/clock.hpp>
#include <rths/core/error.hpp>
#include <rths/core/sha256.hpp>

namespace rths::foreign {
namespace {

// Numbers of all results together: 16 MB. A fork copies the tables of the pages of this process.
constexpr std::size_t kMostKept = 2'000'000;

std::size_t size_of(const RunOutputs& run) {
  return run.outputs.empty() ? 1 : run.outputs.size() * run.outputs[0].size();
}

void append(const void* bytes, std::size_t count, std::string& text) {
  text.append(static_cast<const char*>(bytes), count);
}

void append(const std::vector<double>& values, std::string& text) {
  const std::size_t size = values.size();
  append(&size, sizeof size, text);
  append(values.data(), size * sizeof(double), text);
}

std::string key_of(const RunInputs& inputs) {
  std::string bytes = inputs.law.key + '\0';
  append({inputs.start, inputs.time_step, static_cast<double>(inputs.rows)}, bytes);
  append(inputs.parameters, bytes);
  for (const auto& input : inputs.inputs) append(input, bytes);
  return sha256(bytes);
}

double largest_difference(const RunOutputs& one, const RunOutputs& other) {
  double largest = 0;
  for (std::size_t i = 0; i < one.outputs.size(); ++i)
    for (std::size_t row = 0; row < one.outputs[i].size(); ++row)
      largest = std::max(largest, std::abs(one.outputs[i][row] - other.outputs[i][row]));
  return largest;
}

}  // namespace

Runs::Runs(std::unique_ptr<Simulation> simulation, std::size_t most)
    : simulation_{std::move(simulation)}, most_{most} {}

std::vector<RunOutputs> Runs::results(const std::vector<RunInputs>& wanted) {
  const std::lock_guard lock{mutex_};
  std::vector<std::string> keys;
  std::vector<const RunInputs*> missing;
  std::vector<std::string> missing_keys;
  for (const auto& one : wanted) {
    keys.push_back(key_of(one));
    if (known_.count(keys.back()) > 0 ||
        std::find(missing_keys.begin(), missing_keys.end(), keys.back()) != missing_keys.end())
      continue;
    missing.push_back(&one);
    missing_keys.push_back(keys.back());
  }
  std::vector<RunOutputs> made(missing.size());
  run_all(missing, made);
  for (std::size_t i = 0; i < made.size(); ++i) {
    kept_ += size_of(made[i]);
    known_[missing_keys[i]] = std::move(made[i]);
    order_.push_back(missing_keys[i]);
  }
  std::vector<RunOutputs> results;
  for (const auto& key : keys) results.push_back(known_.at(key));
  for (; kept_ > kMostKept && order_.size() > 1; order_.pop_front()) {
    const auto oldest = known_.find(order_.front());
    kept_ -= size_of(oldest->second);
    known_.erase(oldest);
  }
  return results;
}

void Runs::run_all(const std::vector<const RunInputs*>& missing, std::vector<RunOutputs>& made) {
  if (missing.empty()) return;
  if (made_ + missing.size() > most_)
    throw Error{fmt::format(
        "{} of {} runs are made and {} more are needed: allow more (most_runs), or fit less", made_,
        most_, missing.size())};
  const WallClock clock;
  const TimePoint begin = clock.now();
  const std::size_t count = missing.size(), workers = std::min(processors(), count);
  const std::size_t share = simulation_->prefers_several() ? (count + workers - 1) / workers : 1;
  std::atomic<std::size_t> next{0};
  std::vector<std::exception_ptr> problems(count);
  const auto work = [&] {
    for (std::size_t i = next.fetch_add(share); i < count; i = next.fetch_add(share)) try {
        auto results =
            simulation_->run_each(std::span{missing}.subspan(i, std::min(share, count - i)));
        std::move(results.begin(), results.end(), made.begin() + static_cast<std::ptrdiff_t>(i));
      } catch (...) {
        problems[i] = std::current_exception();
        next = count;
      }
  };
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < workers; ++i) others.emplace_back(work);
  work();
  others.clear();
  for (const auto& problem : problems)
    if (problem) std::rethrow_exception(problem);
  made_ += count;
  seconds_ += to_seconds(clock.now() - begin);
}

void Runs::check_repeats(const RunInputs& wanted) {
  const RunOutputs known = result(wanted);
  if (!known.trouble.empty()) throw Error{known.trouble};
  std::vector<RunOutputs> again(1);
  run_all({&wanted}, again);
  if (!again[0].trouble.empty()) throw Error{again[0].trouble};
  if (const double difference = largest_difference(known, again[0]); difference > 0)
    throw Error{fmt::format(
        "two runs with the same inputs differ by up to {:g}: expected the same outputs, as with a "
        "fixed seed",
        difference)};
}

std::size_t processors() {
  cpu_set_t set;
  CPU_ZERO(&set);
  const int count = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
  return static_cast<std::size_t>(std::max(1, count));
}

}  // namespace rths::foreign
