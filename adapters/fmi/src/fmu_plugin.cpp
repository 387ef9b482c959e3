// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <mutex>
#include <set>
#include <tuple>

#include <rths_adapter.hpp>

#include <fmt/format.h>

#include <rths/core/error.hpp>

#include <rths/fmi/fmu_calls.hpp>
#include <rths/fmi/fmu_files.hpp>
#include "bindings.hpp"
#include "fmu_config.hpp"

namespace rths::fmi {
namespace {

/// FMUs of this process that allow a single instance, by token.
class SingleInstances {
 public:
  static bool enter(const std::string& token) {
    const std::lock_guard lock{mutex()};
    return tokens().insert(token).second;
  }
  static void leave(const std::string& token) {
    const std::lock_guard lock{mutex()};
    tokens().erase(token);
  }

 private:
  static std::mutex& mutex() {
    static std::mutex one;
    return one;
  }
  static std::set<std::string>& tokens() {
    static std::set<std::string> all;
    return all;
  }
};

class FmuPlugin final : public PluginBase {
 public:
  explicit FmuPlugin(const char* text) {
    const Config config = Config::parse(text, "config");
    const std::filesystem::path folder = config.text("folder");
    description_ = read_description(folder);
    instance_ = {config.text("instance"), folder / "resources", config.flag("log", false)};
    is_solver_ = config.text("role", "") == "solver";
    step_ = config.number("step_s");
    bindings_ = read_bindings(description_, config, true);
    bind_signals();
    calls_ = load_calls(library_in(folder, description_), description_.version);
  }

  [[nodiscard]] std::vector<rths_signal> signals() const override {
    std::vector<rths_signal> signals;
    for (const auto& binding : bindings_.signals) {
      const Variable& variable = *binding.variable;
      rths_signal signal{binding.signal.c_str(),
                         binding.unit.c_str(),
                         binding.direction,
                         static_cast<std::uint32_t>(binding.is_ramped ? RTHS_RAMP : 0),
                         initial_of(binding),
                         0,
                         0};
      if (binding.direction != RTHS_INPUT && variable.lowest && variable.highest)
        std::tie(signal.lowest, signal.highest) = std::minmax(
            {binding.conversion.si(*variable.lowest), binding.conversion.si(*variable.highest)});
      signals.push_back(signal);
    }
    return signals;
  }

  void activate() override {
    if (description_.is_once_only && !SingleInstances::enter(description_.token))
      throw Error{
          "can be instantiated only once per process (canBeInstantiatedOnlyOncePerProcess): "
          "set own_process = true"};
    log_.forget_error();
    log_.rename(instance_.instance);
    const bool is_made = calls_->instantiate(description_, instance_, log_);
    if (!is_made) {
      if (description_.is_once_only) SingleInstances::leave(description_.token);
      throw Error{
          fmt::format("fmi{}Instantiate failed: {}; is the library that of this "
                      "modelDescription.xml?",
                      description_.version,
                      *log_.last_error() != '\0' ? log_.last_error() : "without a message")};
    }
    state_ = State::Instantiated;
    bool fits = true;
    for (auto& exchange : start_) {
      bool all = true;
      require(calls_->set(exchange, start_values_, all), "Set, for [start],");
      fits = fits && all;
    }
    if (!fits) {
      free_instance();
      throw Error{"a value of [start] is outside the range of its type"};
    }
    require(calls_->enter_initialization(0), "EnterInitializationMode");
    require(calls_->exit_initialization(), "ExitInitializationMode");
    state_ = State::Stepping;
    steps_ = 0;
    std::fill(tuned_.begin(), tuned_.end(), std::numeric_limits<double>::quiet_NaN());
    log_.begin_steps();
  }

  // The time of the FMU counts its own steps, so that each begins where the last one ended.
  [[nodiscard]] rths_status step(double /*time*/, const double* in, double* out) noexcept override {
    if (state_ != State::Stepping) return fail("has failed before");
    bool fits = true;
    const int set = set_inputs({in, input_count_}, fits);
    if (set > kWarning) return fail(set, "Set");
    const StepEnd end = calls_->step(static_cast<double>(steps_) * step_, step_);
    const bool is_over = end.answer > kWarning || end.fault != nullptr || end.terminates;
    const rths_status status = is_over ? conclude(end) : RTHS_OK;
    if (status == RTHS_FAULT) return status;
    ++steps_;
    for (auto& exchange : outputs_) {
      const int get = calls_->get(exchange, out);
      if (get > kWarning) return fail(get, "Get");
    }
    if (status == RTHS_DONE) return status;
    return fits ? RTHS_OK : RTHS_LIMIT_EXCEEDED;
  }

  void deactivate() noexcept override {
    if (state_ == State::Stepping) static_cast<void>(calls_->terminate());
    free_instance();
    log_.flush();
  }

  [[nodiscard]] const char* message() const noexcept override { return message_.data(); }

 private:
  enum class State { None, Instantiated, Stepping, Failed, Fatal };

  void bind_signals() {
    std::size_t outputs = 0;
    for (const auto& binding : bindings_.signals) {
      const Variable& variable = *binding.variable;
      if (binding.direction == RTHS_INPUT) {
        inputs_.add(variable, input_count_++, binding.conversion);
      } else if (binding.direction == RTHS_PARAMETER) {
        tunable_.push_back(input_count_);
        tunables_.add(variable, input_count_++, binding.conversion);
      } else {
        outputs_.add(variable, outputs++, binding.conversion);
      }
    }
    if (outputs == 0) throw Error{"no output of the FMU has a signal, expected at least one"};
    for (const auto& [variable, value] : bindings_.start) {
      start_.add(*variable, start_values_.size(), {});
      start_values_.push_back(value);
    }
    tuned_.resize(input_count_);
  }

  // Initial value of a tunable parameter, in SI.
  [[nodiscard]] double initial_of(const Binding& binding) const {
    if (binding.direction != RTHS_PARAMETER) return 0;
    double value = binding.variable->start.value_or(0);
    for (const auto& [variable, started] : bindings_.start)
      if (variable == binding.variable) value = started;
    return binding.conversion.si(value);
  }

  // A failed call leaves nothing behind.
  void require(int answer, const char* function) {
    if (answer <= kWarning) return;
    static_cast<void>(fail(answer, function));
    free_instance();
    throw Error{message_.data()};
  }

  // After a fatal error, no function of the FMU may be called.
  void free_instance() noexcept {
    if (state_ == State::None) return;
    if (state_ != State::Fatal) calls_->free_instance();
    state_ = State::None;
    if (description_.is_once_only) SingleInstances::leave(description_.token);
  }

  // Tunable parameters are set when one of them has changed.
  [[nodiscard]] int set_inputs(std::span<const double> in, bool& fits) noexcept {
    int worst = kOk;
    const auto set = [&](Exchange& exchange) {
      bool all = true;
      const int answer = calls_->set(exchange, in, all);
      worst = std::max(worst, answer);
      fits = fits && all;
    };
    bool is_tuned = false;
    for (const std::size_t index : tunable_) {
      is_tuned = is_tuned || in[index] != tuned_[index];
      tuned_[index] = in[index];
    }
    if (is_tuned)
      for (auto& exchange : tunables_) set(exchange);
    for (auto& exchange : inputs_) set(exchange);
    return worst;
  }

  [[nodiscard]] rths_status fail(int answer, const char* function) noexcept {
    state_ = answer == kFatal ? State::Fatal : (answer == kError ? State::Failed : state_);
    const char* text = log_.last_error();
    return fail("fmi{0}{1} returned fmi{0}{2}{3}{4}", description_.version, function,
                name_of_status(answer), *text != '\0' ? ": " : "", text);
  }

  template <class... Values>

  rths_status fail(fmt::format_string<Values...> text, Values&&... values) noexcept {
    const auto end = fmt::format_to_n(message_.data(), message_.size() - 1, text,
                                      std::forward<Values>(values)...)
                         .out;
    *end = '\0';
    return RTHS_FAULT;
  }

  [[nodiscard]] rths_status conclude(const StepEnd& end) noexcept {
    const double now = static_cast<double>(steps_) * step_;
    if (end.fault != nullptr) return fail("fmi{}DoStep {}", description_.version, end.fault);
    if (end.terminates) {
      if (is_solver_) return RTHS_DONE;
      return fail("asks for the end of the test, which only a solver can");
    }
    if (end.answer != kDiscard) return fail(end.answer, "DoStep");
    return fail(
        "refused the step from {:.6g} s to {:.6g} s (fmi{}Discard), computed until {:.6g} s", now,
        now + step_, description_.version, end.last_time);
  }

  ModelDescription description_;
  InstanceSettings instance_;
  bool is_solver_ = false;
  double step_ = 0;  ///< [s]
  Bindings bindings_;
  FmuLog log_;
  std::unique_ptr<Calls> calls_;
  Exchanges start_, inputs_, tunables_, outputs_;
  std::vector<double> start_values_;
  std::size_t input_count_ = 0;
  std::vector<double> tuned_;  ///< inputs at the last change of a tunable parameter
  std::vector<std::size_t> tunable_;
  State state_ = State::None;
  std::uint64_t steps_ = 0;
  std::array<char, 360> message_{};
};

}  // namespace

const rths_adapter& fmu_adapter() {
  static const rths_adapter adapter = PluginExport<FmuPlugin>::table("FMU", "2.0, 3.0", nullptr);
  return adapter;
}

}  // namespace rths::fmi
