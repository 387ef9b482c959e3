# SPDX-License-Identifier: Apache-2.0
import pathlib

import pytest

import rths

TREE = pathlib.Path(__file__).resolve().parents[2]
TWO_SIGNALS = TREE / "examples/python/two_signals.ringmap.toml"

# A group that is written whole, a word with named values, and a word in degrees Celsius.
MAP = """
ringmap = 1
[ring]
name = "small"
version = 1
size_bytes = 4096
[nodes]
solver = 1
machine = 2
[[partition]]
name = "solver"
node = "solver"
offset = 0
longwords = 2
[[partition.signal]]
name = "state"
offset = 0
type = "i32"
values = { idle = 0, moving = 1 }
[[partition.signal]]
name = "displacement"
offset = 1
type = "f32"
unit = "mm"
range = [-500, 500]
[[partition]]
name = "machine"
node = "machine"
offset = 8
longwords = 3
tear_group = true
[[partition.signal]]
name = "force"
offset = 8
type = "f32"
unit = "kN"
[[partition.signal]]
name = "temperature"
offset = 9
type = "f32"
unit = "degC"
[[partition.signal]]
name = "cycles"
offset = 10
type = "u32"
"""


@pytest.fixture
def map_file(tmp_path):
    file = tmp_path / "small.ringmap.toml"
    file.write_text(MAP)
    return file


@pytest.fixture
def ring(map_file):
    with rths.in_process_ring(map_file) as ring:
        yield ring


@pytest.fixture
def fake_command(tmp_path, monkeypatch):
    """Function that replaces the command by a script of the shell."""
    def replace(script):
        file = tmp_path / "rths"
        file.write_text(f"#!/bin/sh\n{script}\n")
        file.chmod(0o755)
        monkeypatch.setenv("RTHS_COMMAND", str(file))
    return replace
