# SPDX-License-Identifier: Apache-2.0
import json
import os
import pathlib
import sys
import threading
import time

import pytest
from conftest import TREE, TWO_SIGNALS

import rths

SPRING = TREE / "examples/python/spring_machine.py"
pytest_plugins = ["pytester"]


def start_spring(lab, *arguments):
    lab.start([sys.executable, SPRING, "{ring}", *arguments], node="machine")


def test_a_program_plays_a_node(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    start_spring(lab, "--stiffness-N-per-m", "2e6")

    lab.join("solver").write("solver.displacement", 0.1)

    assert lab.expect_within(5, "machine.force", 2e5) == pytest.approx(2e5, rel=1e-6)


def test_a_program_of_the_vendors_api_plays_a_node(rths_lab):
    spring = pathlib.Path(os.environ["RTHS_BUILD"]) / "bin/rths_test_vendor_spring"
    if not spring.exists():
        pytest.skip(f"{spring} is not built")
    lab = rths_lab(TWO_SIGNALS)
    lab.start([spring], node="machine")

    lab.join("solver").write("solver.displacement", 0.1)

    lab.expect_within(5, "machine.force", 1e5, tolerance=10)


def test_a_recording_repeats_its_baseline(rths_lab, tmp_path):
    lab = rths_lab(TWO_SIGNALS)
    baseline, near = tmp_path / "baseline.csv", tmp_path / "near.csv"
    near.write_text("time [s],force [N]\n" + "".join(f"{i},{100 + i}\n" for i in range(100)))

    with pytest.raises(AssertionError, match=f"does not exist; .* make it: cp {near} {baseline}$"):
        lab.expect_baseline(baseline, near)
    assert not baseline.exists()
    baseline.write_text("time [s],force [N]\n" + "".join(f"{i},{100.5 + i}\n" for i in range(100)))
    lab.expect_baseline(baseline, near, abs=1)
    with pytest.raises(AssertionError, match="1 of 1 signals are outside their tolerance, first force at 0 s$"):
        lab.expect_baseline(baseline, near)


def test_laboratories_do_not_see_each_other(rths_lab):
    first, second = rths_lab(TWO_SIGNALS), rths_lab(TWO_SIGNALS)

    first.join("solver").write("solver.displacement", 0.1)

    assert first.name != second.name
    assert second.read("solver.displacement") == 0


def test_a_value_that_lasts_one_write_is_found(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    solver, ends = lab.join("solver"), threading.Event()

    def pulse():
        while not ends.wait(0.002):
            solver.write("solver.displacement", 0.3)
            solver.write("solver.displacement", 0.0)

    thread = threading.Thread(target=pulse)
    thread.start()
    try:
        lab.eventually("solver.displacement", 0.3)
        with pytest.raises(AssertionError, match="expected never .* found 0.3 m"):
            lab.never(5, "solver.displacement", lambda displacement: displacement > 0.2)
    finally:
        ends.set()
        thread.join()


def test_unmet_expectations_say_what_was_found(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    lab.join("solver").write("solver.displacement", 0.25)

    with pytest.raises(AssertionError, match="solver.displacement: expected 0.1 m within 0.05 s, last value 0.25 m"):
        lab.expect_within(0.05, "solver.displacement", 0.1)
    lab.never(0.02, "solver.displacement", 0.1)


def test_named_values_are_conditions(rths_lab, map_file):
    lab = rths_lab(map_file)
    lab.join("solver").write("solver.state", "moving")

    lab.expect_within(1, "solver.state", "moving")
    with pytest.raises(rths.Error, match="expected one of: idle, moving|expected one of: moving, idle"):
        lab.never(1, "solver.state", "broken")


def test_a_killed_process_is_seen_as_vanished(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    start_spring(lab)
    solver = lab.join("solver")

    lab.kill("machine")

    assert solver.presence_of("machine") == "vanished"


def test_a_frozen_process_answers_after_it_thaws(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    start_spring(lab)
    solver = lab.join("solver")

    lab.freeze("machine")
    solver.write("solver.displacement", 0.01)
    lab.never(0.05, "machine.force", lambda force: force != 0)
    lab.thaw("machine")

    lab.expect_within(5, "machine.force", 1e4)


def start_linked_spring(lab):
    lab.start([sys.executable, SPRING, "{ring}"], node="machine", linked=True)
    solver = lab.join("solver")
    solver.write("solver.displacement", 0.01)
    lab.expect_within(5, "machine.force", 1e4)
    return solver


@pytest.mark.parametrize("dropped", ["machine", "machine.force"])
def test_dropped_messages_do_not_arrive(rths_lab, dropped):
    lab = rths_lab(TWO_SIGNALS)
    solver = start_linked_spring(lab)

    lab.drop(dropped)
    solver.write("solver.displacement", 0.02)
    lab.never(0.1, "machine.force", 2e4)
    lab.restore("machine")
    solver.write("solver.displacement", 0.03)

    lab.expect_within(5, "machine.force", 3e4)


def test_delayed_messages_arrive_in_their_order(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    solver = start_linked_spring(lab)
    forces = lab.ring.follow("machine.force")
    begun = time.monotonic()

    lab.delay("machine", 0.1)
    solver.write("solver.displacement", 0.02)
    solver.write("solver.displacement", 0.03)

    assert [forces.wait(5).values["machine.force"] for _ in range(2)] == pytest.approx([2e4, 3e4])
    assert time.monotonic() - begun >= 0.1


def test_a_flipped_bit_changes_the_sign(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    solver = start_linked_spring(lab)

    lab.flip("machine.force", 31)
    solver.write("solver.displacement", 0.02)

    lab.expect_within(5, "machine.force", -2e4, tolerance=1)


def test_messages_of_a_process_that_is_not_linked_cannot_be_changed(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    start_spring(lab)

    with pytest.raises(rths.Error, match="node 'machine' is not linked"):
        lab.drop("machine")


def test_a_process_that_fails_fails_the_test(rths_lab):
    lab = rths_lab(TWO_SIGNALS)
    lab.start([sys.executable, "-c", "raise SystemExit('out of memory')"], name="model")

    with pytest.raises(AssertionError, match="program 'model' ended with 1: out of memory"):
        lab.never(5, "machine.force", 1e4)


def test_a_run_has_a_ring_and_a_folder_of_its_own(rths_lab, fake_command):
    lab = rths_lab(TWO_SIGNALS)
    fake_command("""printf '{"folder": "%s", "recording": null, "words": "%s"}' "$6" "$*" """)

    run = lab.run("an/experiment.toml")

    assert run.folder.parent == lab.folder
    words = json.loads(run.stdout)["words"]
    assert words == f"run an/experiment.toml --clock virtual --out {run.folder} --ring {lab.name}_run --json"


def test_a_process_that_ends_early_fails_with_its_output(rths_lab):
    lab = rths_lab(TWO_SIGNALS)

    with pytest.raises(AssertionError, match="before node 'machine' was on the ring: .*ended with 1: .*no_such_ring"):
        lab.start([sys.executable, SPRING, "no_such_ring"], name="machine", node="machine")


def test_of_a_failed_test_logs_and_recording_stay(pytester):
    pytester.makepyfile(f"""
        import sys

        def test_fails(rths_lab):
            lab = rths_lab({str(TWO_SIGNALS)!r})
            lab.start([sys.executable, {str(SPRING)!r}, lab.name], name="machine", node="machine")
            lab.join("solver").write("solver.displacement", 0.1)
            lab.eventually("machine.force", 1e5)
            assert False, lab.name

        def test_passes(rths_lab):
            rths_lab({str(TWO_SIGNALS)!r}).start([sys.executable, "-c", "import time; time.sleep(60)"], name="sleeper")
    """)
    begun = time.monotonic()

    result = pytester.runpytest_subprocess("-p", "rths.testing", "--rths-keep", "kept")

    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*logs and recording: *kept/test_fails_*"])
    assert time.monotonic() - begun < 30
    (folder,) = (pytester.path / "kept").iterdir()
    assert {file.name for file in folder.iterdir()} == {"machine.log", "run.h5"}
    frame = rths.load(folder)
    assert frame["solver.displacement"].iloc[-1] == pytest.approx(0.1)
    assert frame["machine.force"].iloc[-1] == pytest.approx(1e5)
    assert not [name for name in rths.ring_names() if name in result.stdout.str()]


def test_nothing_is_left_of_a_test_that_passed(pytester):
    pytester.makepyfile(f"""
        import os, sys

        def test_passes(rths_lab):
            lab = rths_lab({str(TWO_SIGNALS)!r})
            lab.start([sys.executable, "-uc", "import os, time; print(os.getpid()); time.sleep(60)"], name="sleeper")
            while not (pid := lab.log("sleeper").strip()):
                pass
            open("left", "w").write(f"{{lab.name}} {{pid}}")
    """)

    pytester.runpytest_subprocess("-p", "rths.testing").assert_outcomes(passed=1)

    name, pid = (pytester.path / "left").read_text().split()
    assert name not in rths.ring_names()
    assert not os.path.exists(f"/proc/{pid}")
    assert not (pytester.path / "out").exists()


# The last moment of a test: it has passed, and nothing looks at the ring any more.
def test_a_foreign_store_fails_a_test_that_passed(pytester):
    pytester.makepyfile(thief="""
        import ctypes, pathlib, sys, time
        import rths

        with rths.attach(sys.argv[1]) as ring, ring.join("solver", plain=True) as node:
            ctypes.c_float.from_address(node.view("machine").ctypes.data).value = 12.5
            pathlib.Path("stored").touch()
            time.sleep(60)
    """)
    pytester.makepyfile(f"""
        import pathlib, sys, time

        def test_is_robbed(rths_lab):
            rths_lab({str(TWO_SIGNALS)!r}).start([sys.executable, "thief.py", "{{ring}}"], name="thief")
            end = time.monotonic() + 20
            while not pathlib.Path("stored").exists() and time.monotonic() < end:
                time.sleep(0.01)

        def test_is_left_alone(rths_lab):
            rths_lab({str(TWO_SIGNALS)!r}).join("solver").write("solver.displacement", 0.1)
    """)

    result = pytester.runpytest_subprocess("-p", "rths.testing", timeout=60)

    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["*machine.force: stored as 12500 N by * expected stores by its owner machine alone*"])
