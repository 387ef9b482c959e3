#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs a command beside a ring of the default names, and checks that nobody joins it or writes to it.

    canary.py MAP COMMAND…

Exits with the code of the command; with 1 if somebody used the ring, or left another one.
"""
import subprocess
import sys

import rths

DEFAULT_NAME = "scramnet"  #: of the ring of programs for the cards that name none


def main():
    map_file, command = sys.argv[1], sys.argv[2:]
    before = set(rths.ring_names())
    with rths.create_ring(DEFAULT_NAME, map_file) as ring, ring.observe() as observer:
        writes = ring.follow()
        code = subprocess.run(command, check=False).returncode
        found = [f"{write.node} wrote {write.values}" for write in iter(lambda: writes.wait(0), None)]
        found += [f"node {node} joined" for node in ring.nodes if observer.presence_of(node) != "absent"]
    found += [f"ring '{name}' is left" for name in sorted(set(rths.ring_names()) - before)]
    for line in found:
        print(f"canary: {line}, expected none", file=sys.stderr)
    return 1 if found else code


if __name__ == "__main__":
    sys.exit(main())
