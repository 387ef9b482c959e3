# SPDX-License-Identifier: Apache-2.0
import importlib.util
import math

import numpy
import pandas
import pytest

import rths
from rths import _rths


@pytest.fixture
def recording(ring, tmp_path):
    """Three rows of a ramp of the force, with a change of the event signal's value."""
    file = tmp_path / "run.h5"
    writer = _rths.Writer(file, ring._open(), ["solver.displacement", "machine.force"], [("operator", "Gödel")])
    for row in range(3):
        writer.append(0.5 * row, [0.001 * row, math.nan if row == 1 else 1e3 * row])
    writer.close()
    return file


def test_a_recording_is_a_table_with_units(recording):
    frame = rths.load(recording)

    expected = pandas.DataFrame({"solver.displacement": [0, 0.001, 0.002], "machine.force": [0, math.nan, 2e3]},
                                index=pandas.Index([0, 0.5, 1.0], name="time"))
    pandas.testing.assert_frame_equal(frame, expected)
    assert frame.attrs["units"] == {"solver.displacement": "m", "machine.force": "N"}
    assert frame.attrs["meta"]["operator"] == "Gödel"


def test_patterns_select_columns(recording):
    assert list(rths.load(recording.parent, "*.force")) == ["machine.force"]
    with pytest.raises(rths.Error, match="has no signal 'forces', expected one such as: solver.displacement"):
        rths.load(recording, "forces")


def test_values_are_arrays_that_own_their_memory(recording):
    values = rths.Recording(recording).values("solver.displacement")

    values += 1  # of a recording that is gone

    numpy.testing.assert_array_equal(values, [1, 1.001, 1.002])


def test_a_misspelt_signal_is_an_error_with_the_closest_name(recording):
    with pytest.raises(rths.Error, match="machine.force"):
        rths.Recording(recording).values("machine.forc")


def test_a_file_that_is_no_recording_is_an_error(tmp_path):
    (tmp_path / "run.h5").write_text("no recording")
    for path in (tmp_path, tmp_path / "none.h5"):
        with pytest.raises(rths.Error, match="h5"):
            rths.Recording(path)


@pytest.mark.skipif(importlib.util.find_spec("xarray") is not None, reason="xarray is installed")
def test_a_dataset_without_xarray_is_an_error(recording):
    with pytest.raises(rths.Error, match="needs xarray"):
        rths.Recording(recording).dataset()


@pytest.mark.skipif(importlib.util.find_spec("xarray") is None, reason="xarray is not installed")
def test_a_dataset_has_units(recording):
    dataset = rths.Recording(recording).dataset("machine.*")
    assert dataset["machine.force"].attrs["units"] == "N" and dataset["time"].attrs["units"] == "s"
