// SPDX-License-Identifier: Apache-2.0
#include <rths/fmi/fmu_calls.hpp>

#include <dlfcn.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include <rths/fmi/fmi2.h>
#include <rths/fmi/fmi3.h>
#include <rths/core/error.hpp>
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

/// A function of a library, of whatever type.
struct FoundFunction {
  void* address;

  template <class Function>
  operator Function*() const {  // NOLINT: implicit, for the members that keep it
    return reinterpret_cast<Function*>(address);
  }
};

/// A loaded library.
struct FmuLibrary {
  void* handle;
  std::string file;

  [[nodiscard]] FoundFunction find(const std::string& name) const {
    void* const address = dlsym(handle, name.c_str());
    if (address == nullptr) throw Error{fmt::format("{}: exports no {}", file, name)};
    return {address};
  }
};

void log3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category,
          fmi3String message) {
  static_cast<FmuLog*>(environment)->add(status, category, message);
}

// The message is a format of printf.
void log2(fmi2ComponentEnvironment environment, fmi2String /*instance*/, fmi2Status status,
          fmi2String category, fmi2String message, ...) {
  if (message == nullptr || environment == nullptr) return;
  std::array<char, 400> text{};
  va_list values;
  va_start(values, message);
  std::vsnprintf(text.data(), text.size(), message, values);
  va_end(values);
  static_cast<FmuLog*>(environment)->add(status, category, text.data());
}

/// C types of the numbers of FMI 3, in the order of Type.
using Numbers = std::tuple<fmi3Float64, fmi3Float32, fmi3Int8, fmi3UInt8, fmi3Int16, fmi3UInt16,
                           fmi3Int32, fmi3UInt32, fmi3Int64, fmi3UInt64, fmi3Boolean>;
constexpr std::size_t kTypes = std::tuple_size_v<Numbers>;
static_assert(kTypes == std::size(kNumberTypes));

// Calls `visit` with zero of the C type of a number of FMI 3.
template <class Visit>
int with_type(Type type, Visit visit) noexcept {
  int answer = kError;
  const auto visit_one = [&]<std::size_t... i>(std::index_sequence<i...>) {
    return ((type == static_cast<Type>(i) &&
             (answer = visit(std::tuple_element_t<i, Numbers>{}), true)) ||
            ...);
  };
  static_cast<void>(visit_one(std::make_index_sequence<kTypes>{}));
  return answer;
}

// A path as a URI: other characters than these are written by their code.
std::string uri_of(const std::filesystem::path& path) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-._~/";
  std::string uri = "file://";
  for (const char c : path.string())
    uri += kPlain.find(c) != std::string_view::npos
               ? std::string{c}
               : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  return uri;
}

class Calls2 final : public Calls {
 public:
  explicit Calls2(FmuLibrary library) : library_{std::move(library)} {}

  bool instantiate(const ModelDescription& description, const InstanceSettings& settings,
                   FmuLog& log) override {
    callbacks_ = {log2, std::calloc, std::free, nullptr, &log};
    self_ = instantiate_(settings.instance.c_str(), fmi2CoSimulation, description.token.c_str(),
                         uri_of(settings.resources).c_str(), &callbacks_, fmi2False,
                         settings.logs ? fmi2True : fmi2False);
    return self_ != nullptr;
  }

  int enter_initialization(double start) override {
    const int answer = setup_(self_, fmi2False, 0, start, fmi2False, 0);
    return answer > kWarning ? answer : enter_(self_);
  }

  int exit_initialization() override { return exit_(self_); }

  int set(Exchange& exchange, std::span<const double> in, bool& fits) noexcept override {
    const auto* references = exchange.references.data();
    if (exchange.type == Type::Float64) {
      fits = take<fmi2Real>(exchange, in, false);
      return set_real_(self_, references, exchange.size(), exchange.values<fmi2Real>());
    }
    const bool is_truth = exchange.type == Type::Boolean;
    fits = take<fmi2Integer>(exchange, in, is_truth);
    return (is_truth ? set_boolean_ : set_integer_)(self_, references, exchange.size(),
                                                    exchange.values<fmi2Integer>());
  }

  int get(Exchange& exchange, double* out) noexcept override {
    const auto* references = exchange.references.data();
    if (exchange.type == Type::Float64) {
      forget<fmi2Real>(exchange);
      const int answer = get_real_(self_, references, exchange.size(), exchange.values<fmi2Real>());
      give<fmi2Real>(exchange, out, false);
      return answer;
    }
    const bool is_truth = exchange.type == Type::Boolean;
    const int answer = (is_truth ? get_boolean_ : get_integer_)(self_, references, exchange.size(),
                                                                exchange.values<fmi2Integer>());
    give<fmi2Integer>(exchange, out, is_truth);
    return answer;
  }

  StepEnd step(double time, double length) noexcept override {
    StepEnd end;
    end.answer = step_(self_, time, length, fmi2True);
    end.last_time = time;
    if (end.answer == kPending) end.fault = "returned fmi2Pending, expected the end of the step";
    if (end.answer != kDiscard) return end;
    fmi2Boolean terminates = fmi2False;
    if (boolean_status_(self_, fmi2Terminated, &terminates) <= fmi2Warning)
      end.terminates = terminates != fmi2False;
    if (real_status_(self_, fmi2LastSuccessfulTime, &end.last_time) > fmi2Warning)
      end.last_time = time;
    return end;
  }

  int reset() override {
    fmi2ResetTYPE* const function = library_.find("fmi2Reset");
    return function(self_);
  }
  int terminate() noexcept override { return terminate_(self_); }
  void free_instance() noexcept override { free_(self_); }

 private:
  FmuLibrary library_;
  fmi2Component self_ = nullptr;
  fmi2CallbackFunctions callbacks_{};
  fmi2InstantiateTYPE* instantiate_ = library_.find("fmi2Instantiate");
  fmi2FreeInstanceTYPE* free_ = library_.find("fmi2FreeInstance");
  fmi2SetupExperimentTYPE* setup_ = library_.find("fmi2SetupExperiment");
  fmi2EnterInitializationModeTYPE* enter_ = library_.find("fmi2EnterInitializationMode");
  fmi2ExitInitializationModeTYPE* exit_ = library_.find("fmi2ExitInitializationMode");
  fmi2TerminateTYPE* terminate_ = library_.find("fmi2Terminate");
  fmi2DoStepTYPE* step_ = library_.find("fmi2DoStep");
  fmi2GetRealStatusTYPE* real_status_ = library_.find("fmi2GetRealStatus");
  fmi2GetBooleanStatusTYPE* boolean_status_ = library_.find("fmi2GetBooleanStatus");
  fmi2GetRealTYPE* get_real_ = library_.find("fmi2GetReal");
  fmi2SetRealTYPE* set_real_ = library_.find("fmi2SetReal");
  fmi2GetIntegerTYPE* get_integer_ = library_.find("fmi2GetInteger");
  fmi2SetIntegerTYPE* set_integer_ = library_.find("fmi2SetInteger");
  fmi2GetBooleanTYPE* get_boolean_ = library_.find("fmi2GetBoolean");
  fmi2SetBooleanTYPE* set_boolean_ = library_.find("fmi2SetBoolean");
};

// Without event mode, early return and intermediate update.
class Calls3 final : public Calls {
 public:
  explicit Calls3(FmuLibrary library) : library_{std::move(library)} {
    for (std::size_t i = 0; i < kTypes; ++i) {
      getters_[i] = library_.find(fmt::format("fmi3Get{}", kNumberTypes[i]));
      setters_[i] = library_.find(fmt::format("fmi3Set{}", kNumberTypes[i]));
    }
  }

  bool instantiate(const ModelDescription& description, const InstanceSettings& settings,
                   FmuLog& log) override {
    const std::string resources = settings.resources.string() + "/";
    self_ = instantiate_(settings.instance.c_str(), description.token.c_str(), resources.c_str(),
                         false, settings.logs, false, false, nullptr, 0, &log, log3, nullptr);
    return self_ != nullptr;
  }

  int enter_initialization(double start) override {
    return enter_(self_, false, 0, start, false, 0);
  }
  int exit_initialization() override { return exit_(self_); }

  int set(Exchange& exchange, std::span<const double> in, bool& fits) noexcept override {
    return with_type(exchange.type, [&](auto zero) {
      using Value = decltype(zero);
      using Setter = fmi3Status(fmi3Instance, const fmi3ValueReference*, std::size_t, const Value*,
                                std::size_t);
      fits = take<Value>(exchange, in, std::is_same_v<Value, bool>);
      const auto setter =
          reinterpret_cast<Setter*>(setters_[static_cast<std::size_t>(exchange.type)]);
      return static_cast<int>(setter(self_, exchange.references.data(), exchange.size(),
                                     exchange.values<Value>(), exchange.size()));
    });
  }

  int get(Exchange& exchange, double* out) noexcept override {
    return with_type(exchange.type, [&](auto zero) {
      using Value = decltype(zero);
      using Getter =
          fmi3Status(fmi3Instance, const fmi3ValueReference*, std::size_t, Value*, std::size_t);
      const auto getter =
          reinterpret_cast<Getter*>(getters_[static_cast<std::size_t>(exchange.type)]);
      forget<Value>(exchange);
      const int answer = getter(self_, exchange.references.data(), exchange.size(),
                                exchange.values<Value>(), exchange.size());
      give<Value>(exchange, out, std::is_same_v<Value, bool>);
      return answer;
    });
  }

  StepEnd step(double time, double length) noexcept override {
    StepEnd end;
    fmi3Boolean needs_event = false, terminates = false, returned_early = false;
    fmi3Float64 last_time = time;
    end.answer =
        step_(self_, time, length, true, &needs_event, &terminates, &returned_early, &last_time);
    end.last_time = last_time;
    end.terminates = terminates;
    if (needs_event) end.fault = "asks for event mode, which is not supported";
    if (returned_early) end.fault = "returned early, which is not supported";
    return end;
  }

  int reset() override {
    fmi3ResetTYPE* const function = library_.find("fmi3Reset");
    return function(self_);
  }
  int terminate() noexcept override { return terminate_(self_); }
  void free_instance() noexcept override { free_(self_); }

 private:
  FmuLibrary library_;
  using Function = void();
  fmi3Instance self_ = nullptr;
  fmi3InstantiateCoSimulationTYPE* instantiate_ = library_.find("fmi3InstantiateCoSimulation");
  fmi3FreeInstanceTYPE* free_ = library_.find("fmi3FreeInstance");
  fmi3EnterInitializationModeTYPE* enter_ = library_.find("fmi3EnterInitializationMode");
  fmi3ExitInitializationModeTYPE* exit_ = library_.find("fmi3ExitInitializationMode");
  fmi3TerminateTYPE* terminate_ = library_.find("fmi3Terminate");
  fmi3DoStepTYPE* step_ = library_.find("fmi3DoStep");
  std::array<Function*, kTypes> getters_{}, setters_{};  ///< by type
};

}  // namespace

std::unique_ptr<Calls> load_calls(const std::filesystem::path& library, int version) {
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) throw Error{fmt::format("cannot load its library: {}", dlerror())};
  const FmuLibrary loaded{handle, library.filename().string()};
  if (version == 2) return std::make_unique<Calls2>(loaded);
  return std::make_unique<Calls3>(loaded);
}

const char* name_of_status(int status) noexcept {
  constexpr const char* kNames[] = {"OK", "Warning", "Discard", "Error", "Fatal", "Pending"};
  return status >= kOk && status <= kPending ? kNames[status] : "an unknown status";
}

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
