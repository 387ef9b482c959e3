#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Calls every public function of the package, and prints its results in a form that no version of NumPy changes.

    every_function.py FOLDER [--adapters]

FOLDER gets the files. With --adapters, also runs an adapter in Python. Fails if a function was not called, so that a new one is added here.
"""
import hashlib
import inspect
import os
import pathlib
import subprocess
import sys

import numpy
import pandas

import rths
from rths import adapter, comparison, installation, names, recording, ring, runs, testing, watching

TREE = pathlib.Path(__file__).resolve().parents[2]
MAP = TREE / "examples/python/two_signals.ringmap.toml"
SPRING = TREE / "examples/python/spring_machine.py"
MODULES = (adapter, comparison, installation, names, recording, ring, runs, testing, watching)
called = set()


def shown(value):
    """Text of a value; of an array its type, shape, first values, and a hash of all."""
    if isinstance(value, numpy.ndarray):
        whole = hashlib.sha256(value.tobytes()).hexdigest()[:16]
        return f"{value.dtype.str} {value.shape} {value.flags.writeable} {shown(value[:5].tolist())} {whole}"
    if isinstance(value, pandas.DataFrame):
        return f"{shown(value.index.to_numpy())} {[(name, shown(value[name].to_numpy())) for name in value]}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(shown, value)) + "]"
    return repr(value.item() if isinstance(value, numpy.generic) else value)


def note(name, *values):
    print(f"{name}: {' '.join(map(shown, values))}")


def functions():
    """Public functions and methods of the package, by their code. pytest calls its hooks and fixtures."""
    found = {}
    for module in MODULES:
        for name, item in vars(module).items():
            if getattr(item, "__module__", "") != module.__name__ or name.startswith(("_", "pytest_", "rths_")):
                continue
            members = vars(item).items() if inspect.isclass(item) else [("", item)]
            for member, function in members:
                function = getattr(function, "fget", None) or getattr(function, "__func__", function)
                if inspect.isfunction(function) and not member.startswith("_") and function.__module__ == module.__name__:
                    found[function.__code__] = f"{module.__name__}.{name}.{member}".rstrip(".")
    return found


def use_ring(folder):
    with rths.in_process_ring(MAP) as own:
        solver, machine, observer = own.join("solver"), own.join("machine", plain=True), own.observe()
        follower = own.follow("solver.*", idle_s=0.05)
        solver.write("solver.displacement", 0.1)
        solver.write_all({"solver.displacement": numpy.float64(0.25)})
        note("follower", [(write.node, dict(write.values)) for write in follower], follower.wait(0))
        machine.view("machine").view("float32")[0] = 12.5
        note("view", observer.view("solver"), observer.view("solver").view("float32"), machine.view("machine"))
        note("read", observer.read("machine.force"), observer.read_all("*"), own.matching("m*"), own.signals, own.nodes)
        solver.beat()
        note("presence", observer.beats_of("solver"), observer.presence_of("solver"), observer.name)
        machine.leave()
    with rths.create_ring(f"every_function_{folder.name}", MAP) as shared, rths.attach(shared.name) as attached:
        note("wait", shared.observe().wait_for_node("solver", 0.01), attached.map_toml, shared.name in rths.ring_names())


def use_recordings(folder):
    settings = {"duration_s": 3, "motion.scale": 0.2}
    run = rths.run(TREE / "examples/srmd_lprb_2d.toml", clock="virtual", set=settings, diagnosis=False, out=folder / "run")
    note("run", run.exit_code, run.trouble.count("\n"), sorted(run.report))
    file = run.recording()
    note("recording", file.time, len(file.signals), [file.unit(name) for name in file.signals], file.events, file.drops,
         file.rows_missing, sorted(file.meta), file.config("overrides"))
    for name in file.signals:
        note(name, file.values(name))
    note("frame", file.frame("srmd.*"), rths.load(folder / "run", "xpc.*"))
    dataset = file.dataset("srmd.*")
    note("dataset", [(str(name), dataset[name].to_numpy()) for name in dataset.variables])
    note("figures", run.figures())
    found = rths.compare(folder / "run", folder / "run", signals=["srmd.*"], abs=0)
    with rths.view("nobody", port=0) as page:
        note("view", page.url.startswith("http://127.0.0.1:"))
        page.close()
    note("compare", found.broken, found.signal("srmd.long.displ.fbk").peak, found.table()[["peak", "samples"]])
    numbers = '{"verdict": "none", "sentence": "s", "confidence": 0.5, "causes": []}'
    (folder / "run/verdict.json").write_text(numbers)
    note("verdict", run.verdict().kind, rths.Verdict.read(folder / "run").numbers, rths.command().name)
    verdict = diagnosis(folder)
    note("diagnosis", verdict.sentence, verdict.confidence, [(cause.name, cause.parameters) for cause in verdict.causes])


def diagnosis(folder):
    """With RTHS_LONG=1 that of an example; else the command does not work, but only answers."""
    if os.environ.get("RTHS_LONG"):
        return rths.diagnose(TREE / "examples/diagnosis/actuator", out=folder / "diagnosis")
    command, answer = str(rths.command()), folder / "answer"
    answer.write_text(f"#!/bin/sh\necho 'numbers {folder}/run/verdict.json'\n")
    answer.chmod(0o755)
    os.environ["RTHS_COMMAND"] = str(answer)
    try:
        return rths.diagnose("any")
    finally:
        os.environ["RTHS_COMMAND"] = command


def use_adapters(_):
    plain = rths.Adapter({})
    note("adapter", plain.activate(), plain.deactivate(), rths.Status.DONE)
    try:
        plain.step(0.0, numpy.zeros(1), numpy.zeros(1))
    except NotImplementedError as error:
        note("step", str(error))
    note("signals", rths.Input("a", "m"), rths.Output("b", "m", ramp=True), rths.Monitor("c"), rths.Parameter("d", "N", 1.0))


def use_arrays_of_adapters(folder):
    """A machine in Python, whose steps get arrays on the memory of its host."""
    subprocess.run([rths.command(), "new", "adapter", "demo", "--language", "python"], cwd=folder, check=True,
                   stdout=subprocess.DEVNULL)
    run = rths.run(folder / "demo/experiment.toml", clock="virtual", set={"duration_s": 2, "motion.scale": 0.2},
                   diagnosis=False, out=folder / "machine")
    note("machine in Python", run.trouble, run.recording().frame("srmd.*"))


def use_laboratory(folder):
    (folder / "lab").mkdir()
    lab = testing.Laboratory(folder / "lab", MAP)
    lab.start([sys.executable, SPRING, "{ring}"], node="machine", linked=True)
    solver = lab.join("solver")
    solver.write("solver.displacement", 0.1)
    note("expect", lab.expect_within(5, "machine.force", 1e5), lab.read("machine.force"))
    lab.flip("machine.force", bit=31)
    solver.write("solver.displacement", 0.2)
    note("flip", lab.eventually("machine.force", -2e5, tolerance=10))
    lab.restore("machine")
    lab.delay("machine", 0.001)
    lab.drop("machine.force")
    solver.write("solver.displacement", 0.3)
    lab.never(0.05, "machine.force", 3e5)
    lab.freeze("machine")
    lab.thaw("machine")
    run = lab.run(TREE / "examples/srmd_lprb_2d.toml", set={"duration_s": 1}, diagnosis=False)
    note("lab.run", run.exit_code, lab.expect_baseline(run.folder, run).broken)
    lab.check_owners()
    lab.kill("machine")
    note("log", lab.log("machine"))
    lab.close()


def main(folder, with_adapters):
    sys.setprofile(lambda frame, event, _: called.add(frame.f_code) if event == "call" else None)
    for use in (use_ring, use_recordings, use_adapters, use_laboratory, *[use_arrays_of_adapters] * with_adapters):
        use(folder)
    sys.setprofile(None)
    missing = sorted(name for code, name in functions().items() if code not in called)
    if missing:
        sys.exit(f"not called: {', '.join(missing)}")


main(pathlib.Path(sys.argv[1]).resolve(), "--adapters" in sys.argv)
