// SPDX-License-Identifier: Apache-2.0
#include "relay.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

namespace rths::test {

class Relay::Port final : public dds::Carrier {
 public:
  Port(std::shared_ptr<Relay> relay, std::size_t index) : relay_{std::move(relay)}, index_{index} {}
  bool send(std::span<const std::byte> bytes) override {
    relay_->send(index_, bytes);
    return true;
  }
  ~Port() override { listen({}); }
  void listen(Handler handle) override {
    ends_ = true;
    if (thread_.joinable()) thread_.join();
    if (!handle) return;
    ends_ = false;
    thread_ = std::thread{[this, handle] {
      std::vector<std::byte> bytes;
      while (!ends_)
        if (relay_->receive(index_, bytes, std::chrono::milliseconds{5})) handle(bytes);
    }};
  }
  std::vector<dds::PresentHost> present() override { return relay_->present(index_); }
  std::uint64_t damaged() const override { return 0; }
  void rejoin() override { relay_->rejoin(index_); }

 private:
  std::shared_ptr<Relay> relay_;
  std::size_t index_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

std::unique_ptr<dds::Carrier> Relay::connect() {
  const std::lock_guard lock{mutex_};
  queues_.emplace_back();
  for (auto* flags : {&cut_, &spoilt_in_, &spoilt_out_}) flags->push_back(false);
  auto port = std::make_unique<Port>(shared_from_this(), queues_.size() - 1);
  ids_.push_back(port->id());
  ++counts_.carriers;
  return port;
}

void Relay::spoil(std::size_t carrier, Way way) {
  const std::lock_guard lock{mutex_};
  (way == Way::In ? spoilt_in_ : spoilt_out_).at(carrier) = true;
}

void Relay::rejoin(std::size_t at) {
  const std::lock_guard lock{mutex_};
  spoilt_in_[at] = spoilt_out_[at] = false;
}

std::vector<dds::PresentHost> Relay::present(std::size_t at) const {
  const std::lock_guard lock{mutex_};
  std::vector<dds::PresentHost> hosts;
  for (std::size_t i = 0; i < ids_.size(); ++i)
    if (i != at && !cut_[i] && !cut_[at])
      hosts.push_back({ids_[i], "host" + std::to_string(i), "ring"});
  return hosts;
}

void Relay::cut(std::size_t carrier, bool off) {
  const std::lock_guard lock{mutex_};
  cut_.at(carrier) = off;
}

void Relay::set_faults(const RelayFaults& faults) {
  const std::lock_guard lock{mutex_};
  faults_ = faults;
}

RelayCounts Relay::counts() const {
  const std::lock_guard lock{mutex_};
  return counts_;
}

void Relay::inject(const std::vector<std::byte>& bytes) {
  const std::lock_guard lock{mutex_};
  for (auto& queue : queues_) queue.emplace(WallClock{}.now(), bytes);
  arrived_.notify_all();
}

// A delayed frame is overtaken by later ones; the others keep their order.
void Relay::deliver(Queue& queue, std::span<const std::byte> bytes) {
  std::uniform_real_distribution<double> share{0, 1};
  TimePoint due = WallClock{}.now();
  if (share(random_) < faults_.reordering) {
    due += Duration{
        static_cast<Duration::rep>(share(random_) * static_cast<double>(faults_.jitter.count()))};
    ++counts_.delayed;
  }
  queue.emplace(due, std::vector<std::byte>{bytes.begin(), bytes.end()});
  ++counts_.passed;
}

void Relay::send(std::size_t from, std::span<const std::byte> bytes) {
  const std::lock_guard lock{mutex_};
  std::uniform_real_distribution<double> share{0, 1};
  for (std::size_t to = 0; to < queues_.size(); ++to) {
    if (to == from || cut_[from] || cut_[to] || spoilt_out_[from] || spoilt_in_[to]) continue;
    if (share(random_) < faults_.loss) {
      ++counts_.lost;
      continue;
    }
    deliver(queues_[to], bytes);
    if (share(random_) >= faults_.duplication) continue;
    deliver(queues_[to], bytes);
    ++counts_.duplicated;
  }
  arrived_.notify_all();
}

bool Relay::receive(std::size_t at, std::vector<std::byte>& bytes, Duration timeout) {
  std::unique_lock lock{mutex_};
  const WallClock clock;
  const TimePoint deadline = clock.now() + timeout;
  for (;;) {
    Queue& queue = queues_[at];
    const TimePoint now = clock.now();
    if (!queue.empty() && queue.begin()->first <= now) {
      bytes = std::move(queue.begin()->second);
      queue.erase(queue.begin());
      return true;
    }
    if (now >= deadline) return false;
    const TimePoint next =
        queue.empty() ? deadline : std::min(deadline, TimePoint{queue.begin()->first});
    arrived_.wait_for(lock, next - now);
  }
}

}  // namespace rths::test
