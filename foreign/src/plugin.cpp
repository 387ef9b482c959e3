// SPDX-License-Identifier: Apache-2.0
#include <rths/foreign/plugin.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <sstream>

#include <fmt/format.h>

#include <rths/core/config.hpp>
#include <rths/core/error.hpp>
#include <rths/core/text.hpp>
#include <rths/memmap/units.hpp>
#include <rths/plugin/library.hpp>

#include "child.hpp"
#include "forked_runs.hpp"

namespace rths::foreign {
namespace {

constexpr const char* kSignals = "signals";
constexpr const char* kOfConfig = "config.";  // a parameter that is a key of the configuration
constexpr std::uint32_t kErrorSize = 1000;    // of a message [bytes]
constexpr double kSameStep = 1e-6;            // of the interval of the rows

bool is_of_config(const std::string& parameter) { return parameter.starts_with(kOfConfig); }

/// An adapter of a plugin, made in this process.
class Instance {
 public:
  Instance(const std::filesystem::path& file, const std::string& config)
      : file_{plugin::plugin_file(file, config)},
        library_{file_.library},
        adapter_{library_.adapter()},
        self_{adapter_.create(file_.config.c_str(), error_.data(), kErrorSize)} {
    if (self_ == nullptr) throw Error{fmt::format("create failed: {}", text_of_error())};
  }
  ~Instance() {
    if (is_active_) adapter_.deactivate(self_);
    adapter_.destroy(self_);
  }
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  [[nodiscard]] std::span<const rths_signal> signals() const {
    std::uint32_t count = 0;
    const rths_signal* const all = adapter_.signals(self_, &count);
    if (all == nullptr || count == 0 || count > plugin::kMostSignals)
      throw Error{fmt::format("has {} signals, expected 1 to {}", count, plugin::kMostSignals)};
    return {all, count};
  }
  void activate() {
    if (adapter_.activate(self_, error_.data(), kErrorSize) == RTHS_FAULT)
      throw Error{fmt::format("activate failed: {}", text_of_error())};
    is_active_ = true;
  }
  /// @returns whether it has finished
  bool step(double time, const double* in, double* out) {
    const rths_status status = adapter_.step(self_, time, in, out);
    if (status < RTHS_OK || status >= RTHS_FAULT) {
      const auto message = library_.message();
      const char* const reason = message == nullptr ? nullptr : message(self_);
      throw Error{fmt::format("returned {} at {:g} s{}{}",
                              status == RTHS_FAULT ? "RTHS_FAULT" : std::to_string(status), time,
                              reason == nullptr ? "" : ": ", reason == nullptr ? "" : reason)};
    }
    return status == RTHS_DONE;
  }

 private:
  [[nodiscard]] std::string text_of_error() const {
    const std::string text{error_.data(), strnlen(error_.data(), kErrorSize)};
    return text.empty() ? "without a message" : text;
  }

  plugin::PluginFile file_;
  plugin::Library library_;
  const rths_adapter& adapter_;
  std::array<char, kErrorSize> error_{};
  void* self_;
  bool is_active_ = false;
};

/// Where the values of a run lie in the arrays of a step.
struct Places {
  std::vector<std::size_t> inputs, outputs;
  std::vector<std::optional<std::size_t>> parameters;  ///< none: a key of the configuration
  struct Port {
    std::size_t force = 0, displacement = 0;
    std::optional<std::size_t> velocity;
  };
  std::vector<Port> ports;
  std::vector<double> in;  ///< at their initial values, as at the start
  std::size_t out = 0;     ///< values of a step
};

class PlaceReader {
 public:
  PlaceReader(const PluginRunSettings& settings, const std::vector<PluginSignal>& signals)
      : settings_{settings}, signals_{signals} {}

  Places read() {
    for (const auto& signal : signals_)
      if (plugin::is_read(signal))
        found_.in.push_back(signal.initial);
      else
        ++found_.out;
    has_value_.resize(found_.in.size());
    for (const auto& name : settings_.inputs) found_.inputs.push_back(place_of(name, true));
    for (const auto& name : settings_.outputs) found_.outputs.push_back(place_of(name, false));
    for (const auto& name : settings_.parameters)
      found_.parameters.push_back(is_of_config(name) ? std::nullopt
                                                     : std::optional{place_of(name, true)});
    for (const auto& [name, value] : settings_.start) found_.in[place_of(name, true)] = value;
    for (const auto& port : settings_.ports)
      found_.ports.push_back(
          {place_of(port.force, true), place_of(port.displacement, false),
           port.velocity.empty() ? std::nullopt : std::optional{place_of(port.velocity, false)}});
    check_inputs();
    return std::move(found_);
  }

 private:
  std::size_t place_of(const std::string& name, bool is_input) {
    std::size_t place = 0;
    std::vector<std::string> known;
    for (const auto& signal : signals_) {
      if (plugin::is_read(signal) != is_input) continue;
      if (signal.name == name) {
        if (is_input) has_value_[place] = true;
        return place;
      }
      known.push_back(signal.name);
      ++place;
    }
    throw Error{fmt::format("the plugin has no {} '{}'{}",
                            is_input ? "input or parameter" : "output or monitor", name,
                            did_you_mean_one_of(name, known))};
  }
  void check_inputs() const {
    std::size_t place = 0;
    for (const auto& signal : signals_) {
      if (!plugin::is_read(signal)) continue;
      if (signal.direction == RTHS_INPUT && !has_value_[place])
        throw Error{fmt::format(
            "input '{}' has no value, expected it in inputs, or a constant value in start",
            signal.name)};
      ++place;
    }
  }

  const PluginRunSettings& settings_;
  const std::vector<PluginSignal>& signals_;
  Places found_;
  std::vector<bool> has_value_;
};

/// One run, from the first row to the last.
class PluginRun {
 public:
  PluginRun(const PluginRunSettings& settings, const Places& places, const RunInputs& inputs,
            double* results)
      : settings_{settings},
        places_{places},
        inputs_{inputs},
        results_{results},
        divisions_{divisions_of(settings.step, inputs.time_step)},
        step_{inputs.time_step / static_cast<double>(divisions_)},
        in_{places.in},
        out_(places.out),
        forces_(places.ports.size()),
        last_displacement_(places.ports.size()) {
    if (!inputs.law.key.empty()) law_ = inputs.law.begin(step_);
  }

  void run() {
    Instance instance{settings_.file, config()};
    const auto signals = instance.signals();
    const auto read = static_cast<std::size_t>(std::count_if(
        signals.begin(), signals.end(), [](const auto& one) { return plugin::is_read(one); }));
    if (read != in_.size() || signals.size() - read != out_.size())
      throw Error{"has other signals than at the start of the diagnosis"};
    for (std::size_t i = 0; i < places_.parameters.size(); ++i)
      if (const auto place = places_.parameters[i]) in_[*place] = inputs_.parameters[i];
    instance.activate();
    bool is_done = false;
    for (std::size_t k = 0; k / divisions_ < inputs_.rows; ++k) {
      const double time = static_cast<double>(k) * step_;
      if (!is_done) {
        take_inputs(time);
        is_done = instance.step(time, in_.data(), out_.data());
        next_forces(time, k > 0);
      }
      if (k % divisions_ == 0) write_row(k / divisions_, time);
    }
  }

 private:
  static std::size_t divisions_of(double step, double interval) {
    const double count = step > 0 ? std::round(interval / step) : 1;
    if (count < 1 || (step > 0 && std::abs(count * step - interval) > kSameStep * interval))
      throw Error{fmt::format(
          "step_s is {:g}, expected the interval of the record, {:g} s, or a whole part of it",
          step, interval)};
    return static_cast<std::size_t>(count);
  }

  [[nodiscard]] std::string config() const {
    Config table = Config::parse(settings_.config, "config");
    for (std::size_t i = 0; i < settings_.parameters.size(); ++i)
      if (const auto& name = settings_.parameters[i]; is_of_config(name))
        table.set(name.substr(std::string_view{kOfConfig}.size()),
                  fmt::format("{:.17e}", inputs_.parameters[i]));
    return table.to_toml();
  }

  void take_inputs(double time) {
    for (const auto& port : places_.ports) in_[port.force] = places_.in[port.force];
    for (std::size_t i = 0; i < places_.inputs.size(); ++i)
      in_[places_.inputs[i]] =
          value_at(inputs_.inputs[i], time / inputs_.time_step, settings_.holds_inputs);
    for (std::size_t i = 0; i < forces_.size(); ++i)
      in_[places_.ports[i].force] -= 2 * forces_[i].now - forces_[i].before;
  }

  void next_forces(double time, bool has_rate) {
    for (std::size_t i = 0; i < forces_.size() && law_; ++i) {
      const auto& port = places_.ports[i];
      PortMotion motion{inputs_.start + time, out_[port.displacement], 0};
      if (port.velocity)
        motion.velocity = out_[*port.velocity];
      else if (has_rate)
        motion.velocity = (motion.displacement - last_displacement_[i]) / step_;
      last_displacement_[i] = motion.displacement;
      const double force = law_->next(i, motion);
      forces_[i] = {force, has_rate ? forces_[i].now : force};
    }
  }

  void write_row(std::size_t row, double time) {
    for (std::size_t i = 0; i < places_.outputs.size(); ++i) {
      const double value = out_[places_.outputs[i]];
      if (!std::isfinite(value))
        throw Error{fmt::format("'{}' is {} at {:g} s, expected a finite number",
                                settings_.outputs[i], value, time)};
      results_[i * inputs_.rows + row] = value;
    }
  }

  struct Force {
    double now = 0, before = 0;
  };

  const PluginRunSettings& settings_;
  const Places& places_;
  const RunInputs& inputs_;
  double* results_;
  std::size_t divisions_;
  double step_;
  std::vector<double> in_, out_;
  std::vector<Force> forces_;
  std::vector<double> last_displacement_;
  std::unique_ptr<PortForces> law_;
};

class PluginSimulation final : public ForkedSimulation {
 public:
  PluginSimulation(PluginRunSettings settings, const std::vector<PluginSignal>& signals)
      : settings_{std::move(settings)}, places_{PlaceReader{settings_, signals}.read()} {}

 private:
  [[nodiscard]] std::vector<RunOutputs> run_forked_once(
      std::span<const RunInputs* const> all) const override {
    const auto run = [&](const RunInputs& inputs, double* results) {
      PluginRun{settings_, places_, inputs, results}.run();
    };
    return ForkedRuns{settings_.file.string(), settings_.outputs.size(), settings_.deadline, run}
        .results(all);
  }

  PluginRunSettings settings_;
  Places places_;
};

}  // namespace

std::vector<PluginSignal> plugin_signals(const std::filesystem::path& file,
                                         const std::string& config, double deadline) {
  const TemporaryRun folder;
  const auto list = [&] {
    const Instance instance{file, config};
    std::string text;
    for (const auto& signal : instance.signals()) {
      const std::string name = signal.name == nullptr ? "" : signal.name;
      if (name.empty() || name.find('\n') != std::string::npos)
        throw Error{"has a signal without a name"};
      text += fmt::format("{} {:.17g} {}\n{}\n", signal.direction, signal.initial,
                          signal.unit == nullptr ? "" : signal.unit, name);
    }
    folder.write(kSignals, text);
  };
  const ChildEnding ending = run_forked(list, folder.path(), deadline);
  if (!ending.trouble.empty()) throw Error{told(file.string(), ending)};
  std::vector<PluginSignal> signals;
  std::ifstream lines{folder.path() / kSignals};
  for (std::string numbers, name; std::getline(lines, numbers) && std::getline(lines, name);) {
    PluginSignal signal{name, "", 0, 0};
    std::string unit;
    std::istringstream{numbers} >> signal.direction >> signal.initial >> unit;
    try {
      signal.unit = memmap::parse_unit(unit).si;
    } catch (const Error& error) {
      throw Error{fmt::format("{}: unit of '{}': {}", file.string(), name, error.what())};
    }
    signals.push_back(std::move(signal));
  }
  return signals;
}

std::unique_ptr<Simulation> make_plugin(PluginRunSettings settings,
                                        const std::vector<PluginSignal>& signals) {
  return std::make_unique<PluginSimulation>(std::move(settings), signals);
}

}  // namespace rths::foreign
