// SPDX-License-Identifier: Apache-2.0
//
// The functions of an FMU, the same for both versions of the standard.
#pragma once

#include <rths/fmi/fmi2.h>
#include <rths/fmi/fmi3.h>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "exchange.hpp"
#include "fmu_log.hpp"
#include "model_description.hpp"

namespace rths::fmi {

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

/// Functions of FMI 2. A null instance: none.
class Calls2 {
 public:
  void load(void* library, const std::string& file);
  [[nodiscard]] bool instantiate(const ModelDescription& description,
                                 const InstanceSettings& settings, FmuLog& log);
  [[nodiscard]] int enter_initialization() const;
  [[nodiscard]] int exit_initialization() const { return exit_(self_); }
  [[nodiscard]] int set(Exchange& exchange, std::span<const double> in, bool& fits) const noexcept;
  [[nodiscard]] int get(Exchange& exchange, double* out) const noexcept;
  [[nodiscard]] StepEnd step(double time, double length) const noexcept;
  [[nodiscard]] int terminate() const { return terminate_(self_); }
  void free_instance() const { free_(self_); }

 private:
  fmi2Component self_ = nullptr;
  fmi2CallbackFunctions callbacks_{};
  fmi2InstantiateTYPE* instantiate_ = nullptr;
  fmi2FreeInstanceTYPE* free_ = nullptr;
  fmi2SetupExperimentTYPE* setup_ = nullptr;
  fmi2EnterInitializationModeTYPE* enter_ = nullptr;
  fmi2ExitInitializationModeTYPE* exit_ = nullptr;
  fmi2TerminateTYPE* terminate_ = nullptr;
  fmi2DoStepTYPE* step_ = nullptr;
  fmi2GetRealStatusTYPE* real_status_ = nullptr;
  fmi2GetBooleanStatusTYPE* boolean_status_ = nullptr;
  fmi2GetRealTYPE* get_real_ = nullptr;
  fmi2SetRealTYPE* set_real_ = nullptr;
  fmi2GetIntegerTYPE* get_integer_ = nullptr;
  fmi2SetIntegerTYPE* set_integer_ = nullptr;
  fmi2GetBooleanTYPE* get_boolean_ = nullptr;
  fmi2SetBooleanTYPE* set_boolean_ = nullptr;
};

/// Functions of FMI 3, without event mode, early return and intermediate update.
class Calls3 {
 public:
  void load(void* library, const std::string& file);
  [[nodiscard]] bool instantiate(const ModelDescription& description,
                                 const InstanceSettings& settings, FmuLog& log);
  [[nodiscard]] int enter_initialization() const { return enter_(self_, false, 0, 0, false, 0); }
  [[nodiscard]] int exit_initialization() const { return exit_(self_); }
  [[nodiscard]] int set(Exchange& exchange, std::span<const double> in, bool& fits) const noexcept;
  [[nodiscard]] int get(Exchange& exchange, double* out) const noexcept;
  [[nodiscard]] StepEnd step(double time, double length) const noexcept;
  [[nodiscard]] int terminate() const { return terminate_(self_); }
  void free_instance() const { free_(self_); }

 private:
  using Function = void (*)();
  static constexpr std::size_t kTypes = static_cast<std::size_t>(Type::Other);

  fmi3Instance self_ = nullptr;
  fmi3InstantiateCoSimulationTYPE* instantiate_ = nullptr;
  fmi3FreeInstanceTYPE* free_ = nullptr;
  fmi3EnterInitializationModeTYPE* enter_ = nullptr;
  fmi3ExitInitializationModeTYPE* exit_ = nullptr;
  fmi3TerminateTYPE* terminate_ = nullptr;
  fmi3DoStepTYPE* step_ = nullptr;
  std::array<Function, kTypes> getters_{}, setters_{};  ///< by type
};

/// The functions of one FMU, in its library.
using Calls = std::variant<Calls2, Calls3>;

/// Loads an FMU's library, which stays loaded until the process ends.
/// @throws Error if it cannot be loaded, or lacks a function   @setup
[[nodiscard]] Calls load_calls(const std::filesystem::path& library, int version);

}  // namespace rths::fmi
