// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include <rths/fmi/exchange.hpp>
#include <rths/fmi/model_description.hpp>

namespace rths::fmi {

/// Status of a call, with the numbers of both versions of the standard.
enum FmiStatus : int { kOk, kWarning, kDiscard, kError, kFatal, kPending };

/// "Discard"; "an unknown status" for other numbers.   @realtime
[[nodiscard]] const char* name_of_status(int status) noexcept;

/// Messages of an FMU. They go to standard error with the name of the instance. Those of a step are
/// kept, and printed by `flush`.
class FmuLog {
 public:
  void rename(const std::string& instance) { instance_ = instance; }

  /// Any thread. Of two threads at once, one loses its message.   @realtime during steps
  void add(int status, const char* category, const char* message) noexcept;
  /// From now on, messages are kept.
  void begin_steps() noexcept;
  /// Prints what was kept; later messages are printed at once.   @setup
  void flush();
  /// The last message of an error or a refusal; empty without one.
  [[nodiscard]] const char* last_error() const noexcept { return last_error_.data(); }
  void forget_error() noexcept { last_error_[0] = '\0'; }

 private:
  using Text = std::array<char, 240>;
  void lock() noexcept;

  std::string instance_;
  std::atomic_flag busy_ = ATOMIC_FLAG_INIT;
  bool keeps_ = false;
  std::array<Text, 64> kept_{};
  std::size_t count_ = 0, lost_ = 0;
  Text last_error_{};
};

/// How a step ended.
struct StepEnd {
  int answer = kOk;
  double last_time = 0;         ///< until which a refused step was computed [s]
  bool terminates = false;      ///< the FMU asks for the end of the test
  const char* fault = nullptr;  ///< against the agreement of `instantiate`
};

/// Of an instance.
struct InstanceSettings {
  std::string instance;             ///< its name
  std::filesystem::path resources;  ///< absolute
  bool logs = false;                ///< debug messages
};

/// The functions of one FMU, the same for both versions of the standard, and its instance. Their
/// results are an FmiStatus.
class Calls {
 public:
  virtual ~Calls() = default;
  /// @returns whether there is an instance   @setup
  [[nodiscard]] virtual bool instantiate(const ModelDescription& description,
                                         const InstanceSettings& settings, FmuLog& log) = 0;
  /// @param start  time of the first step [s]
  [[nodiscard]] virtual int enter_initialization(double start) = 0;
  [[nodiscard]] virtual int exit_initialization() = 0;
  [[nodiscard]] virtual int set(Exchange& exchange, std::span<const double> in,
                                bool& fits) noexcept = 0;
  [[nodiscard]] virtual int get(Exchange& exchange, double* out) noexcept = 0;
  [[nodiscard]] virtual StepEnd step(double time, double length) noexcept = 0;
  /// Returns to the state after `instantiate`.
  /// @throws Error if the library has no such function   @setup
  [[nodiscard]] virtual int reset() = 0;
  virtual int terminate() noexcept = 0;
  virtual void free_instance() noexcept = 0;
};

/// Loads an FMU's library, which stays loaded until the process ends.
/// @throws Error if it cannot be loaded, or lacks a function   @setup
[[nodiscard]] std::unique_ptr<Calls> load_calls(const std::filesystem::path& library, int version);

}  // namespace rths::fmi
