// SPDX-License-Identifier: Apache-2.0
#include <rths/foreign/opensees.hpp>

#include <cstdlib>

namespace rths::foreign {
namespace {

// Calls a function of a script with the tables of a run.
constexpr const char* kCall = R"(
import csv, importlib.util, os, sys
script, function = sys.argv[1:3]
sys.argv[:] = [script]
sys.path.insert(0, os.path.dirname(script))
spec = importlib.util.spec_from_file_location("simulation", script)
module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
with open("inputs.csv") as file:
    rows = list(csv.reader(file))
inputs = {name: [float(row[i]) for row in rows[1:]] for i, name in enumerate(rows[0])}
with open("parameters.toml") as file:
    lines = [line.rsplit("=", 1) for line in file]
parameters = {name.strip().strip('"'): float(value) for name, value in lines}
result = dict(getattr(module, function)(inputs.pop("time"), inputs, parameters))
with open("outputs.csv", "w") as file:
    print(*result, sep=",", file=file)
    for row in zip(*result.values()):
        print(*(repr(float(value)) for value in row), sep=",", file=file)
)";

}  // namespace

std::unique_ptr<Simulation> make_opensees(OpenSeesRunSettings settings) {
  ProgramSettings program;
  // A run starts in a folder of its own.
  settings.script = std::filesystem::absolute(settings.script);
  program.command = {settings.python, settings.script.string()};
  if (!settings.function.empty())
    program.command = {settings.python, "-c", kCall, settings.script.string(), settings.function};
  program.command.insert(program.command.end(), settings.arguments.begin(),
                         settings.arguments.end());
  program.folder = settings.script.parent_path();
  program.inputs = std::move(settings.inputs);
  program.outputs = std::move(settings.outputs);
  program.parameters = std::move(settings.parameters);
  program.deadline = settings.deadline;
  program.files = std::move(settings.files);
  program.recorded = std::move(settings.recorded);
  program.has_motion = true;
  program.python_script = settings.script;
  return make_program(std::move(program));
}

std::string opensees_python() {
  const char* python = std::getenv("RTHS_OPENSEES_PYTHON");
  return python != nullptr ? python : "python3";
}

}  // namespace rths::foreign
