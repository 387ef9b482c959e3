// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>

#include <CLI/CLI.hpp>

#include <rths/broker/ring.hpp>
#include <rths/command_line/program.hpp>
#include <rths/core/installed_files.hpp>

#include "commands.hpp"

namespace rths::bench {
namespace {

namespace fs = std::filesystem;

// Python with OpenSees of the environment, else of the build folder; empty: none.
std::string opensees_python(const fs::path& programs) {
  if (const char* python = std::getenv("RTHS_OPENSEES_PYTHON")) return python;
  const fs::path installed = programs / "../../opensees/bin/python";
  return fs::exists(installed) ? installed.lexically_normal().string() : "";
}

// The files that benchmarks need, where they are installed.
Arguments arguments_here() {
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  const fs::path shared = shared_files();
  Arguments arguments;
  arguments.ring.programs = arguments.opensees.programs = arguments.diagnosis.programs = programs;
  arguments.bearings.bearings = shared / "bearings";
  arguments.bearings.script = shared / "opensees/bearing.py";
  arguments.bearings.python = arguments.diagnosis.python = arguments.solver.python =
      opensees_python(programs);
  arguments.solver.script = shared / "solids/solid_plant.py";
  arguments.srmd.machine = shared / "machines/srmd.toml";
  arguments.srmd.bearing = shared / "bearings/lprb.toml";
  arguments.srmd.constants = shared / "examples/srmd_platen_constants.toml";
  arguments.srmd.records_folder = shared / "examples/records";
  return arguments;
}

int parse_and_run(int argc, char** argv) {
  broker::on_lost_memory(broker::OnLostMemory::Exit);
  CLI::App app{
      "Benchmarks of the ring, of the hybrid-simulation laboratory on it, and of its diagnosis."};
  app.name("rths bench");
  app.require_subcommand(1);
  Arguments arguments = arguments_here();
  app::Chosen chosen;
  Commands commands{app, arguments, chosen};
  add_benchmarks(commands);
  return app::run({app, chosen, RTHS_VERSION}, argc, argv);
}

}  // namespace
}  // namespace rths::bench

int main(int argc, char** argv) {
  return rths::app::guarded("rths bench", [&] { return rths::bench::parse_and_run(argc, argv); });
}
