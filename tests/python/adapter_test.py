# SPDX-License-Identifier: Apache-2.0
"""Adapters in Python: the templates, and files that are broken on purpose."""
import os
import re
import subprocess
import time

import pytest

import rths

SETTINGS = {"duration_s": 2, "motion.scale": 0.2}


def command(*arguments, folder, timeout_s=100):
    return subprocess.run([os.environ["RTHS_COMMAND"], *arguments], cwd=folder, capture_output=True, text=True,
                          timeout=timeout_s)


@pytest.fixture
def machine(tmp_path):
    """Function that makes a machine whose step has another last line, and returns the folder of its experiment."""
    def make(last_line):
        assert command("new", "adapter", "demo", "--language", "python", folder=tmp_path).returncode == 0
        file = tmp_path / "demo/demo.py"
        file.write_text(re.sub(r"\n        return rths.Status[^\n]*\n$", f"\n        {last_line}\n", file.read_text()))
        assert last_line in file.read_text()
        return tmp_path / "demo"
    return make


def failed_run(folder, **changes):
    run = rths.run(folder / "experiment.toml", clock="virtual", set=SETTINGS | changes, out=folder / "out", timeout_s=60)
    assert run.exit_code == 2, run.stdout + run.stderr
    assert run.recording().time.size > 100  # until the fault
    return run


@pytest.mark.parametrize("role", ["machine", "controller"])
def test_the_template_keeps_the_rules_and_its_test_is_conclusive(tmp_path, role):
    assert command("new", "adapter", "demo", "--language", "python", "--role", role, folder=tmp_path).returncode == 0

    checked = command("check", "demo/demo.py", folder=tmp_path)
    run = rths.run(tmp_path / "demo/experiment.toml", clock="virtual", diagnosis=False, out=tmp_path / "out")

    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert "14 of 15 rules passed, 0 failed, 1 not tried" in checked.stdout
    assert run.exit_code == 0, run.stdout + run.stderr


def test_an_exception_ends_the_run_with_its_place(machine):
    folder = machine("return 1 / 0 if time_s > 0.5 else None")

    run = failed_run(folder)

    assert re.search(r"srmd: adapter in Python \(demo.py\): ZeroDivisionError: division by zero \(demo.py:\d+, in step\)",
                     run.trouble), run.stderr
    assert "Traceback (most recent call last)" in run.stderr


def test_nan_ends_the_run(machine):
    run = failed_run(machine("outputs[4] = float('nan') if time_s > 0.5 else 0"))

    assert "adapter in Python (demo.py): its step wrote nan to 'srmd.long.force.fbk', expected a number" in run.trouble


def test_a_step_that_does_not_return_ends_the_run(machine):
    folder = machine("while time_s > 0.5: pass")
    (folder / "experiment.toml").write_text((folder / "experiment.toml").read_text().replace(
        'library = "demo.py"', 'library = "demo.py"\ndeadline_s = 0.5'))
    begun = time.monotonic()

    run = failed_run(folder)

    assert "adapter in Python (demo.py): its step did not return within 0.5 s" in run.trouble
    assert time.monotonic() - begun < 50


@pytest.mark.parametrize("text, reason", [
    ("import rths\nclass A(rths.Adapter):\n    signals = [rths.Input('a')]\n    def __init__(self, config): config['k']\n",
     r"KeyError: 'k' \(broken.py:4, in __init__\)"),
    ("def f(:\n", r"SyntaxError: invalid syntax \(broken.py:1\)"),
    ("import rths\n", r"broken.py has 0 classes derived from rths.Adapter \(none\), expected one"),
    ("import rths\nclass A(rths.Adapter):\n    pass\n", r"A.signals is empty"),
    ("import no_such_module\n", r"ModuleNotFoundError: No module named 'no_such_module' \(broken.py:1"),
])
def test_a_file_that_cannot_be_used_is_named_with_the_reason(machine, text, reason):
    folder = machine("return None")
    (folder / "broken.py").write_text(text)

    run = rths.run(folder / "experiment.toml", clock="virtual", set={"node.srmd.library": "broken.py"},
                   out=folder / "out", timeout_s=60)

    assert run.exit_code == 2
    assert re.search(r"adapter in Python \(broken.py\): " + ".*" + reason, run.trouble), run.stderr


def test_config_and_numbers_reach_the_adapter(tmp_path):
    (tmp_path / "echo.py").write_text("""
import rths
class Echo(rths.Adapter):
    signals = [rths.Input("opf.long.displ.target", "m"), rths.Monitor("doubled", "m")]
    def __init__(self, config):
        self.factor = config["factor"]
    def step(self, time_s, inputs, outputs):
        outputs[0] = self.factor * inputs[0]
""")
    (tmp_path / "config.toml").write_text("factor = 2.5\n")

    checked = command("check", "echo.py", "--config", "config.toml", folder=tmp_path)
    without = command("check", "echo.py", folder=tmp_path)

    assert checked.returncode == 0, checked.stdout + checked.stderr
    assert without.returncode == 1
    assert "KeyError: 'factor' (echo.py:6, in __init__)" in without.stdout
