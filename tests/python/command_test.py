# SPDX-License-Identifier: Apache-2.0
import ast
import inspect
import json
import pathlib
import sys
import time
import urllib.error
import urllib.request

import numpy
import pytest
from conftest import TREE

import rths
from rths import _rths

EXPERIMENT = TREE / "examples/srmd_lprb_2d.toml"


def test_a_run_that_fails_is_a_result_that_says_why(tmp_path):
    run = rths.run(EXPERIMENT, set={"duration": 3}, clock="virtual", out=tmp_path / "out")

    assert (run.exit_code, run.folder, run.report) == (2, None, None)
    assert "duration" in run.trouble
    with pytest.raises(rths.Error, match="no recording: .*duration"):
        run.recording()


def test_changes_are_written_as_toml(fake_command):
    fake_command('printf "%s\\n" "$@"')

    run = rths.run("e.toml", set={"axes": ["long"], "rest_s": 0.5, "node.echo.prompt": True, "map": "sts",
                                  "node.opf": {"adapter": "echo"}}, ring="own", diagnosis=False)

    assert run.stdout.splitlines() == [
        "run", "e.toml", "--clock", "wall", "--set", 'axes=["long"]', "--set", "rest_s=0.5", "--set",
        "node.echo.prompt=true", "--set", 'map="sts"', "--set", 'node.opf={"adapter" = "echo"}', "--ring", "own",
        "--no-diagnosis", "--json"]


def test_a_view_serves_a_page_until_it_is_closed():
    with rths.view("nobody", port=0) as page:
        with urllib.request.urlopen(page.url, timeout=5) as answer:
            assert "<html" in answer.read().decode()
        assert f'href="{page.url}"' in page._repr_html_()

    with pytest.raises(urllib.error.URLError):
        urllib.request.urlopen(page.url, timeout=5)


def test_a_view_that_cannot_be_served_says_why():
    with rths.view("nobody", port=0) as page, pytest.raises(rths.Error, match="port"):
        rths.view("nobody", port=int(page.url.rsplit(":", 1)[1].strip("/")))


def table(path, factor=1.0, delay=0):
    rows = [f"{0.001 * i:.3f},{factor * numpy.sin(0.02 * (i - delay)):.9g}" for i in range(1000)]
    path.write_text("\n".join(["time [s],displ [m]", *rows]) + "\n")
    return path


def test_two_tables_are_compared(tmp_path):
    found = rths.compare(table(tmp_path / "a.csv"), table(tmp_path / "b.csv", 25.4), rel=0.01, why=True)

    assert [one.signal for one in found.broken] == ["displ"]
    assert found.signal("displ").resemblance == "unit"
    assert found.why["mistakes"] == ["displ is 25.4 times the baseline, as if mm had been read as inch"]
    assert found.table().loc["displ", "peak"] == pytest.approx(1, abs=1e-3)
    with pytest.raises(rths.Error, match="'force' was not compared"):
        found.signal("force")


def test_an_equal_table_has_no_broken_signal_and_needs_no_tolerance(tmp_path):
    found = rths.compare(table(tmp_path / "a.csv"), tmp_path / "a.csv")

    assert (found.broken, found.judged, found.signals[0].equal, found.why) == ((), False, True, None)


def test_what_cannot_be_compared_is_an_error(tmp_path):
    with pytest.raises(rths.Error, match="no common signal matches 'force'"):
        rths.compare(table(tmp_path / "a.csv"), tmp_path / "a.csv", signals=["force"])


def test_tables_need_pandas(tmp_path, monkeypatch):
    found = rths.compare(table(tmp_path / "a.csv"), tmp_path / "a.csv")
    monkeypatch.setitem(sys.modules, "pandas", None)

    with pytest.raises(rths.Error, match="^a table needs pandas, which is not installed$"):
        found.table()


@pytest.mark.parametrize("result, folder", [
    ({"folder": "out/a, b", "recording": "out/a, b/run.h5"}, "out/a, b"),
    ({"folder": "out/a", "recording": None}, None),
    ({"folder": None, "recording": None}, None),
])
def test_the_folder_of_a_run_is_that_of_its_recording(fake_command, result, folder):
    fake_command(f"echo '{json.dumps(result)}'")

    assert rths.run("e.toml").folder == (folder and pathlib.Path(folder))


def test_a_run_that_does_not_end_is_stopped_in_order(fake_command, tmp_path):
    fake_command(f"trap 'echo stopped > {tmp_path}/said; exit 0' INT; while :; do sleep 0.05; done")

    with pytest.raises(rths.Error, match="did not end within 0.3 s"):
        rths.run("e.toml", timeout_s=0.3)

    assert (tmp_path / "said").read_text() == "stopped\n"


def test_a_run_that_does_not_stop_is_killed_with_its_children(fake_command, monkeypatch, tmp_path):
    monkeypatch.setattr(rths.runs, "_GRACE_S", 0.1)
    fake_command(f"trap '' INT; (trap '' INT; sleep 30) & echo $! > {tmp_path}/child; wait")

    with pytest.raises(rths.Error, match="was stopped"):
        rths.run("e.toml", timeout_s=0.3)

    child = pathlib.Path("/proc", (tmp_path / "child").read_text().strip(), "stat")
    deadline = time.monotonic() + 5
    while child.exists() and child.read_text().split()[2] != "Z" and time.monotonic() < deadline:
        time.sleep(0.01)
    assert not child.exists() or child.read_text().split()[2] == "Z"


def test_a_missing_command_is_an_error(monkeypatch):
    monkeypatch.setenv("RTHS_COMMAND", "/nowhere/rths")
    with pytest.raises(rths.Error, match="RTHS_COMMAND is '/nowhere/rths'"):
        rths.command()


def test_a_case_that_cannot_be_read_is_an_error(tmp_path):
    with pytest.raises(rths.Error, match="no_case"):
        rths.diagnose(tmp_path / "no_case", out=tmp_path / "out")


CASE = """
format = 1
name = "drag"
[[record]]
file = "1.csv"
use = "fit"
quiet_s = [0, 2]
[[record]]
file = "2.csv"
use = "held_out"
quiet_s = [0, 2]
[channels]
time = "t [s]"
displacement.long = "x [m]"
force.long = "f [N]"
[model]
kind = "platen"
fitted = ["viscous_friction.coefficient"]
[model.viscous_friction]
axes = ["long"]
coefficient_N_s_per_m = 2e4
"""
DRAG = 2e5  # [N s²/m²]


def write_record(file, seed):
    """A platen with viscous friction and quadratic drag, at rest for 2 s, then in motion."""
    random = numpy.random.default_rng(seed)
    t = numpy.arange(0, 12, 0.01)
    moving = numpy.clip(t - 2, 0, 1)
    x = moving * sum(0.02 / n * numpy.sin(2 * numpy.pi * 0.4 * n * t + random.uniform(0, 6)) for n in (1, 2, 3))
    v = numpy.gradient(x, t)
    f = 2e4 * v + DRAG * v * abs(v) + random.normal(0, 50, len(t))
    numpy.savetxt(file, numpy.column_stack([t, x, f]), delimiter=",", header="t,x,f", comments="", fmt="%.7g")


def test_a_diagnosis_names_the_term_that_the_simulation_omits(tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    for seed in (1, 2):
        write_record(tmp_path / f"{seed}.csv", seed)

    verdict = rths.diagnose(tmp_path, out=tmp_path / "out")

    assert verdict.kind == "missing"
    assert [cause.name for cause in verdict.causes] == ["quadratic_drag"]
    (parameter,) = verdict.causes[0].parameters.values()
    assert parameter["value"] == pytest.approx(DRAG, rel=0.02)
    assert verdict.numbers["sentence"] == verdict.sentence
    assert rths.Verdict.read(tmp_path / "out") == verdict


def test_the_stub_names_all_of_the_extension():
    stub = ast.parse((pathlib.Path(rths.__file__).parent / "_rths.pyi").read_text())
    in_stub, in_extension = set(), set()
    for node in stub.body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            in_stub.add(node.name)
        if isinstance(node, ast.ClassDef):
            in_stub |= {f"{node.name}.{part.name}" for part in node.body
                        if isinstance(part, ast.FunctionDef) and not part.name.startswith("_")}
    for name, value in vars(_rths).items():
        if name.startswith("_"):
            continue
        in_extension.add(name)
        if inspect.isclass(value) and not issubclass(value, Exception):
            in_extension |= {f"{name}.{part}" for part in vars(value) if not part.startswith("_")}
    assert in_stub == in_extension


def test_all_public_names_have_a_docstring():
    for name in rths.__all__:
        value = getattr(rths, name)
        assert inspect.getdoc(value), name
        for part, member in vars(value).items() if inspect.isclass(value) else ():
            if inspect.isfunction(member) and not part.startswith("_"):
                assert inspect.getdoc(member), f"{name}.{part}"
