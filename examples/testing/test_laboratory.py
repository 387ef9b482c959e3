# SPDX-License-Identifier: Apache-2.0
import os

import pytest


@pytest.fixture
def lab(rths_lab):
    """A laboratory with machine and controller; the test plays the solver."""
    lab = rths_lab("laboratory.ringmap.toml")
    for node in ("machine", "controller"):
        lab.start([os.environ["LABORATORY"], "{node}", "{ring}"], node=node, linked=True)
    return lab


def test_a_flipped_sign_shows_in_the_force(lab):
    solver = lab.join("solver")

    lab.flip("machine.force", bit=31)
    solver.write("solver.target", 0.1)

    lab.expect_within(5, "machine.force", -1e5, tolerance=10)


def test_late_messages_arrive(lab):
    solver = lab.join("solver")

    lab.delay("controller", 0.1)
    solver.write("solver.target", 0.1)

    lab.never(0.05, "controller.reference", 0.1)
    lab.expect_within(5, "machine.force", 1e5, tolerance=10)


def test_three_processes_reach_their_target(rths_lab):
    lab = rths_lab("laboratory.ringmap.toml")
    for node in ("machine", "controller", "solver"):
        lab.start([os.environ["LABORATORY"], "{node}", "{ring}"], node=node)

    lab.expect_within(10, "machine.force", 1e5, tolerance=10)
