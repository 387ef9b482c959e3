// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/opensees.hpp>

#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/bench/program.hpp>
#include <rths/bench/temporary_folder.hpp>
#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int kCopies = 20;  // in addition to the first
constexpr std::chrono::seconds kTimeout{120};

void write_motion(const fs::path& file, const Shaking& shaking) {
  std::ofstream out{file};
  out << "0,0,0,0,0,0\n";
  for (const auto& q : shaking)
    out << fmt::format("{},{},{},{},{},{}\n", q.displacement[0], q.displacement[1],
                       q.vertical_displacement, q.velocity[0], q.velocity[1], 0.0);
}

// Runs one case. @returns the last line of the script's output
json result_of(const OpenSeesInstallation& opensees, json test_case, int copies,
               const fs::path& folder) {
  test_case["copies"] = copies;
  const fs::path file = folder / "case.json";
  std::ofstream{file} << test_case.dump();
  const std::string output =
      output_of({opensees.python, opensees.script.string(), file.string()}, kTimeout);
  const auto last = output.rfind("\n{");
  if (last == std::string::npos)
    throw Error{fmt::format("{}: the analysis failed", opensees.python)};
  return json::parse(output.substr(last));
}

double step_of(const json& result) {
  return result["seconds"].get<double>() * 1e9 / result["steps"].get<double>();
}

}  // namespace

OpenSeesTimes opensees_times(const OpenSeesInstallation& opensees, const std::string& description,
                             const Shaking& shaking, double time_step) {
  OpenSeesTimes times;
  json test_case = json::parse(description);
  times.element = test_case["element"][0];
  if (opensees.python.empty()) {
    times.missing = "no Python with OpenSees found, set one by --opensees";
    return times;
  }
  if (!fs::exists(opensees.script)) {
    times.missing = fmt::format("{} is missing", opensees.script.string());
    return times;
  }
  try {
    const TemporaryFolder folder{"bearings"};
    write_motion(folder.path() / "motion.csv", shaking);
    test_case["motion"] = (folder.path() / "motion.csv").string();
    test_case["time_step_s"] = time_step;
    const json alone = result_of(opensees, test_case, 1, folder.path());
    const json many = result_of(opensees, test_case, 1 + kCopies, folder.path());
    times.alone = step_of(alone);
    times.further = (step_of(many) - times.alone) / kCopies;
    times.version = alone["version"];
  } catch (const std::exception& error) {
    times.missing = error.what();
  }
  return times;
}

}  // namespace rths::bench
