#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes a table of a recording that a page names but nobody has: table FILE COLUMN…

The first column is the time, 2 s at rest and 8 s of motion at 200 Hz; the others are smooth, with noise of 0.1 %.
"""
import math
import random
import sys

RATE_HZ, REST_S, END_S = 200, 2, 10


def main():
    name, *columns = sys.argv[1:]
    draw = random.Random(name)
    phases = [[draw.uniform(0, 6.28) for _ in range(4)] for _ in columns]
    with open(name, "w", encoding="utf-8") as file:
        print(",".join(columns), file=file)
        for row in range(END_S * RATE_HZ):
            time = row / RATE_HZ
            growth = max(0.0, min(1.0, time - REST_S))
            values = [growth * sum(math.sin((3 + 4 * k) * time + phase) for k, phase in enumerate(these)) + draw.gauss(0, 1e-3)
                      for these in phases[1:]]
            print(",".join(f"{value:.6g}" for value in [time, *values]), file=file)


if __name__ == "__main__":
    main()
