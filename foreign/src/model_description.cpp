// SPDX-License-Identifier: Apache-2.0
#include <rths/fmi/model_description.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include <fmt/format.h>
#include <pugixml.hpp>

#include <rths/core/error.hpp>

namespace rths::fmi {
namespace {

Type type_named(int version, const std::string& name) {
  if (version == 2) {
    if (name == "Real") return Type::Float64;
    if (name == "Integer") return Type::Int32;
    return name == "Boolean" ? Type::Boolean : Type::Other;
  }
  const auto found = std::find(std::begin(kNumberTypes), std::end(kNumberTypes), name);
  return static_cast<Type>(found - std::begin(kNumberTypes));
}

/// Reads attributes; its errors name the file.
class DescriptionReader {
 public:
  explicit DescriptionReader(std::string place) : place_{std::move(place)} {}

  [[noreturn]] void fail(const std::string& text) const { throw Error{place_ + ": " + text}; }

  [[nodiscard]] static std::string text(const pugi::xml_node& node, const char* key,
                                        const char* otherwise = "") {
    return node.attribute(key).as_string(otherwise);
  }
  [[nodiscard]] std::string required(const pugi::xml_node& node, const char* key) const {
    const std::string value = text(node, key);
    if (value.empty()) fail(fmt::format("<{}> has no {}", node.name(), key));
    return value;
  }
  [[nodiscard]] bool flag(const pugi::xml_node& node, const char* key) const {
    const std::string value = text(node, key, "false");
    if (value == "true" || value == "1") return true;
    if (value == "false" || value == "0") return false;
    fail(fmt::format("{} is '{}', expected true or false", key, value));
  }
  [[nodiscard]] std::optional<double> number(const pugi::xml_node& node, const char* key) const {
    const std::string value = text(node, key);
    if (value.empty()) return std::nullopt;
    double result = 0;
    const char* end = value.data() + value.size();
    const char* begin = value.data() + (value[0] == '+' ? 1 : 0);
    const auto [stop, error] = std::from_chars(begin, end, result);
    if (error != std::errc{} || stop != end || !std::isfinite(result))
      fail(fmt::format("{} is '{}', expected a number", key, value));
    return result;
  }
  [[nodiscard]] std::uint32_t reference(const pugi::xml_node& node) const {
    const std::string value = required(node, "valueReference");
    std::uint32_t result = 0;
    const char* end = value.data() + value.size();
    const auto [stop, error] = std::from_chars(value.data(), end, result);
    if (error != std::errc{} || stop != end)
      fail(fmt::format("valueReference is '{}', expected a number", value));
    return result;
  }

 private:
  std::string place_;
};

bool is_element(const pugi::xml_node& node) { return node.type() == pugi::node_element; }

using Definitions = std::map<std::string, pugi::xml_node>;

// FMI 2: <SimpleType name="…"><Real …/>. FMI 3: <Float64Type name="…" …/>.
Definitions definitions_in(const pugi::xml_node& root, int version) {
  Definitions found;
  for (const auto& node : root.child("TypeDefinitions"))
    if (is_element(node))
      found[DescriptionReader::text(node, "name")] = version == 2 ? node.first_child() : node;
  return found;
}

std::map<std::string, BaseUnit> units_in(const pugi::xml_node& root,
                                         const DescriptionReader& reader) {
  std::map<std::string, BaseUnit> units;
  for (const auto& node : root.child("UnitDefinitions").children("Unit")) {
    const auto base = node.child("BaseUnit");
    if (!base) continue;
    BaseUnit unit;
    for (std::size_t i = 0; i < unit.exponents.size(); ++i)
      unit.exponents[i] = base.attribute(kBases[i]).as_int(0);
    unit.factor = reader.number(base, "factor").value_or(1);
    unit.offset = reader.number(base, "offset").value_or(0);
    if (unit.factor == 0)
      reader.fail(fmt::format("factor of unit '{}' is 0", DescriptionReader::text(node, "name")));
    units[reader.required(node, "name")] = unit;
  }
  return units;
}

// Attributes of a number: its own, or those of its declared type.
void read_number(const pugi::xml_node& own, const Definitions& definitions,
                 const DescriptionReader& reader, Variable& variable) {
  const auto declared = definitions.find(DescriptionReader::text(own, "declaredType"));
  const auto source = [&](const char* key) {
    return own.attribute(key) || declared == definitions.end() ? own : declared->second;
  };
  variable.unit = DescriptionReader::text(source("unit"), "unit");
  variable.is_relative = reader.flag(source("relativeQuantity"), "relativeQuantity");
  variable.lowest = reader.number(source("min"), "min");
  variable.highest = reader.number(source("max"), "max");
  if (!variable.is_array) variable.start = reader.number(own, "start");
}

Variable variable_of(const pugi::xml_node& node, int version, const Definitions& definitions,
                     const DescriptionReader& reader) {
  const pugi::xml_node typed = version == 2 ? node.find_child(is_element) : node;
  Variable variable;
  variable.name = reader.required(node, "name");
  variable.type_name = typed.name();
  variable.type = type_named(version, variable.type_name);
  variable.causality = DescriptionReader::text(node, "causality", "local");
  variable.variability =
      DescriptionReader::text(node, "variability", variable.is_real() ? "continuous" : "discrete");
  variable.is_exact = DescriptionReader::text(node, "initial") == "exact";
  variable.is_array = static_cast<bool>(node.child("Dimension"));
  variable.is_clocked = !DescriptionReader::text(node, "clocks").empty();
  if (variable.type == Type::Other) return variable;
  variable.reference = reader.reference(node);
  if (variable.type != Type::Boolean)
    read_number(typed, definitions, reader, variable);
  else if (!variable.is_array && typed.attribute("start"))
    variable.start = reader.flag(typed, "start") ? 1 : 0;
  return variable;
}

void read_co_simulation(const pugi::xml_node& root, const DescriptionReader& reader,
                        ModelDescription& description) {
  const auto node = root.child("CoSimulation");
  if (!node)
    reader.fail(fmt::format("has no <CoSimulation>{}, expected an FMU for co-simulation",
                            root.child("ModelExchange") ? ", but <ModelExchange>" : ""));
  description.identifier = reader.required(node, "modelIdentifier");
  if (description.identifier.find('/') != std::string::npos)
    reader.fail(
        fmt::format("modelIdentifier is '{}', expected a C identifier", description.identifier));
  description.is_once_only = reader.flag(node, "canBeInstantiatedOnlyOncePerProcess");
  if (reader.flag(node, "needsExecutionTool"))
    reader.fail(
        "needsExecutionTool is true: the FMU needs another program, expected an FMU that "
        "holds its model");
  description.fixed_step = reader.number(node, "fixedInternalStepSize");
  description.preferred_step = reader.number(root.child("DefaultExperiment"), "stepSize");
  for (const auto& [key, step] : {std::pair{"fixedInternalStepSize", description.fixed_step},
                                  std::pair{"stepSize", description.preferred_step}})
    if (step && *step <= 0) reader.fail(fmt::format("{} is {:g}, expected > 0", key, *step));
}

}  // namespace

const Variable* ModelDescription::find(const std::string& variable) const {
  const auto found = std::find_if(variables.begin(), variables.end(),
                                  [&](const auto& known) { return known.name == variable; });
  return found == variables.end() ? nullptr : &*found;
}

ModelDescription parse_description(const std::string& xml, const std::string& place) {
  const DescriptionReader reader{place};
  pugi::xml_document document;
  const auto result = document.load_buffer(xml.data(), xml.size());
  if (!result)
    reader.fail(fmt::format("is no XML: {} at byte {}", result.description(), result.offset));
  const auto root = document.child("fmiModelDescription");
  if (!root) reader.fail("has no <fmiModelDescription>");
  ModelDescription description;
  description.version_text = reader.required(root, "fmiVersion");
  if (description.version_text.starts_with("2."))
    description.version = 2;
  else if (!description.version_text.starts_with("3."))
    reader.fail(fmt::format("fmiVersion is '{}', expected 2.0 or 3.0", description.version_text));
  description.name = reader.required(root, "modelName");
  description.token =
      reader.required(root, description.version == 2 ? "guid" : "instantiationToken");
  read_co_simulation(root, reader, description);
  description.units = units_in(root, reader);
  const auto definitions = definitions_in(root, description.version);
  for (const auto& node : root.child("ModelVariables"))
    if (is_element(node))
      description.variables.push_back(variable_of(node, description.version, definitions, reader));
  return description;
}

}  // namespace rths::fmi
