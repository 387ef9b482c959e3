// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rths::fmi {

/// Types of numbers. FMI 2 has Float64 (Real), Int32 (Integer) and Boolean.
enum class Type {
  Float64,
  Float32,
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Boolean,
  Other,  ///< String, Binary, Clock, Enumeration: cannot be bound
};
/// Their names in FMI 3, without Other.
inline constexpr const char* kNumberTypes[] = {"Float64", "Float32", "Int8",   "UInt8",
                                               "Int16",   "UInt16",  "Int32",  "UInt32",
                                               "Int64",   "UInt64",  "Boolean"};
/// Base units, in the order of the exponents of a BaseUnit.
inline constexpr const char* kBases[] = {"kg", "m", "s", "A", "K", "mol", "cd", "rad"};

struct Variable {
  std::string name;
  std::uint32_t reference = 0;
  Type type = Type::Other;
  std::string type_name;  ///< as the file states it: "Real", "String"
  std::string causality, variability;
  bool is_exact = false;     ///< initial = "exact": its initial value may be set
  std::string unit;          ///< empty: none
  bool is_relative = false;  ///< a difference: the offset of its unit does not count
  bool is_array = false, is_clocked = false;
  std::optional<double> start, lowest, highest;  ///< [unit]

  [[nodiscard]] bool is_real() const { return type == Type::Float64 || type == Type::Float32; }
};

/// si = factor·value + offset, in kg^a m^b s^c A^d K^e mol^f cd^g rad^h.
struct BaseUnit {
  std::array<int, 8> exponents{};
  double factor = 1, offset = 0;
};

/// modelDescription.xml of an FMU, as far as co-simulation needs it.
struct ModelDescription {
  int version = 3;                                   ///< of FMI: 2 or 3
  std::string version_text;                          ///< "3.0"
  std::string name;                                  ///< of the model
  std::string identifier;                            ///< of the library: its file name
  std::string token;                                 ///< GUID, instantiation token
  bool is_once_only = false;                         ///< one instance per process
  std::optional<double> fixed_step, preferred_step;  ///< [s]
  std::vector<Variable> variables;
  std::map<std::string, BaseUnit> units;

  [[nodiscard]] const Variable* find(const std::string& variable) const;
};

/// @param place  of the text, for messages
/// @throws Error if the text is not that of an FMU for co-simulation of FMI 2 or 3, or the FMU
///         needs another program   @setup
[[nodiscard]] ModelDescription parse_description(const std::string& xml, const std::string& place);

}  // namespace rths::fmi
