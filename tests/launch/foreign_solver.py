#!/usr/bin/env python3
"""A solver in Python on the vendor's library alone: examples/foreign/block.h along both axes.

    foreign_solver.py LIBRARY HEADER MOTION STEP_S DURATION_S

LIBRARY is libplus.so, HEADER is printed by `rths map gen srmd --lang c`. Standard library only."""
import csv
import ctypes
import re
import sys
import time

DEADLINE_S = 5
MASS = 987656  # on the bearing [kg]
library, header, motion_file, step, duration = *sys.argv[1:4], float(sys.argv[4]), float(sys.argv[5])

text = open(header).read()
offset = {name: int(value) for name, value in re.findall(r"#define SRMD_(\w+) (\d+)u\n", text)}
scale = {name: float(value) for name, value in re.findall(r"#define SRMD_(\w+)_SCALE ([\d.e+-]+)", text)}

plus = ctypes.CDLL(library)
if plus.sp_scram_init(0) < 0:
    sys.exit("no card")
plus.get_base_mem.restype = ctypes.c_void_p
memory = plus.get_base_mem()


def number(name):
    return ctypes.c_float.from_address(memory + 4 * offset[name])


def flag(name):
    return ctypes.c_int32.from_address(memory + 4 * offset[name])


def wait_for(name, expected):
    word, deadline = flag(name), time.monotonic() + DEADLINE_S
    while word.value != expected:
        if time.monotonic() > deadline:
            sys.exit(f"{name} is not {expected} after {DEADLINE_S} s")
        time.sleep(50e-6)


rows = [[float(cell) for cell in row] for row in list(csv.reader(open(motion_file)))[1:]]
interval = rows[1][0] - rows[0][0]


def ground(axis, at):
    row, part = int(at / interval), at / interval % 1
    return rows[row][axis] + part * (rows[row + 1][axis] - rows[row][axis]) if row + 1 < len(rows) else 0


axes = {"LONG": 1, "LAT": 2}
displ, veloc, accel = ({axis: 0.0 for axis in axes} for _ in range(3))
wait_for("DAQ_ATTARGET", 1)
for i in range(1, round(duration / step) + 1):
    for axis in axes:
        displ[axis] += step * veloc[axis] + step**2 / 2 * accel[axis]
        name = f"OPF_{axis}_DISPL_TARGET"
        number(name).value = displ[axis] / scale[name]
    number("OPF_1_TIME_TARGET").value = i * step
    flag("OPF_NEWTARGET").value = 1
    wait_for("DAQ_SWITCHPC", 1)
    flag("OPF_NEWTARGET").value = 0
    wait_for("DAQ_SWITCHPC", 0)
    wait_for("DAQ_ATTARGET", 1)
    for axis, column in axes.items():
        name = f"DAQ_{axis}_FORCE_FBK"
        after = -number(name).value * scale[name] / MASS - ground(column, i * step)
        veloc[axis] += step / 2 * (accel[axis] + after)
        accel[axis] = after
flag("OPF_NEWTARGET").value = -1
time.sleep(0.02)
print(f"the block is at {1e3 * displ['LONG']:.1f} mm, {1e3 * displ['LAT']:.1f} mm")
