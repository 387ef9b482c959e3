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
  /// @param has_switch  false: the ports of the hosts are not connected, for a switch of the test
  explicit Network(int hosts, bool has_switch = true) : hosts_{hosts}, has_switch_{has_switch} {
    exists_ = run("ip netns add " + switch_name()) &&
              run_in(switch_name(), "link add switch type bridge") &&
              run_in(switch_name(), "link set switch up");
    for (int host = 1; exists_ && host <= hosts_; ++host) exists_ = add(host);
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
  [[nodiscard]] static std::string on(int host) { return in(name(host)) + " "; }
  /// Cuts a host off, or connects it again. @returns false if that failed
  [[nodiscard]] static bool connect(int host, bool connected) {
    return run_in(switch_name(),
                  fmt::format("link set port{} {}", host, connected ? "up" : "down"));
  }

  /// The namespace with the ports "port1", "port2", … of the hosts.
  [[nodiscard]] static std::string ports() { return "/run/netns/" + switch_name(); }
  /// Runs `ip` on a host. @returns false if that failed
  [[nodiscard]] static bool configure(int host, const std::string& words) {
    return run_in(name(host), words);
  }

 private:
  [[nodiscard]] bool add(int host) const {
    const std::string its = name(host);
    return run("ip netns add " + its) &&
           run(fmt::format("ip link add eth0 netns {} type veth peer name port{} netns {}", its,
                           host, switch_name())) &&
           run_in(switch_name(),
                  fmt::format("link set port{} {} up", host, has_switch_ ? "master switch" : "")) &&
           run_in(its, "link set lo up") &&
           run_in(its, fmt::format("addr add 10.77.0.{}/24 dev eth0", host)) &&
           run_in(its, "link set eth0 up");
  }
  static bool run(const std::string& command) {
    return std::system(("(" + command + ") >/dev/null 2>&1").c_str()) == 0;
  }
  static bool run_in(const std::string& network, const std::string& words) {
    return run(in(network) + " ip " + words);
  }
  // `ip -n` and `ip netns exec` fail in a chroot.
  static std::string in(const std::string& network) {
    return "nsenter --net=/run/netns/" + network;
  }
  static std::string name(int host) { return fmt::format("rths{}_{}", getpid(), host); }
  static std::string switch_name() { return fmt::format("rths{}_switch", getpid()); }

  int hosts_;
  bool has_switch_;
  bool exists_ = false;
};

}  // namespace rths::test
