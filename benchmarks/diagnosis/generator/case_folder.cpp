// SPDX-License-Identifier: Apache-2.0
#include "case_folder.hpp"

#include <charconv>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>

#include "place.hpp"

namespace trial {
namespace {

namespace fs = std::filesystem;

constexpr std::array<const char*, 3> kFiles{"fit.csv", "second.csv", "unseen.csv"};
constexpr double kPerKilo = 1e-3;

// Appends numbers without streams, which would take most of a case's time.
class Row {
 public:
  explicit Row(std::string& text) : text_(text) {}
  void cell(double value) {
    constexpr int kDigits = 7;
    std::array<char, 32> buffer{};
    const double zero_has_no_sign = value + 0.0;
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), zero_has_no_sign,
                                   std::chars_format::general, kDigits);
    if (!is_first_) text_ += ',';
    is_first_ = false;
    text_.append(buffer.data(), end.ptr);
  }
  void end() { text_ += '\n'; }

 private:
  std::string& text_;
  bool is_first_ = true;
};

void write(const fs::path& file, const std::string& text) {
  std::ofstream out{file, std::ios::binary};
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

std::string csv(const Record& record) {
  constexpr double kCommandResolution = 1e-6;  // [m]
  constexpr std::size_t kTypicalRow = 80;      // [bytes]
  std::string text =
      "t [s],c_x [m],c_y [m],u_x [m],u_y [m],a_x [m/s2],a_y [m/s2],F_x [kN],F_y [kN],"
      "N [kN]\n";
  text.reserve(text.size() + kTypicalRow * record.force.size());
  for (std::size_t k = 0; k < record.force.size(); ++k) {
    Row row{text};
    row.cell(static_cast<double>(k) * kSampleTime);
    for (const double command : record.command[k]) row.cell(quantised(command, kCommandResolution));
    for (const double displacement : record.displacement[k]) row.cell(displacement);
    for (const double acceleration : record.acceleration[k]) row.cell(acceleration);
    for (const double force : record.force[k]) row.cell(force * kPerKilo);
    row.cell(record.axial_load[k] * kPerKilo);
    row.end();
  }
  return text;
}

constexpr const char* kModel = R"(
[channels]
time = "t [s]"
command.long = "c_x [m]"
command.lat = "c_y [m]"
displacement.long = "u_x [m]"
displacement.lat = "u_y [m]"
acceleration.long = "a_x [m/s2]"
acceleration.lat = "a_y [m/s2]"
force.long = "F_x [kN]"
force.lat = "F_y [kN]"
vertical_force = "N [kN]"

[model]
kind = "platen"
fitted = ["bouc_wen.characteristic_strength", "bouc_wen.post_yield_stiffness",
          "bouc_wen.yield_displacement", "bouc_wen.eta", "force_offset.offset"]

[model.bouc_wen]
characteristic_strength_N = 1_010_000
post_yield_stiffness_N_per_m = 4_238_000
yield_displacement_m = 0.018
beta = 0.5
eta = 2

[model.platen_inertia]
mass_kg = [113_300, 116_800]

[model.force_offset]
kind = "offset"
channel = "force"
offset_N = 0

[model.actuator_delay]
delay_s = 0.004

[model.actuator_bandwidth]
time_constant_s = 0.0132629
damping = 0.85
)";

std::string toml(const CaseId& id) {
  std::string text = "format = 1\nname = \"trial " + std::to_string(id.number) + "\"\n";
  for (std::size_t i = 0; i < kFiles.size(); ++i)
    text += std::string("\n[[record]]\nfile = \"") + kFiles[i] + "\"\nuse = \"" +
            (i == 0 ? "fit" : "held_out") + "\"\nquiet_s = [0, 1.9]\n";
  std::ostringstream map;
  map << "\n[map]\ndisplacement_m = " << kStateDisplacement
      << "\nvelocity_m_per_s = " << kStateVelocity << '\n';
  return text + kModel + map.str();
}

}  // namespace

void write_case_folder(const TrialCase& trial, const fs::path& folder) {
  fs::create_directories(folder);
  for (std::size_t i = 0; i < trial.records.size(); ++i)
    write(folder / kFiles[i], csv(trial.records[i]));
  write(folder / "case.toml", toml(trial.id));
}

}  // namespace trial
