// SPDX-License-Identifier: Apache-2.0
#include "recorder.hpp"

#include <limits>
#include <utility>

#include <fmt/format.h>

#include <rths/broker/watch_text.hpp>

namespace rths::testkit {
namespace {

constexpr Duration kRecorderLook = std::chrono::milliseconds{1};  // at words of others, for the end
constexpr Duration kStoreLook = std::chrono::microseconds{500};   // at stores through pointers
constexpr Duration kRow = std::chrono::milliseconds{1};
constexpr Duration kLastWrites = std::chrono::milliseconds{500};  // may take so long
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostChanges = 16'000'000;  // 256 MB

Duration look_period(const broker::Watch& watch, const memmap::Map& map) {
  for (const auto& node : map.description().nodes)
    if (watch.is_plain(node.name)) return kStoreLook;
  return kRecorderLook;
}

std::vector<SignalId> all_signals(const memmap::Map& map) {
  std::vector<SignalId> ids;
  for (const auto& entry : map.signals()) ids.push_back(map.signal(entry.name));
  return ids;
}

}  // namespace

WriteRecorder::WriteRecorder(const std::string& ring)
    : ring_{SignalRing::attach(ring)},
      observer_{ring_->ring().observe()},
      waiter_{ring_->ring().wait_for({}, Duration{0})},
      begun_{WallClock{}.now()},
      foreign_log_{ring_->map(), begun_} {
  const auto& signals = ring_->map().signals();
  for (std::uint32_t i = 0; i < signals.size(); ++i) {
    const std::uint32_t offset = signals[i].signal->offset.value();
    if (offset >= signals_.size()) signals_.resize(offset + 1, kNone);
    signals_[offset] = i;
    first_.push_back(ring_->codec(signals[i]).decode(observer_.read(signals[i].signal->offset)));
  }
  watch_.emplace(ring_->ring());
  thread_ = std::thread{[this] { record(); }};
}

void WriteRecorder::record() {
  const WallClock clock;
  broker::Watch& watch = *watch_;
  TimePoint next_look{0};
  TimePoint latest{std::numeric_limits<TimePoint::rep>::max()};
  for (;;) {
    const TimePoint now = clock.now();
    const bool ends = ends_.load();
    if (ends) latest = std::min(latest, now + kLastWrites);
    if (now >= next_look) {
      foreign_log_.look(watch);
      next_look = now + look_period(watch, ring_->map());
    }
    broker::Write write;
    const Status status = waiter_.wait(ends ? TimePoint{0} : next_look, write);
    if (status == Status::Ok) take(write);
    if (status == Status::LimitExceeded) ++missing_;
    if ((ends && status == Status::Late) || now > latest) return;
  }
}

void WriteRecorder::take(const broker::Write& write) {
  const Duration time = WallClock{}.now() - begun_;
  const std::span<const std::uint32_t> words =
      write.group.empty() ? std::span{&write.value, 1} : write.group;
  const std::lock_guard lock{mutex_};
  for (std::uint32_t i = 0; i < words.size(); ++i) {
    const std::uint32_t offset = write.offset.value() + i;
    const std::uint32_t signal = offset < signals_.size() ? signals_[offset] : kNone;
    if (signal == kNone) continue;
    if (changes_.size() < kMostChanges)
      changes_.push_back({time, signal, words[i]});
    else
      ++missing_;
  }
}

void WriteRecorder::end() {
  ends_.store(true);
  if (thread_.joinable()) thread_.join();
  watch_.reset();
}

std::vector<WordChange> WriteRecorder::taken() {
  const std::lock_guard lock{mutex_};
  return std::exchange(changes_, {});
}

void WriteRecorder::write(const std::filesystem::path& file) {
  end();
  RowWriter writer{file, ring_, first_, kRow};
  writer.add(changes_);
  writer.close(missing());
}

RowWriter::RowWriter(const std::filesystem::path& file, const std::shared_ptr<SignalRing>& ring,
                     std::vector<double> first, Duration row)
    : file_{file},
      ring_{ring},
      writer_{file, ring->map(), all_signals(ring->map()), {{}, {{"made_by", "rths"}}, {}}},
      row_{std::move(first)},
      span_{row},
      has_changed_(row_.size(), false) {
  append(Duration{0});
}

void RowWriter::append(Duration time) {
  writer_.append(time, row_);
  ++rows_;
}

void RowWriter::flush() {
  if (last_ == Duration{0}) return;
  append(last_);
  has_changed_.assign(row_.size(), false);
}

void RowWriter::add(const std::vector<WordChange>& changes) {
  const auto& signals = ring_->map().signals();
  for (const auto& change : changes) {
    if (has_changed_[change.signal] || change.time - begin_ > span_) {
      flush();
      written_ = last_;
      begin_ = change.time;
    }
    row_[change.signal] = ring_->codec(signals[change.signal]).decode(change.word);
    has_changed_[change.signal] = true;
    last_ = std::max(change.time, written_ + Duration{1});
  }
}

void RowWriter::close(std::uint64_t missing) {
  flush();
  writer_.close();
  recording::add_meta(file_, {{"writes_missing", fmt::format("{}", missing)}});
}

void ForeignLog::look(broker::Watch& watch) {
  const auto stores = watch.look();
  has_suspicion_.store(watch.has_suspicion());
  for (const auto& store : stores) {
    if (store.allowed) continue;
    const std::lock_guard lock{mutex_};
    if (!first_.empty()) return;
    const std::string expected = store.owner.empty()
                                     ? "no store, because no node owns the word"
                                     : fmt::format("stores by its owner {} alone", store.owner);
    first_ = fmt::format("{}: stored as {} by {} at {:.3f} s, expected {}",
                         broker::word_name(map_, store.offset),
                         broker::word_value(map_, store.offset, store.value),
                         broker::writers_of(store), to_seconds(store.seen - begun_), expected);
  }
}

std::string ForeignLog::first() const {
  const std::lock_guard lock{mutex_};
  return first_;
}

}  // namespace rths::testkit
