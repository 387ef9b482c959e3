"""OpenSees as the solver, in virtual time: differences between an element on the ring and OpenSees' own element.

`differences(rths, python)` runs the scripts of examples/opensees and tests/opensees. Standard library only.
"""
import math
import pathlib
import subprocess
import tempfile

from results_file import TREE

RECORD = TREE / "examples/records/petrolia_1992_riodell_freefield.csv"
FEET = ["--columns", "2", "1", "--unit", str(1.4 * 9.80665)]  # the record for a script without rths: columns, unit
EXPERIMENT = """format = 1
name = "opensees_runs"
map = "srmd"
axes = {axes}
integration_step_s = {step}
duration_s = {duration}
[motion]
file = "{record}"
column_long = 2
column_lat = 1
scale = {scale}
[specimen]
model = "{specimen}"
{terms}
[node.xpc]
adapter = "ideal_machine"
[node.opf]
adapter = "opensees"
script = "{script}"
python = "{python}"
arguments = [{arguments}]
[[node.opf.element]]
name = "specimen"
port = {port}
{element}
"""
BILINEAR = """bearing = 1
title = "bilinear"
[bilinear]
characteristic_strength_N = 1_010_000
post_yield_stiffness_N_per_m = 4_238_000
yield_displacement_m = 2.855e-3
"""
BEARING = """[node.opf.element.bearing]
height = 0.5
shear_distance = 0.3
p_delta = {p_delta}
[node.opf.element.bearing.axes]
shear_y = "-long"
shear_z = "lat"
[node.opf.element.bearing.springs]
axial = 3e9
torsion = 2e7
rotation_y = 4e8
rotation_z = 5e8
"""
INTEGRATORS = {"AlphaOS": ("0.95", "0.9"), "AlphaOSGeneralized": ("0.8", "0.5"), "KRAlphaExplicit": ("0.8", "0.5"),
               "NewmarkExplicit": ("0.5",), "HHTHSFixedNumIter": ("0.8", "0.5")}
ITERATIONS = 5
PLANT, FRAME, MAST = (TREE / f for f in ("examples/opensees/isolated_plant.py", "examples/opensees/one_bay_frame.py",
                                         "tests/opensees/mast.py"))


def rows_of(file):
    return [[float(cell) for cell in line.split(",")] for line in file.read_text().splitlines()]


def nrmse_percent(found, expected, column):
    """RMS of the difference over that of the expected values about their mean [%]."""
    values = [row[column] for row in expected]
    if len(found) != len(values):
        raise SystemExit(f"found {len(found)} steps, expected {len(values)}")
    mean = sum(values) / len(values)
    difference = sum((row[column] - value) ** 2 for row, value in zip(found, values))
    return 100 * math.sqrt(difference / sum((value - mean) ** 2 for value in values))


def text_of(percents):
    """"below 0.001 %", "2.9 %", "2.9 and 2.0 %"."""
    if all(percent < 0.001 for percent in percents):
        return "below 0.001 %"
    digits = [f"{percent:.2f}" if percent < 0.5 else f"{percent:.1f}" for percent in percents]
    return " and ".join(dict.fromkeys(digits)) + " %"


class Runs:
    """The two ways to run a script: with its specimen on the ring, and alone."""

    def __init__(self, rths, python, folder):
        self.rths, self.python, self.folder, self.port = rths, python, folder, 8200
        self.out = None  # of the last run on the ring
        (folder / "bilinear.toml").write_text(BILINEAR)

    def on_ring(self, script, options, specimen="bilinear.toml", element='dofs = ["long", "lat"]', terms="",
                axes='["long", "lat"]', duration=30.0, step=0.01, scale=1.4):
        self.port += 1
        response = self.folder / "ring.csv"
        response.unlink(missing_ok=True)
        words = [str(word).format(port=self.port, response=response) for word in options]
        experiment = self.folder / "experiment.toml"
        experiment.write_text(EXPERIMENT.format(
            axes=axes, record=RECORD, specimen=specimen, terms=terms, script=script, python=self.python, port=self.port,
            arguments=", ".join(f'"{word}"' for word in ["{motion}", *words]), element=element, duration=duration,
            step=step, scale=scale))
        self.out = pathlib.Path(tempfile.mkdtemp(dir=self.folder))
        subprocess.run([self.rths, "run", experiment, "--clock", "virtual", "--out", self.out],
                       check=True, stdout=subprocess.DEVNULL)
        return rows_of(response)

    def alone(self, script, *options, motion=RECORD):
        """None if the analysis fails."""
        response = self.folder / "own.csv"
        response.unlink(missing_ok=True)
        words = [str(word).format(response=response) for word in options]
        status = subprocess.run([self.python, script, motion, *words], stdout=subprocess.DEVNULL,
                                stderr=subprocess.DEVNULL, check=False)
        return rows_of(response) if status.returncode == 0 else None


def plant(runs, integrator, parameter):
    """Displacements of the mat, percent; None if OpenSees diverges with its own element too."""
    words = ["--integrator", integrator, parameter]
    own = runs.alone(PLANT, *FEET, "--bearing", "plasticity", *words, "--response", "{response}")
    if own is None or max(abs(row[1]) for row in own) > 100:
        return None
    steps = ITERATIONS if "HS" in integrator else 1
    ring = runs.on_ring(PLANT, ["--port", "{port}", "--response", "{response}", *words], duration=30 * steps)
    return max(nrmse_percent(ring, own, column) for column in (1, 2))


def frame(runs, integrator, parameter):
    words = ["--integrator", integrator, parameter]
    motion = runs.folder / "frame.csv"
    source = [line.split(",") for line in RECORD.read_text().splitlines()]
    motion.write_text("time,long\n" + "".join(f"{row[0]},{float(row[2]) * 9.80665!r}\n" for row in source[1:]))
    own = runs.alone(FRAME, "--column", "steel", *words, "--response", "{response}", motion=motion)
    steps = ITERATIONS if "HS" in integrator else 1
    element = 'dofs = ["long"]\nlength_unit_m = 0.0254\nforce_unit_N = 4448.2216\ninitial_stiffness = [[2.8]]'
    ring = runs.on_ring(FRAME, ["--port", "{port}", "--response", "{response}", *words], duration=30 * steps, scale=1,
                        specimen=TREE / "examples/opensees/column.toml", element=element, axes='["long"]')
    return nrmse_percent(ring, own, 1)


def bouc_wen(runs, step):
    """Displacements and accelerations of the mat against OpenSees' Bouc-Wen element, percent."""
    own = runs.alone(PLANT, *FEET, "--bearing", "bouc_wen", "--step", step, "--response", "{response}")
    ring = runs.on_ring(PLANT, ["--port", "{port}", "--response", "{response}", "--step", step], specimen="lprb",
                        terms="[specimen.lead_heating]\nenabled = false", step=step)
    return [nrmse_percent(ring, own, column) for column in (1, 2, 3, 4)]


def mast(runs, p_delta):
    """The worst of displacements and rotations of the bearing, percent."""
    ring = runs.on_ring(MAST, ["ring", "{port}", "{response}"],
                        element=BEARING.format(p_delta=str(p_delta).lower()), duration=10)
    own = runs.alone(MAST, "own", "0", "{response}", motion=runs.out / "run.opf.motion.csv")
    return [nrmse_percent(ring, own, column) for column in (1, 2, 4, 5)]


def differences(rths, python):
    with tempfile.TemporaryDirectory() as name:
        runs = Runs(pathlib.Path(rths).resolve(), python, pathlib.Path(name))
        integrators = {}
        for integrator, parameters in INTEGRATORS.items():
            on_plant = [plant(runs, integrator, parameter) for parameter in parameters]
            on_frame = [frame(runs, integrator, parameter) for parameter in parameters]
            diverges = None in on_plant
            integrators[integrator] = {
                "parameters": parameters, "plant_percent": on_plant, "frame_percent": on_frame,
                "plant": "diverges, also with OpenSees' own element" if diverges else text_of(on_plant),
                "frame": text_of(on_frame)}
            print(integrator, integrators[integrator], flush=True)
        plasticity = runs.alone(PLANT, *FEET, "--bearing", "plasticity", "--response", "{response}")
        ring = runs.on_ring(PLANT, ["--port", "{port}", "--response", "{response}"])
        same = [nrmse_percent(ring, plasticity, column) for column in (1, 2, 3, 4)]
        with_moments, without = mast(runs, True), mast(runs, False)
        return {"integrators": integrators, "plasticity": {"percent": same, "text": text_of(same)},
                "mast": {"percent": with_moments, "text": text_of(with_moments), "without_p_delta_percent": without},
                "bouc_wen_10_ms_percent": bouc_wen(runs, 0.01), "bouc_wen_2_ms_percent": bouc_wen(runs, 0.002)}
