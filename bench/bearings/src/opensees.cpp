// SPDX-License-Identifier: Apache-2.0
#include <rths/bench/opensees.hpp>

#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <rths/bench/program.hpp>
#include <rths/core/error.hpp>

namespace rths::bench {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int kCopies = 20;  // beside the one
constexpr std::chrono::seconds kPatience{120};

// A folder that is gone when it is no longer wanted.
class Folder {
 public:
  Folder() {
    std::string name = (fs::temp_directory_path() / "rths_bearings_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw Error{"no temporary folder for OpenSees' files"};
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

void write_motion(const fs::path& file, const Shaking& shaking) {
  std::ofstream out{file};
  out << "0,0,0,0,0,0\n";
  for (const auto& q : shaking)
    out << fmt::format("{},{},{},{},{},{}\n", q.displacement[0], q.displacement[1],
                       q.vertical_displacement, q.velocity[0], q.velocity[1], 0.0);
}

// Runs one case. @returns what the script says last
json result_of(const OpenseesPlace& place, json what, int copies, const fs::path& folder) {
  what["copies"] = copies;
  const fs::path file = folder / "case.json";
  std::ofstream{file} << what.dump();
  const std::string said =
      output_of({place.python, place.script.string(), file.string()}, kPatience);
  const auto last = said.rfind("\n{");
  if (last == std::string::npos)
    throw Error{fmt::format("{} does not get through with it", place.python)};
  return json::parse(said.substr(last));
}

double step_of(const json& result) {
  return result["seconds"].get<double>() * 1e9 / result["steps"].get<double>();
}

}  // namespace

OpenseesTimes opensees_times(const OpenseesPlace& place, const std::string& description,
                             const Shaking& shaking, double time_step) {
  OpenseesTimes times;
  json what = json::parse(description);
  times.element = what["element"][0];
  if (place.python.empty()) {
    times.missing = "no Python that has OpenSees; --opensees names one";
    return times;
  }
  if (!fs::exists(place.script)) {
    times.missing = "the script that moves its elements is part of the source tree only";
    return times;
  }
  try {
    const Folder folder;
    write_motion(folder.path() / "motion.csv", shaking);
    what["motion"] = (folder.path() / "motion.csv").string();
    what["time_step_s"] = time_step;
    const json alone = result_of(place, what, 1, folder.path());
    const json many = result_of(place, what, 1 + kCopies, folder.path());
    times.alone = step_of(alone);
    times.further = (step_of(many) - times.alone) / kCopies;
    times.version = alone["version"];
  } catch (const std::exception& error) {
    times.missing = error.what();
  }
  return times;
}

}  // namespace rths::bench
