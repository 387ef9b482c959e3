// SPDX-License-Identifier: Apache-2.0
//
// rths_adapter.h for C++17 and later: derive from rths::PluginBase and export it with one line.
//
//     class Machine final : public rths::PluginBase { … };
//     RTHS_EXPORT_ADAPTER(Machine, "machine", "1.0")
//
// The class needs a constructor from the TOML text of its `config`. Exceptions of [setup] functions
// become messages. The common case, an adapter without settings, is a struct of the state and its
// step; the signals are an array:
//
//     struct Machine {
//       rths_status step(double time_s, const double* in, double* out) noexcept { … }
//     };
//     RTHS_SIMPLE_ADAPTER(Machine, "machine", "1.0", kSignals)
#pragma once

#include <cstdint>
#include <cstdio>
#include <exception>
#include <iterator>
#include <memory>
#include <vector>

#include "rths_adapter.h"

namespace rths {

/// An adapter in a shared library; see rths_adapter.h for each function.
class PluginBase {
 public:
  virtual ~PluginBase() = default;
  [[nodiscard]] virtual std::vector<rths_signal> signals() const = 0;
  virtual void activate() {}
  [[nodiscard]] virtual rths_status step(double time_s, const double* in, double* out) noexcept = 0;
  virtual void deactivate() noexcept {}
  /// Called by the host with RTHS_EXPORT_ADAPTER_WITH_STOP only.
  virtual void stop() noexcept {}
  [[nodiscard]] virtual const char* message() const noexcept { return ""; }
};

/// An adapter without settings. `activate` takes the initial values of its state.
template <class State, const auto& kSignals>
class SimplePlugin final : public PluginBase {
 public:
  explicit SimplePlugin(const char* /*config_toml*/) {}
  [[nodiscard]] std::vector<rths_signal> signals() const override {
    return {std::begin(kSignals), std::end(kSignals)};
  }
  void activate() override { state_ = State{}; }
  [[nodiscard]] rths_status step(double time_s, const double* in, double* out) noexcept override {
    return state_.step(time_s, in, out);
  }

 private:
  State state_{};
};

/// The functions of rths_adapter for one class.
template <class Plugin>
struct PluginExport {
  std::unique_ptr<PluginBase> plugin;
  std::vector<rths_signal> signals;

  static PluginExport& of(void* self) noexcept { return *static_cast<PluginExport*>(self); }
  template <class Call>
  static bool tried(char* error, std::uint32_t size, Call call) noexcept {
    try {
      call();
      return true;
    } catch (const std::exception& reason) {
      std::snprintf(error, size, "%s", reason.what());
    } catch (...) {
      std::snprintf(error, size, "an exception without text");
    }
    return false;
  }
  static void* create(const char* config, char* error, std::uint32_t size) noexcept {
    std::unique_ptr<PluginExport> made;
    const bool good = tried(error, size, [&] {
      made = std::make_unique<PluginExport>();
      made->plugin = std::make_unique<Plugin>(config);
      made->signals = made->plugin->signals();
    });
    return good ? made.release() : nullptr;
  }
  static const rths_signal* list(void* self, std::uint32_t* count) noexcept {
    *count = static_cast<std::uint32_t>(of(self).signals.size());
    return of(self).signals.data();
  }
  static rths_status activate(void* self, char* error, std::uint32_t size) noexcept {
    return tried(error, size, [&] { of(self).plugin->activate(); }) ? RTHS_OK : RTHS_FAULT;
  }
  static rths_status step(void* self, double time, const double* in, double* out) noexcept {
    return of(self).plugin->step(time, in, out);
  }
  static void deactivate(void* self) noexcept { of(self).plugin->deactivate(); }
  static void destroy(void* self) noexcept {
    delete static_cast<PluginExport*>(self);  // NOLINT(cppcoreguidelines-owning-memory): of create
  }
  static void stop(void* self) noexcept { of(self).plugin->stop(); }
  static const char* message(void* self) noexcept { return of(self).plugin->message(); }

  /// Their table. A null `stop`: the host ramps outputs with RTHS_RAMP to rest.
  static rths_adapter table(const char* name, const char* version, void (*its_stop)(void*)) {
    return {RTHS_ADAPTER_ABI,
            sizeof(rths_adapter),
            name,
            version,
            create,
            list,
            activate,
            step,
            deactivate,
            destroy,
            its_stop,
            message};
  }
};

}  // namespace rths

/// Defines rths_adapter_entry; for the two macros below.
#define RTHS_EXPORT_ADAPTER_(PLUGIN, NAME, VERSION, STOP)                                       \
  extern "C" const rths_adapter* rths_adapter_entry(void) {                                     \
    static const rths_adapter adapter = rths::PluginExport<PLUGIN>::table(NAME, VERSION, STOP); \
    return &adapter;                                                                            \
  }

/// The host ramps outputs with RTHS_RAMP to rest.
#define RTHS_EXPORT_ADAPTER(PLUGIN, NAME, VERSION) \
  RTHS_EXPORT_ADAPTER_(PLUGIN, NAME, VERSION, nullptr)
/// The adapter overrides `stop` and comes to rest by itself.
#define RTHS_EXPORT_ADAPTER_WITH_STOP(PLUGIN, NAME, VERSION) \
  RTHS_EXPORT_ADAPTER_(PLUGIN, NAME, VERSION, rths::PluginExport<PLUGIN>::stop)
/// An adapter without settings: a struct with `step`, and its array of signals.
#define RTHS_SIMPLE_ADAPTER(STATE, NAME, VERSION, SIGNALS)        \
  using RthsSimplePlugin_ = rths::SimplePlugin<STATE, (SIGNALS)>; \
  RTHS_EXPORT_ADAPTER(RthsSimplePlugin_, NAME, VERSION)
