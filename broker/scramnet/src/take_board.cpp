// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <cstdlib>
#include <memory>
#include <mutex>

#include "board.hpp"

namespace rths::scramnet {
namespace {

// The vendor's C interface has no handles, so a process has one card. It is never destroyed, since
// clients may call from destructors that run after ours. At exit it only leaves the ring.
std::atomic<Board*> the_board{nullptr};
std::mutex taking;

BoardError take() noexcept {
  Settings settings;
  try {
    settings = plus_settings();
  } catch (const std::exception& error) {
    warn_once("settings", error.what());
    return BoardError::Configuration;
  }
  try {
    the_board.store(std::make_unique<Board>(settings).release());
    std::atexit([] { the_board.load()->leave(); });
    return BoardError::None;
  } catch (const std::exception& error) {
    warn_once("ring", error.what());
    return BoardError::Driver;
  }
}

}  // namespace

Board* board() noexcept { return the_board.load(std::memory_order_acquire); }

Board* take_board(BoardError& error) noexcept {
  const std::lock_guard lock{taking};
  error = BoardError::None;
  if (board() == nullptr) error = take();
  return board();
}

}  // namespace rths::scramnet
