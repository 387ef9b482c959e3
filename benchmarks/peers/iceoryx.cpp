// SPDX-License-Identifier: Apache-2.0
//
// iceoryx 2: publish and subscribe through shared memory from a daemon, RouDi. This program starts
// and stops RouDi.
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include <iceoryx_posh/popo/untyped_publisher.hpp>
#include <iceoryx_posh/popo/untyped_subscriber.hpp>
#include <iceoryx_posh/runtime/posh_runtime.hpp>

#include <rths/core/error.hpp>

#include "peer.hpp"

namespace rths::peers {
namespace {

constexpr auto kTimeout = std::chrono::seconds{10};  // of discovery

/// The daemon; the destructor stops it.
class RouDi {
 public:
  RouDi() {
    pid_ = fork();
    if (pid_ != 0) return;
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    const int nowhere = open("/dev/null", O_WRONLY);
    dup2(nowhere, STDOUT_FILENO);
    dup2(nowhere, STDERR_FILENO);
    // Monitoring would remove a measured side, which sends no keep-alive messages.
    execlp("iox-roudi", "iox-roudi", "--monitoring-mode", "off", nullptr);
    _exit(127);
  }
  ~RouDi() {
    kill(pid_, SIGTERM);
    waitpid(pid_, nullptr, 0);
  }
  RouDi(const RouDi&) = delete;
  RouDi& operator=(const RouDi&) = delete;

  /// Waits for the daemon's start. @throws Error if it has ended, also because another one runs
  void settle() const {
    constexpr auto kStart = std::chrono::milliseconds{300};
    std::this_thread::sleep_for(kStart);
    if (waitpid(pid_, nullptr, WNOHANG) != 0)
      throw Error{"RouDi did not start: iox-roudi is not installed or another one is running"};
  }

 private:
  pid_t pid_ = -1;
};

iox::capro::ServiceDescription service_of(bench::Side writer) {
  if (writer == bench::Side::Near) return {"rths", "peer", "near"};
  return {"rths", "peer", "far"};
}

iox::RuntimeName_t name_of(bench::Side side) {
  if (side == bench::Side::Near) return "rths_peer_near";
  return "rths_peer_far";
}

class TopicEnd {
 public:
  TopicEnd(bench::Side side, std::uint32_t bytes)
      : runtime_{iox::runtime::PoshRuntime::initRuntime(name_of(side))},
        publisher_{service_of(side)},
        subscriber_{service_of(bench::other(side))},
        bytes_{bytes} {
    const auto deadline = std::chrono::steady_clock::now() + kTimeout;
    while (!publisher_.hasSubscribers() ||
           subscriber_.getSubscriptionState() != iox::SubscribeState::SUBSCRIBED) {
      if (std::chrono::steady_clock::now() > deadline)
        throw Error{"the two sides did not discover each other"};
      std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
  }
  void send(std::uint32_t number) {
    auto chunk = publisher_.loan(bytes_);
    if (chunk.has_error()) throw Error{"RouDi has no memory left"};
    mark(chunk.value(), bytes_, number);
    publisher_.publish(chunk.value());
  }
  [[nodiscard]] bool arrived(std::uint32_t number) {
    const auto chunk = subscriber_.take();
    if (chunk.has_error()) return false;
    const std::uint32_t received = number_of(chunk.value(), bytes_);
    subscriber_.release(chunk.value());
    return received == number;
  }

 private:
  iox::runtime::PoshRuntime& runtime_;
  iox::popo::UntypedPublisher publisher_;
  iox::popo::UntypedSubscriber subscriber_;
  std::uint32_t bytes_;
};

// Ends this process by `exit`: the destructors of iceoryx's statics deregister it. RouDi aborts,
// and leaves its memory behind, if it finds that a process ended without deregistering.
[[noreturn]] void leave_roudi() { std::exit(0); }

/// An end that also ends its process on the far side.
class LastEnd : public TopicEnd {
 public:
  LastEnd(bench::Side side, std::uint32_t bytes) : TopicEnd{side, bytes}, side_{side} {}
  ~LastEnd() {
    if (side_ == bench::Side::Far) leave_roudi();
  }
  LastEnd(const LastEnd&) = delete;
  LastEnd& operator=(const LastEnd&) = delete;

 private:
  bench::Side side_;
};

bench::Times measure(const Request& request) {
  const RouDi roudi;
  roudi.settle();
  const bench::Shared<bench::Times> times;
  bench::Partner near{request.setup.cpus.near, [&] {
                        *times = bench::round_trips(request.setup, [&](bench::Side side) {
                          return LastEnd{side, request.bytes};
                        });
                        leave_roudi();
                      }};
  near.join();
  return *times;
}

}  // namespace
}  // namespace rths::peers

int main(int argc, char** argv) {
  return rths::peers::run_peer(argc, argv, {{"round_trips", rths::peers::measure}});
}
