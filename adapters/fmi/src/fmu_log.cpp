// SPDX-License-Identifier: Apache-2.0
#include "fmu_log.hpp"

#include <cstdio>
#include <cstring>
#include <thread>

#include <fmt/format.h>

#include <rths/core/message.hpp>

namespace rths::fmi {
namespace {

constexpr const char* kStatusNames[] = {"", "warning: ", "discard: ", "error: ", "fatal: "};

// One line, without control characters.
template <class Text>
void put(Text& text, const char* prefix, const char* message) noexcept {
  const auto written = std::snprintf(text.data(), text.size(), "%s%s", prefix, message);
  if (written < 0) text[0] = '\0';
  for (char& c : text)
    if (c != '\0' && static_cast<unsigned char>(c) < ' ') c = ' ';
  for (std::size_t end = std::strlen(text.data()); end > 0 && text[end - 1] == ' '; --end)
    text[end - 1] = '\0';
}

}  // namespace

void FmuLog::add(int status, const char* /*category*/, const char* message) noexcept {
  if (message == nullptr || busy_.test_and_set(std::memory_order_acquire)) return;
  const bool is_known = status >= 0 && status <= kFatal;
  const char* prefix = is_known ? kStatusNames[status] : "";
  if (status >= kDiscard) put(last_error_, "", message);
  if (!keeps_) {
    Text text{};
    put(text, prefix, message);
    std::fprintf(stderr, "%s: FMU: %s\n", instance_.c_str(), text.data());
  } else if (count_ < kept_.size()) {
    put(kept_[count_++], prefix, message);
  } else {
    ++lost_;
  }
  busy_.clear(std::memory_order_release);
}

void FmuLog::lock() noexcept {
  while (busy_.test_and_set(std::memory_order_acquire)) std::this_thread::yield();
}

void FmuLog::begin_steps() noexcept {
  lock();
  keeps_ = true;
  busy_.clear(std::memory_order_release);
}

void FmuLog::flush() {
  lock();
  keeps_ = false;
  for (std::size_t i = 0; i < count_; ++i)
    write_message(fmt::format("{}: FMU: {}\n", instance_, kept_[i].data()));
  if (lost_ > 0)
    write_message(fmt::format("{}: FMU: {} further messages of its steps\n", instance_, lost_));
  count_ = lost_ = 0;
  busy_.clear(std::memory_order_release);
}

}  // namespace rths::fmi
