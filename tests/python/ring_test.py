# SPDX-License-Identifier: Apache-2.0
import gc
import math
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time

import numpy
import pytest

import rths


def test_values_are_in_si(ring):
    solver, machine, observer = ring.join("solver"), ring.join("machine"), ring.observe()

    solver.write("solver.displacement", 0.25)
    machine.write_all({"machine.force": 2e3, "machine.temperature": 300.0})

    assert observer.read("solver.displacement") == 0.25
    assert solver.view("solver").view("float32")[1] == 250  # mm, as in the map
    assert observer.read_all("machine.*") == {
        "machine.force": 2e3, "machine.temperature": pytest.approx(300, rel=1e-6), "machine.cycles": 0}
    assert ring.signals["machine.force"].unit == "N"
    assert ring.signals["solver.displacement"].range == pytest.approx((-0.5, 0.5))


def test_values_of_integers_have_names(ring):
    solver = ring.join("solver")

    solver.write("solver.state", "moving")

    assert solver.read("solver.state") == ring.signals["solver.state"].values["moving"] == 1


@pytest.mark.parametrize("signal, value, message", [
    ("machine.force", 1.0, "belongs to node 'machine', this program is node 'solver'"),
    ("solver.displacment", 1.0, "did you mean 'solver.displacement'"),
    ("solver.state", "broken", "expected a number or one of: "),
    ("solver.displacement", 0.6, "expected -0.5 to 0.5 in SI"),
    ("solver.displacement", math.nan, "expected a finite number"),
])
def test_a_wrong_write_is_refused_with_a_message(ring, signal, value, message):
    with pytest.raises(rths.Error, match=message):
        ring.join("solver").write(signal, value)


def test_a_refused_write_writes_nothing(ring):
    solver = ring.join("solver")

    with pytest.raises(rths.Error):
        solver.write_all({"solver.displacement": 0.1, "machine.force": 1.0})

    assert solver.read("solver.displacement") == 0


def test_observers_do_not_write(ring):
    with pytest.raises(rths.Error, match="join as node 'solver'"):
        ring.observe().write("solver.state", 1)


def test_a_node_has_one_place_and_leaves_it(ring):
    with ring.join("solver"):
        with pytest.raises(rths.Error, match="already on the ring"):
            ring.join("solver")
        assert ring.observe().presence_of("solver") == "alive"

    with ring.join("solver") as again:
        again.leave()
        with pytest.raises(rths.Error, match="has left the ring"):
            again.read("solver.state")
    assert ring.observe().presence_of("solver") == "absent"


def test_a_view_shows_writes_without_a_copy_and_is_read_only(ring):
    solver = ring.join("solver")
    words = ring.observe().view("solver")

    solver.write("solver.state", 7)

    assert words.dtype == numpy.uint32 and words.shape == (2,)
    assert words[0] == 7
    for view in (words, solver.view("solver")):
        with pytest.raises(ValueError):
            view[0] = 1
        with pytest.raises(ValueError):
            view.setflags(write=True)


def test_a_plain_node_stores_through_its_view_only(ring):
    machine = ring.join("machine", plain=True)

    machine.view("machine")[2] = 5

    assert ring.observe().read("machine.cycles") == 5
    assert not machine.view("solver").flags.writeable
    with pytest.raises(rths.Error, match="through view"):
        machine.write("machine.cycles", 6)


def test_a_view_outlives_its_ring(map_file):
    ring = rths.in_process_ring(map_file)
    node = ring.join("solver")
    node.write("solver.state", 3)
    words = node.view("solver")

    ring.close()
    node.leave()
    del ring, node
    gc.collect()

    assert words[0] == 3


def test_a_follower_gets_each_write_once_and_in_order(ring):
    solver = ring.join("solver")
    follower = ring.follow("solver.*", idle_s=0.01)

    for state in range(100):
        solver.write("solver.state", state)

    assert [write.values for write in follower] == [{"solver.state": state} for state in range(100)]


def test_a_follower_gets_a_group_in_one_piece(ring):
    follower = ring.follow("machine.force", "machine.cycles")

    ring.join("machine").write_all({"machine.cycles": 9, "machine.force": 1e3})

    assert follower.wait(1) == rths.Write("machine", {"machine.force": 1e3, "machine.cycles": 9})
    assert follower.wait(0) is None


def test_following_ends_while_a_node_keeps_writing(ring):
    solver, ends = ring.join("solver"), threading.Event()
    follower = ring.follow("solver.state", idle_s=5, for_s=0.05)

    def write():
        while not ends.wait(0.001):
            solver.write("solver.state", 1)

    thread = threading.Thread(target=write)
    thread.start()
    writes = list(follower)
    ends.set()
    thread.join()

    assert writes


def test_other_threads_run_while_one_waits(ring):
    solver, follower, found = ring.join("solver"), ring.follow("solver.state"), []
    thread = threading.Thread(target=lambda: found.append(follower.wait(5)))
    thread.start()
    begun = time.monotonic()
    while not found and thread.is_alive() and time.monotonic() < begun + 5:
        solver.write("solver.state", 1)
        time.sleep(0.001)
    thread.join()

    assert found == [rths.Write("solver", {"solver.state": 1.0})]


def test_a_follower_waits_in_one_thread(ring):
    follower = ring.follow("solver.state")
    thread = threading.Thread(target=follower.wait, args=(0.1,))
    thread.start()
    with pytest.raises(rths.Error, match="another thread"):
        while thread.is_alive():
            follower.wait(0)
    thread.join()


def test_writes_beyond_a_journal_are_reported_as_lost(ring):
    solver, follower = ring.join("solver"), ring.follow("solver.state")
    for _ in range(2**12 + 10):
        solver.write("solver.state", 1)

    with pytest.raises(rths.LostWrites):
        follower.wait(0)
    solver.write("solver.state", 2)

    assert follower.wait(1).values == {"solver.state": 2}


@pytest.mark.parametrize("timeout_s", [-1, math.nan, math.inf])
def test_every_wait_has_a_deadline(ring, timeout_s):
    with pytest.raises(rths.Error, match="timeout_s"):
        ring.follow("solver.state").wait(timeout_s)


def test_an_interrupt_ends_a_wait(ring):
    follower = ring.follow("solver.state")
    timer = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    begun = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        follower.wait(10)
    timer.join()
    assert time.monotonic() - begun < 5


def test_a_ring_is_shared_by_processes_and_removed_at_the_end(map_file):
    name = f"test_python_{os.getpid()}"
    script = (f"import rths; ring = rths.attach('{name}'); node = ring.join('machine'); "
              "node.write('machine.cycles', 4); print(node.read('solver.displacement'))")
    with rths.create_ring(name, map_file) as ring:
        ring.join("solver").write("solver.displacement", 0.125)
        assert name in rths.ring_names()
        other = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=True)
        assert other.stdout.strip() == "0.125"
        assert ring.observe().read("machine.cycles") == 4
    assert name not in rths.ring_names()


def test_a_truncated_ring_is_an_error_and_does_not_end_the_program(map_file):
    name = f"test_truncated_{os.getpid()}"
    with rths.create_ring(name, map_file) as ring:
        node = ring.join("solver")
        words = node.view("solver")
        (file,) = pathlib.Path("/dev/shm").glob(f"*{name}")
        os.truncate(file, 0)

        with pytest.raises(rths.Error, match="was lost"):
            node.read("solver.state")
        assert words[0] == 0


def test_a_ring_that_does_not_exist_is_an_error():
    with pytest.raises(rths.Error, match="no_such_ring"):
        rths.attach("no_such_ring")


def test_an_unknown_map_is_an_error_that_lists_the_known():
    with pytest.raises(rths.Error, match="expected a file or one of: .*srmd"):
        rths.in_process_ring("srmdd")
