#!/usr/bin/env python3
"""Plays the machine of two_signals.ringmap.toml: a spring answers every command with its force.

    spring_machine.py RING [--stiffness-N-per-m K] [--silent-s S]

Ends with 0 if the solver sends no command for S seconds.
"""
import argparse
import sys

import rths


def play(ring_name, stiffness, silent_s):
    """stiffness: of the spring [N/m]; silent_s: ends after this time without a command [s]"""
    with rths.attach(ring_name) as ring:
        commands = ring.follow("solver.displacement")  # before it joins: then others take it as ready
        with ring.join("machine") as machine:
            while (command := commands.wait(silent_s)) is not None:
                machine.write("machine.force", stiffness * command.values["solver.displacement"])
                machine.beat()


def main():
    parser = argparse.ArgumentParser(description="Plays a spring as the machine of a ring.")
    parser.add_argument("ring")
    parser.add_argument("--stiffness-N-per-m", type=float, default=1e6, dest="stiffness")
    parser.add_argument("--silent-s", type=float, default=10.0)
    arguments = parser.parse_args()
    try:
        play(arguments.ring, arguments.stiffness, arguments.silent_s)
    except rths.Error as error:
        sys.exit(f"spring_machine: {error}")


if __name__ == "__main__":
    main()
