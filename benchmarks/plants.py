"""Large plants: the reduced basis beside all degrees of freedom, and tests with targets at different intervals beside the
numerical result, in virtual time; then one in real time. The simulation has the specimen of the test."""
import re
import subprocess

from results_file import TREE, set_options
from runs import report_of

SIZES = (5_000, 15_000)
SAME_SPECIMEN = ("--no-diagnosis", *set_options(["model.specimen.lead_heating.enabled=true", "duration_s=20"]))
LARGE = ("plant.dof=50000",)
TESTS = {"sticks": ("srmd_lprb_2d.toml", ()), "ant_1": ("ant_1.toml", ()), "ant_5": ("ant_5.toml", ()),
         "ant_486": ("ant_486.toml", LARGE)}
TARGETS = {
    "10_ms": ("integration_step_s=0.01", "solver.substeps=1", "node.opf.handshake=at_target_first"),
    "10_ms_substeps": ("integration_step_s=0.01", "solver.substeps=10", "node.opf.handshake=at_target_first"),
    "1_ms": ("integration_step_s=0.001", "solver.substeps=1", "node.opf.handshake=numbered"),
}
COMPUTING = ("solver.model_computing_time=false", "solver.computing_time_s=0.0003")


def reduction(rths, dof):
    """Differences [%] of the reduced plant from the full one, over 10 s."""
    text = subprocess.run([rths, "plant", "check", str(TREE / "examples/ant_486.toml"), *set_options([f"plant.dof={dof}"])],
                          capture_output=True, text=True, check=True).stdout
    tested = float(re.search(r"tested bearing +([\d.]+) %", text).group(1))
    spectra = [tuple(map(float, found)) for found in re.findall(r"([\d.]+) % horizontal, ([\d.]+) % vertical", text)]
    return {"tested_percent": tested, "spectra_horizontal_percent": max(one[0] for one in spectra),
            "spectra_vertical_percent": max(one[1] for one in spectra)}


def differences(report):
    """Of the response and of bands of floor spectra, largest [%]."""
    ratios = [band for floor in report["floors"].values() for band in floor["hybrid_over_numerical"].values()]
    return {"response_percent": max(axis["numerical_difference_percent"] for axis in report["axes"].values()),
            "spectra_percent": max(100 * abs(ratio - 1) for ratio in ratios),
            "slow_downs": report["slow_downs"]}


def in_virtual_time(rths, test, targets):
    experiment, changes = TESTS[test]
    return differences(report_of(rths, experiment, *SAME_SPECIMEN,
                                 *set_options([*changes, *TARGETS[targets], *COMPUTING])))


def in_real_time(rths):
    report = report_of(rths, "ant_486.toml", *SAME_SPECIMEN, *set_options(LARGE), clock="wall")
    return differences(report) | {key: report[key] for key in (
        "integration_steps", "slow_downs_excused", "steps_excused", "host_late_max_ms")}


def plants(rths):
    return {"reduction": {str(dof): reduction(rths, dof) for dof in SIZES},
            "targets": {test: {targets: in_virtual_time(rths, test, targets) for targets in TARGETS} for test in TESTS},
            "real_time": in_real_time(rths)}
