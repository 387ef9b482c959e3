// SPDX-License-Identifier: Apache-2.0
#include "recorder.hpp"

#include <limits>

#include <fmt/format.h>

#include <rths/broker/watch_text.hpp>
#include <rths/recording/recording.hpp>

namespace rths::testkit {
namespace {

constexpr Duration kRecorderLook = std::chrono::milliseconds{1};  // at words of others, for the end
constexpr Duration kStoreLook = std::chrono::microseconds{500};   // at stores through pointers
constexpr Duration kRow = std::chrono::milliseconds{1};
constexpr Duration kLastWrites = std::chrono::milliseconds{500};  // may take so long
constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr std::size_t kMostEntries = 16'000'000;  // 256 MB

Duration look_period(const broker::Watch& watch, const memmap::Map& map) {
  for (const auto& node : map.description().nodes)
    if (watch.is_plain(node.name)) return kStoreLook;
  return kRecorderLook;
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
  for (std::uint32_t i = 0; i < words.size(); ++i) {
    const std::uint32_t offset = write.offset.value() + i;
    const std::uint32_t signal = offset < signals_.size() ? signals_[offset] : kNone;
    if (signal == kNone) continue;
    if (entries_.size() < kMostEntries)
      entries_.push_back({time, signal, words[i]});
    else
      ++missing_;
  }
}

void WriteRecorder::end() {
  ends_.store(true);
  if (thread_.joinable()) thread_.join();
  watch_.reset();
}

void WriteRecorder::write(const std::filesystem::path& file) {
  end();
  const auto& signals = ring_->map().signals();
  std::vector<SignalId> ids;
  for (const auto& entry : signals) ids.push_back(ring_->map().signal(entry.name));
  recording::RecordingInfo info;
  info.meta = {{"made_by", "rths testkit"}, {"writes_missing", fmt::format("{}", missing_)}};
  recording::Writer writer{file, ring_->map(), ids, info};
  std::vector<double> row = first_;
  std::vector<bool> has_changed(row.size(), false);
  writer.append(Duration{0}, row);
  Duration begin{0}, last{0};  // of the changes in this row
  const auto flush = [&] {
    if (last == Duration{0}) return;
    writer.append(last, row);
    has_changed.assign(row.size(), false);
  };
  Duration written{0};
  for (const auto& entry : entries_) {
    if (has_changed[entry.signal] || entry.time - begin > kRow) {
      flush();
      written = last;
      begin = entry.time;
    }
    row[entry.signal] = ring_->codec(signals[entry.signal]).decode(entry.word);
    has_changed[entry.signal] = true;
    last = std::max(entry.time, written + Duration{1});
  }
  flush();
  writer.close();
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
