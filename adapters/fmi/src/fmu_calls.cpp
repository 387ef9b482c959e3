// SPDX-License-Identifier: Apache-2.0
#include "fmu_calls.hpp"

#include <dlfcn.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <type_traits>

#include <fmt/format.h>

#include <rths/core/error.hpp>

namespace rths::fmi {
namespace {

template <class Function>
void look_up(void* library, const std::string& file, const std::string& name, Function*& function) {
  function = reinterpret_cast<Function*>(dlsym(library, name.c_str()));
  if (function == nullptr) throw Error{fmt::format("{}: exports no {}", file, name)};
}

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

template <class T>
struct Tag {
  using Value = T;
};

// Calls `visit` with the C type of a number of FMI 3.
template <class Visit>
int with_type(Type type, Visit visit) noexcept {
  switch (type) {
    case Type::Float64:
      return visit(Tag<fmi3Float64>{});
    case Type::Float32:
      return visit(Tag<fmi3Float32>{});
    case Type::Int8:
      return visit(Tag<fmi3Int8>{});
    case Type::UInt8:
      return visit(Tag<fmi3UInt8>{});
    case Type::Int16:
      return visit(Tag<fmi3Int16>{});
    case Type::UInt16:
      return visit(Tag<fmi3UInt16>{});
    case Type::Int32:
      return visit(Tag<fmi3Int32>{});
    case Type::UInt32:
      return visit(Tag<fmi3UInt32>{});
    case Type::Int64:
      return visit(Tag<fmi3Int64>{});
    case Type::UInt64:
      return visit(Tag<fmi3UInt64>{});
    case Type::Boolean:
      return visit(Tag<fmi3Boolean>{});
    default:
      return kError;
  }
}

constexpr const char* kTypeNames[] = {"Float64", "Float32", "Int8",  "UInt8",  "Int16",  "UInt16",
                                      "Int32",   "UInt32",  "Int64", "UInt64", "Boolean"};

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

}  // namespace

void Calls2::load(void* library, const std::string& file) {
  look_up(library, file, "fmi2Instantiate", instantiate_);
  look_up(library, file, "fmi2FreeInstance", free_);
  look_up(library, file, "fmi2SetupExperiment", setup_);
  look_up(library, file, "fmi2EnterInitializationMode", enter_);
  look_up(library, file, "fmi2ExitInitializationMode", exit_);
  look_up(library, file, "fmi2Terminate", terminate_);
  look_up(library, file, "fmi2DoStep", step_);
  look_up(library, file, "fmi2GetRealStatus", real_status_);
  look_up(library, file, "fmi2GetBooleanStatus", boolean_status_);
  look_up(library, file, "fmi2GetReal", get_real_);
  look_up(library, file, "fmi2SetReal", set_real_);
  look_up(library, file, "fmi2GetInteger", get_integer_);
  look_up(library, file, "fmi2SetInteger", set_integer_);
  look_up(library, file, "fmi2GetBoolean", get_boolean_);
  look_up(library, file, "fmi2SetBoolean", set_boolean_);
}

bool Calls2::instantiate(const ModelDescription& description, const InstanceSettings& settings,
                         FmuLog& log) {
  callbacks_ = {log2, std::calloc, std::free, nullptr, &log};
  self_ = instantiate_(settings.instance.c_str(), fmi2CoSimulation, description.token.c_str(),
                       uri_of(settings.resources).c_str(), &callbacks_, fmi2False,
                       settings.logs ? fmi2True : fmi2False);
  return self_ != nullptr;
}

int Calls2::enter_initialization() const {
  const int answer = setup_(self_, fmi2False, 0, 0, fmi2False, 0);
  return answer > kWarning ? answer : enter_(self_);
}

int Calls2::set(Exchange& exchange, std::span<const double> in, bool& fits) const noexcept {
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

int Calls2::get(Exchange& exchange, double* out) const noexcept {
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

StepEnd Calls2::step(double time, double length) const noexcept {
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

void Calls3::load(void* library, const std::string& file) {
  look_up(library, file, "fmi3InstantiateCoSimulation", instantiate_);
  look_up(library, file, "fmi3FreeInstance", free_);
  look_up(library, file, "fmi3EnterInitializationMode", enter_);
  look_up(library, file, "fmi3ExitInitializationMode", exit_);
  look_up(library, file, "fmi3Terminate", terminate_);
  look_up(library, file, "fmi3DoStep", step_);
  for (std::size_t i = 0; i < kTypes; ++i) {
    look_up(library, file, fmt::format("fmi3Get{}", kTypeNames[i]), getters_[i]);
    look_up(library, file, fmt::format("fmi3Set{}", kTypeNames[i]), setters_[i]);
  }
}

bool Calls3::instantiate(const ModelDescription& description, const InstanceSettings& settings,
                         FmuLog& log) {
  const std::string resources = settings.resources.string() + "/";
  self_ = instantiate_(settings.instance.c_str(), description.token.c_str(), resources.c_str(),
                       false, settings.logs, false, false, nullptr, 0, &log, log3, nullptr);
  return self_ != nullptr;
}

int Calls3::set(Exchange& exchange, std::span<const double> in, bool& fits) const noexcept {
  return with_type(exchange.type, [&](auto tag) {
    using Value = typename decltype(tag)::Value;
    using Setter =
        fmi3Status(fmi3Instance, const fmi3ValueReference*, std::size_t, const Value*, std::size_t);
    fits = take<Value>(exchange, in, std::is_same_v<Value, bool>);
    const auto setter =
        reinterpret_cast<Setter*>(setters_[static_cast<std::size_t>(exchange.type)]);
    return static_cast<int>(setter(self_, exchange.references.data(), exchange.size(),
                                   exchange.values<Value>(), exchange.size()));
  });
}

int Calls3::get(Exchange& exchange, double* out) const noexcept {
  return with_type(exchange.type, [&](auto tag) {
    using Value = typename decltype(tag)::Value;
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

StepEnd Calls3::step(double time, double length) const noexcept {
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

Calls load_calls(const std::filesystem::path& library, int version) {
  void* handle = dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (handle == nullptr) throw Error{fmt::format("cannot load its library: {}", dlerror())};
  const std::string file = library.filename().string();
  if (version == 2) {
    Calls2 calls;
    calls.load(handle, file);
    return calls;
  }
  Calls3 calls;
  calls.load(handle, file);
  return calls;
}

}  // namespace rths::fmi
