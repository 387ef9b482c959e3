// SPDX-License-Identifier: Apache-2.0
//
// Hosts of a test: network namespaces at one switch.
#pragma once

#include <unistd.h>

#include <cstdlib>
#include <string>

#include <fmt/format.h>

namespace rths::test {

/// Network namespaces with the addresses 10.77.0.1, 10.77.0.2, …; removed at the end.
class Network {
 public:
  explicit Network(int hosts) : hosts_{hosts} {
    exists_ =
        run(fmt::format("ip netns add {0} && ip -n {0} link add switch type bridge && "
                        "ip -n {0} link set switch up",
                        switch_name()));
    for (int host = 1; exists_ && host <= hosts_; ++host)
      exists_ = run(fmt::format(
          "ip netns add {0} && ip link add eth0 netns {0} type veth peer name port{2} netns {1} && "
          "ip -n {1} link set port{2} master switch up && ip -n {0} link set lo up && "
          "ip -n {0} addr add 10.77.0.{2}/24 dev eth0 && ip -n {0} link set eth0 up",
          name(host), switch_name(), host));
  }
  ~Network() {
    for (int host = 1; host <= hosts_; ++host) run("ip netns del " + name(host));
    run("ip netns del " + switch_name());
  }
  Network(const Network&) = delete;
  Network& operator=(const Network&) = delete;

  /// False where namespaces cannot be made.
  [[nodiscard]] bool exists() const { return exists_; }
  /// Words before a command that runs on a host, from 1 on. The command keeps the process id.
  [[nodiscard]] std::string on(int host) const {
    return "nsenter --net=/run/netns/" + name(host) + " ";  // `ip netns exec` fails in a chroot
  }
  /// Cuts a host off, or connects it again. @returns false if that failed
  [[nodiscard]] bool connect(int host, bool connected) const {
    return run(
        fmt::format("ip -n {} link set port{} {}", switch_name(), host, connected ? "up" : "down"));
  }

 private:
  static bool run(const std::string& command) {
    return std::system(("(" + command + ") >/dev/null 2>&1").c_str()) == 0;
  }
  [[nodiscard]] static std::string name(int host) {
    return fmt::format("rths{}_{}", getpid(), host);
  }
  [[nodiscard]] static std::string switch_name() { return fmt::format("rths{}_switch", getpid()); }

  int hosts_;
  bool exists_ = false;
};

}  // namespace rths::test
