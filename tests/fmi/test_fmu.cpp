// SPDX-License-Identifier: Apache-2.0
#include "test_fmu.hpp"

#include <zip.h>

#include <fstream>
#include <stdexcept>

namespace rths::test {
namespace {

constexpr const char* kLag2 = R"(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Lag" guid="{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}">
  <CoSimulation modelIdentifier="@NAME@" canHandleVariableCommunicationStepSize="false"/>
  <UnitDefinitions>
    <Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>
    <Unit name="s"><BaseUnit s="1"/></Unit>
    <Unit name="deg"><BaseUnit rad="1" factor="0.0174532925199433"/></Unit>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions><SimpleType name="Stroke"><Real unit="mm" min="-1000" max="1000"/></SimpleType></TypeDefinitions>
  <DefaultExperiment stepSize="0.001"/>
  <ModelVariables>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0" unit="mm"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real declaredType="Stroke"/></ScalarVariable>
    <ScalarVariable name="tau" valueReference="3" causality="parameter" variability="fixed"><Real start="0.01" unit="s" min="0" max="1"/></ScalarVariable>
    <ScalarVariable name="gain" valueReference="4" causality="parameter" variability="tunable"><Real start="1"/></ScalarVariable>
    <ScalarVariable name="enabled" valueReference="5" causality="input" variability="discrete"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="count" valueReference="6" causality="output" variability="discrete"><Integer/></ScalarVariable>
    <ScalarVariable name="angle" valueReference="8" causality="output"><Real unit="deg"/></ScalarVariable>
    <ScalarVariable name="temperature" valueReference="9" causality="output"><Real unit="degC"/></ScalarVariable>
    <ScalarVariable name="title" valueReference="20" causality="parameter" variability="fixed"><String start="lag"/></ScalarVariable>
  </ModelVariables>
</fmiModelDescription>
)";

constexpr const char* kLag3 = R"(<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Lag" instantiationToken="{8c4e810f-3df3-4a00-8276-176fa3c9f9e0}">
  <CoSimulation modelIdentifier="@NAME@" fixedInternalStepSize="0.001" hasEventMode="true"/>
  <UnitDefinitions>
    <Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>
    <Unit name="s"><BaseUnit s="1"/></Unit>
    <Unit name="deg"><BaseUnit rad="1" factor="0.0174532925199433"/></Unit>
    <Unit name="degC"><BaseUnit K="1" offset="273.15"/></Unit>
  </UnitDefinitions>
  <TypeDefinitions><Float64Type name="Stroke" unit="mm" min="-1000" max="1000"/></TypeDefinitions>
  <ModelVariables>
    <Float64 name="u" valueReference="1" causality="input" start="0" unit="mm"/>
    <Float64 name="y" valueReference="2" causality="output" declaredType="Stroke"/>
    <Float64 name="tau" valueReference="3" causality="parameter" variability="fixed" start="0.01" unit="s" min="0" max="1"/>
    <Float64 name="gain" valueReference="4" causality="parameter" variability="tunable" start="1"/>
    <Boolean name="enabled" valueReference="5" causality="input" start="true"/>
    <Int32 name="count" valueReference="6" causality="output"/>
    <Float32 name="single" valueReference="7" causality="output" unit="mm"/>
    <Float64 name="angle" valueReference="8" causality="output" unit="deg"/>
    <Float64 name="temperature" valueReference="9" causality="output" unit="degC"/>
    <UInt8 name="level" valueReference="10" causality="input" start="0"/>
    <UInt8 name="level_back" valueReference="11" causality="output"/>
    <Float64 name="row" valueReference="21" causality="input" start="0 0"><Dimension start="2"/></Float64>
    <Clock name="tick" valueReference="22" causality="input" intervalVariability="triggered"/>
    <Float64 name="sampled" valueReference="23" causality="output" variability="discrete" clocks="22"/>
    <String name="title" valueReference="20" causality="parameter" variability="fixed"><Start value="lag"/></String>
  </ModelVariables>
</fmiModelDescription>
)";

void replace(std::string& text, const Change& change) {
  const auto at = text.find(change.first);
  if (at == std::string::npos) throw std::runtime_error{"no '" + change.first + "' to change"};
  text.replace(at, change.first.size(), change.second);
}

void add(zip_t* zip, const std::string& name, const std::filesystem::path& file) {
  zip_source_t* source = zip_source_file(zip, file.c_str(), 0, -1);
  if (source == nullptr || zip_file_add(zip, name.c_str(), source, ZIP_FL_ENC_UTF_8) < 0)
    throw std::runtime_error{name + " cannot be packed"};
}

}  // namespace

std::string lag_description(int version, const std::string& name,
                            const std::vector<Change>& changes) {
  std::string text = version == 2 ? kLag2 : kLag3;
  replace(text, {"@NAME@", name});
  for (const auto& change : changes) replace(text, change);
  return text;
}

std::filesystem::path write_fmu(const TemporaryFolder& folder, const std::string& description,
                                const std::filesystem::path& library, int version) {
  const auto root = folder.path() / "unpacked";
  std::filesystem::remove_all(root);
  const auto binaries = root / "binaries" / (version == 2 ? "linux64" : "x86_64-linux");
  std::filesystem::create_directories(binaries);
  std::ofstream{root / "modelDescription.xml"} << description;
  if (!library.empty()) std::filesystem::copy(library, binaries / library.filename());
  return root;
}

std::filesystem::path pack_fmu(const std::filesystem::path& folder, const std::string& extra) {
  const auto packed = folder.parent_path() / "packed.fmu";
  std::filesystem::remove(packed);
  int code = 0;
  zip_t* zip = zip_open(packed.c_str(), ZIP_CREATE, &code);
  for (const auto& entry : std::filesystem::recursive_directory_iterator{folder})
    if (entry.is_regular_file())
      add(zip, std::filesystem::relative(entry.path(), folder).string(), entry.path());
  if (!extra.empty()) add(zip, extra, folder / "modelDescription.xml");
  if (zip_close(zip) != 0) throw std::runtime_error{packed.string() + " cannot be written"};
  return packed;
}

std::filesystem::path lag_library(int version, const std::string& name) {
  return build_tree() / ("fmu" + std::to_string(version)) / (name + ".so");
}

std::filesystem::path lag_fmu(const TemporaryFolder& folder, int version, const std::string& name,
                              const std::vector<Change>& changes) {
  return write_fmu(folder, lag_description(version, name, changes), lag_library(version, name),
                   version);
}

}  // namespace rths::test
