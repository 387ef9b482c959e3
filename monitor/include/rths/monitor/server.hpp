// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <rths/recording/roles.hpp>

namespace rths::monitor {

/// Limits of the safety layer of an axis. An infinite one is off.
struct ShownLimits {
  std::string axis;         ///< as the roles name it
  double displacement = 0;  ///< ± [m]
  double force = 0;         ///< ± [N]
  double tracking = 0;      ///< measured motion from the command ± [m]
};

/// What a server shows, and to whom.
struct ServerSettings {
  std::string ring;            ///< empty: the first ring of this host
  std::string listen;          ///< address of an interface; empty: loopback
  std::uint16_t port = 0;      ///< 0: a free one
  std::string token;           ///< for other hosts, and for changes; empty: nobody may
  bool controls = false;       ///< parameters can be changed
  std::filesystem::path runs;  ///< folder with the results of runs; empty: none
  std::function<recording::Roles(const memmap::Map&)> roles_of;  ///< words of the test
  std::vector<ShownLimits> limits;
  std::size_t history_bytes = std::size_t{128} << 20U;
  /// Compares the runs of two folders: a text. May throw Error; empty: nothing is compared.
  std::function<std::string(const std::filesystem::path&, const std::filesystem::path&)> compare;
};

/// Serves a page with a ring, live. It looks at the ring from outside: see `RingLook`. Waits for
/// the ring, also for one that replaces it.
class PageServer {
 public:
  /// At most so many pages are connected at a time.
  static constexpr int kMostViewers = 50;

  /// @throws Error if the port cannot be used, or other hosts could view without a token   @setup
  explicit PageServer(ServerSettings settings);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  [[nodiscard]] std::uint16_t port() const;
  /// Address of the page for a browser of this host, with the token if there is one.
  [[nodiscard]] std::string url() const;
  /// Pages that are connected.   @any_thread
  [[nodiscard]] int viewers() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rths::monitor
