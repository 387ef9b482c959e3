// SPDX-License-Identifier: Apache-2.0
#include <rths/adapters/adapter_runner.hpp>

#include <algorithm>
#include <limits>
#include <map>

#include <fmt/format.h>

#include <rths/core/error.hpp>
#include <rths/memmap/units.hpp>

namespace rths::adapters {
namespace {

enum RunnerPort : std::size_t {
  kStep,
  kStatus,
  kOverruns,
  kStale,
  kLate,
  kLateMax,
  kDuration,
  kInvalid,
  kSkipped,
  kRunnerPorts
};

}  // namespace

std::vector<Port> runner_ports() {
  return {{"host.step", Direction::Monitor, "1", 0, false},
          {"host.status", Direction::Monitor, "1", 0, true},
          {"host.overruns", Direction::Monitor, "1", 0, true},
          {"host.stale", Direction::Monitor, "1", 0, true},
          {"host.late", Direction::Monitor, "s", 0, false},
          {"host.late_max", Direction::Monitor, "s", 0, false},
          {"host.duration", Direction::Monitor, "s", 0, false},
          {"host.invalid", Direction::Monitor, "1", 0, true},
          {"host.skipped", Direction::Monitor, "1", 0, true}};
}

std::string signal_name(const Port& port, const std::string& node) {
  if (port.direction == Direction::Monitor) return "monitor." + node + "." + port.name;
  return port.direction == Direction::Parameter ? "tune." + node + "." + port.name : port.name;
}

namespace {

/// Units by name: parsing one is slow.
class KnownUnits {
 public:
  const memmap::Unit& operator[](const std::string& name) {
    auto& known = units_[name];
    if (known.si.empty()) known = memmap::parse_unit(name);
    return known;
  }

 private:
  std::map<std::string, memmap::Unit> units_;
};

memmap::SignalEntry entry_of(const Port& port, const memmap::Map& map, const std::string& node) {
  try {
    return map.entry(map.signal(signal_name(port, node)));
  } catch (const Error& error) {
    throw Error{fmt::format("node '{}': {}", node, error.what())};
  }
}

}  // namespace

void check_ports(const std::vector<Port>& ports, const memmap::Map& map, const std::string& node) {
  KnownUnits units;
  for (const auto& port : ports) {
    const auto entry = entry_of(port, map, node);
    const char* const verb = is_read(port) ? "reads" : "writes";
    if (!is_read(port) && entry.partition->node != node)
      throw Error{"node '" + node + "' cannot write '" + entry.name + "', which belongs to '" +
                  entry.partition->node + "'"};
    const memmap::Unit unit = units[port.unit];
    const std::string in_map = units[entry.signal->unit].si;
    if (unit.si != in_map)
      throw Error{fmt::format("node '{}' {} '{}' in [{}], the map gives [{}]", node, verb,
                              entry.name, unit.si, in_map)};
    if (unit.scale != 1 || unit.offset != 0)
      throw Error{fmt::format("node '{}' {} '{}' in [{}], expected the SI unit [{}]", node, verb,
                              entry.name, port.unit, unit.si)};
  }
}

AdapterRunner::AdapterRunner(Adapter& adapter, broker::Ring& ring, const std::string& node,
                             std::uint64_t map_hash, const Schedule& schedule)
    : adapter_{adapter}, node_{ring.join(node, map_hash)}, schedule_{schedule} {
  bind(runner_ports(), ring, node);
  bind(adapter.ports(), ring, node);
  // On cards, words go out one by one, and the other nodes wait for the outputs only.
  std::stable_partition(writes_.begin(), writes_.end(),
                        [](const Transfer& transfer) { return !transfer.is_monitor; });
  std::vector<broker::LongwordRange> words;
  for (const auto& transfer : reads_)
    words.push_back({transfer.base, static_cast<std::uint32_t>(transfer.image.size())});
  if (words.empty()) return;
  waiter_ = ring.wait_for(words);
  if (schedule.missed != MissedSteps::MakeDue) return;
  for (const auto& writer : ring.writers_of(words))
    if (writer != node) followers_.push_back(ring.follow(writer));
}

void AdapterRunner::await_steps_of(const std::string& node, bool goes_first, broker::Ring& ring) {
  constexpr double kBeforeTheFirst = -1;
  const Port count = runner_ports()[kStep];
  const memmap::SignalEntry entry = entry_of(count, ring.map(), node);
  awaited_.push_back({entry.signal->offset, memmap::Codec{*entry.signal}, 0});
  awaited_.back().seen = goes_first ? kBeforeTheFirst : steps_of(awaited_.back());
}

double AdapterRunner::steps_of(const Awaited& awaited) const noexcept {
  return awaited.codec.decode(node_.read(awaited.steps));
}

bool AdapterRunner::is_awaiting(const Awaited& awaited) const noexcept {
  return !awaited.is_given_up && steps_of(awaited) == awaited.seen;
}

bool AdapterRunner::is_awaiting() const noexcept {
  return std::any_of(awaited_.begin(), awaited_.end(),
                     [this](const Awaited& awaited) { return is_awaiting(awaited); });
}

void AdapterRunner::give_up_awaiting() noexcept {
  for (auto& awaited : awaited_) awaited.is_given_up = awaited.is_given_up || is_awaiting(awaited);
}

AdapterRunner::Value AdapterRunner::value_for(const Port& port, const memmap::SignalEntry& entry,
                                              std::size_t index, LongwordOffset base) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const memmap::Codec codec{*entry.signal};
  const auto as_in_word = [&](double value) { return codec.decode(codec.encode(value)); };
  Value value{static_cast<std::uint32_t>(index),
              entry.signal->offset.value() - base.value(),
              codec,
              -kInfinity,
              kInfinity,
              port.direction == Direction::Parameter};
  if (port.range) {
    value.lowest = as_in_word(port.range->first);
    value.highest = as_in_word(port.range->second);
  }
  return value;
}

void AdapterRunner::bind(const std::vector<Port>& ports, broker::Ring& ring,
                         const std::string& node) {
  check_ports(ports, ring.map(), node);
  for (const auto& port : ports) {
    const auto& entry = ring.map().entry(ring.map().signal(signal_name(port, node)));
    const bool reads = is_read(port);
    auto& values = reads ? inputs_ : outputs_;
    Transfer& transfer = transfer_for(reads ? reads_ : writes_, entry, ring);
    const Value value = value_for(port, entry, values.size(), transfer.base);
    const auto word = node_.read(entry.signal->offset);
    const double now = value.codec.decode(word);
    const bool is_refused = port.direction == Direction::Parameter && !value.accepts(now);
    values.push_back(is_refused ? value.codec.to_si(entry.signal->initial) : now);
    transfer.is_monitor = transfer.is_monitor && port.direction == Direction::Monitor;
    transfer.values.push_back(value);
    transfer.image[value.word] = word;
  }
}

AdapterRunner::Transfer& AdapterRunner::transfer_for(std::vector<Transfer>& transfers,
                                                     const memmap::SignalEntry& entry,
                                                     const broker::Ring& ring) {
  const bool is_group = entry.partition->tear_group;
  const LongwordOffset base = is_group ? entry.partition->base : entry.signal->offset;
  for (auto& transfer : transfers)
    if (is_group && transfer.is_group && transfer.base == base) return transfer;
  Transfer transfer;
  transfer.base = base;
  transfer.is_group = is_group;
  if (is_group) transfer.group = ring.tear_group(entry.partition->name);
  transfer.image.resize(is_group ? entry.partition->longwords : 1);
  transfers.push_back(std::move(transfer));
  return transfers.back();
}

Status AdapterRunner::read_inputs(const Timing& timing) noexcept {
  if (step_.is_missed && !followers_.empty()) return read_until(timing.due);
  // A write between these two is read twice, not lost.
  for (auto& follower : followers_) follower.skip_to_end();
  return read_newest();
}

// The words as they were when the step was due. A node that was late too dates its own so.
Status AdapterRunner::read_until(TimePoint time) noexcept {
  broker::Write write;
  for (auto& follower : followers_) {
    broker::Followed followed{};
    while ((followed = follower.next_until(time, write)) == broker::Followed::Write) keep(write);
    if (followed == broker::Followed::Lost) return read_newest();
  }
  if (node_.is_ring_lost()) return Status::Stale;
  Status status = Status::Ok;
  for (const auto& transfer : reads_) status = worst(status, take(transfer));
  return status;
}

void AdapterRunner::keep(const broker::Write& write) noexcept {
  for (auto& transfer : reads_) {
    if (transfer.base != write.offset) continue;
    if (!transfer.is_group)
      transfer.image[0] = write.value;
    else if (write.group.size() == transfer.image.size())
      std::copy(write.group.begin(), write.group.end(), transfer.image.begin());
  }
}

Status AdapterRunner::read_newest() noexcept {
  Status status = Status::Ok;
  for (auto& transfer : reads_) {
    if (!transfer.is_group)
      transfer.image[0] = node_.read(transfer.base);
    else if (node_.read_group(transfer.group, transfer.image) != Status::Ok) {
      status = Status::Stale;  // keep the values of the last consistent read
      continue;
    }
    if (node_.is_ring_lost()) return Status::Stale;  // the words may be zeros
    status = worst(status, take(transfer));
  }
  return status;
}

Status AdapterRunner::take(const Transfer& transfer) noexcept {
  Status status = Status::Ok;
  for (const auto& value : transfer.values) {
    const double now = value.codec.decode(transfer.image[value.word]);
    if (value.accepts(now))
      inputs_[value.index] = now;
    else
      status = Status::Stale;  // NaN would spread to every result
    invalid_ += std::isfinite(now) || value.is_parameter ? 0 : 1;
  }
  return status;
}

Status AdapterRunner::write_outputs() noexcept {
  Status status = Status::Ok;
  for (auto& transfer : writes_) {
    for (const auto& value : transfer.values) {
      // A finite value may still overflow its word.
      const std::uint32_t word = value.codec.encode(outputs_[value.index]);
      if (std::isfinite(outputs_[value.index]) && std::isfinite(value.codec.decode(word)))
        transfer.image[value.word] = word;
      else
        status = Status::LimitExceeded;
    }
    status = worst(status, transfer.is_group ? node_.write_group(transfer.group, transfer.image)
                                             : node_.write(transfer.base, transfer.image[0]));
  }
  return status;
}

void AdapterRunner::write_own_monitors(Status status, const Timing& timing) noexcept {
  steps_ += timing.is_early ? 0 : 1;
  stale_ += status == Status::Stale ? 1 : 0;
  // The period of a node that skips steps is that of its looks at flags: a long step may delay one.
  const Duration over = timing.duration - schedule_.period;
  const bool skips = schedule_.missed == MissedSteps::Skip;
  overruns_ += (skips ? schedule_.skipped_at(over) > 0 : over > Duration{0}) ? 1 : 0;
  skipped_ += timing.skipped;
  outputs_[kSkipped] = static_cast<double>(skipped_);
  outputs_[kStep] = static_cast<double>(steps_);
  outputs_[kStatus] = static_cast<double>(status);
  outputs_[kOverruns] = static_cast<double>(overruns_);
  outputs_[kStale] = static_cast<double>(stale_);
  outputs_[kLate] = to_seconds(timing.late);
  outputs_[kLateMax] = std::max(outputs_[kLateMax], outputs_[kLate]);
  outputs_[kDuration] = to_seconds(timing.duration);
  for (std::size_t i = kRunnerPorts; i < outputs_.size(); ++i)
    invalid_ += std::isfinite(outputs_[i]) ? 0 : 1;
  outputs_[kInvalid] = static_cast<double>(invalid_);
}

Status AdapterRunner::tick(Duration time, bool stopping, const Timing& timing) noexcept {
  for (auto& awaited : awaited_) {
    const double steps = steps_of(awaited);
    awaited.is_given_up = awaited.is_given_up && steps == awaited.seen;
    awaited.seen = steps;
  }
  step_.is_missed = timing.late >= schedule_.period;
  Status status = read_inputs(timing);
  step_.time = to_seconds(time);
  step_.age = timing.clock != nullptr ? to_seconds(timing.clock->now() - timing.due) : 0;
  step_.inputs = inputs_;
  step_.outputs = std::span{outputs_}.subspan(kRunnerPorts);
  step_.stopping = stopping || node_.is_ring_lost();
  const Status result = adapter_.step(step_);
  if (*step_.message != '\0')
    std::atomic_ref{stop_request_}.store(step_.message, std::memory_order_release);
  status = worst(status, result);
  write_own_monitors(status, timing);
  status = worst(status, write_outputs());
  const TimePoint now = timing.clock != nullptr ? timing.clock->now() : WallClock{}.now();
  const bool is_of_its_time = step_.is_missed && schedule_.missed == MissedSteps::MakeDue;
  node_.beat(now, is_of_its_time ? now - timing.due : Duration{0});
  // A stale input in the last step does not revoke the adapter's Done.
  return result == Status::Done && status != Status::Fault ? Status::Done : status;
}

void AdapterRunner::keep_times(std::size_t steps) {
  times_ = {};
  times_.late.reserve(steps);
  times_.duration.reserve(steps);
}

void AdapterRunner::keep(const Timing& timing) noexcept {
  if (timing.is_early || times_.late.size() == times_.late.capacity()) return;
  times_.late.push_back(static_cast<float>(to_seconds(timing.late)));
  times_.duration.push_back(static_cast<float>(to_seconds(timing.duration)));
}

// Writes since the last step end the wait at once; they are consumed together.
void AdapterRunner::wait_for_inputs(TimePoint time) noexcept {
  constexpr int kMost = 1000;
  broker::Write write;
  bool was_written = false;
  for (int i = 0; i < kMost && waiter_->wait(TimePoint{0}, write) != Status::Late; ++i)
    was_written = true;
  if (!was_written) static_cast<void>(waiter_->wait(time, write));
}

void AdapterRunner::wait_for_others(Clock& clock) noexcept {
  TimePoint give_up{0};
  while (is_awaiting()) {
    const TimePoint now = clock.now();
    if (give_up == TimePoint{0}) give_up = now + kLongestAwaited;
    if (now >= give_up) return give_up_awaiting();
    clock.sleep_until(now + kAwaitedNap);
  }
}

void AdapterRunner::wait_until(TimePoint time, Clock& clock) noexcept {
  const Wake wake = adapter_.wakes_on();
  if (wake == Wake::Inputs && waiter_) return wait_for_inputs(time);
  if (wake != Wake::External) return clock.sleep_until(time);
  if (const Duration left = time - clock.now(); left > Duration{0}) adapter_.wait_external(left);
}

LoopEnd run_loop(AdapterRunner& runner, Clock& clock, TimePoint epoch,
                 const std::atomic<bool>& stopping) noexcept {
  const Schedule& schedule = runner.schedule();
  Timing timing;
  timing.clock = &clock;
  for (Duration due = schedule.phase;;) {
    runner.wait_until(epoch + due, clock);
    // At the end, each comes to rest by itself.
    if (!stopping.load(std::memory_order_relaxed)) runner.wait_for_others(clock);
    const TimePoint begun = clock.now();
    if (const auto skipped = schedule.skipped_at(begun - (epoch + due)); skipped > 0) {
      timing.skipped += skipped;
      due += static_cast<Duration::rep>(skipped) * schedule.period;
      if (epoch + due > begun) continue;
    }
    timing.is_early = begun < epoch + due;
    timing.late = timing.is_early ? Duration{0} : begun - (epoch + due);
    const Duration time = timing.is_early ? begun - epoch : due;
    timing.due = epoch + time;
    const Status status = runner.tick(time, stopping.load(std::memory_order_relaxed), timing);
    timing.skipped = 0;
    timing.duration = clock.now() - begun;
    runner.keep(timing);
    if (status == Status::Done || status == Status::Fault) return {status, time};
    if (!timing.is_early) due += schedule.period;
  }
}

}  // namespace rths::adapters
