# SPDX-License-Identifier: Apache-2.0
"""Rings of this host: attach, join, read, write and follow signals by name, in SI."""
from __future__ import annotations

import dataclasses
import math
import pathlib
import time
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

from . import _rths
from .installation import map_file
from .names import matching

if TYPE_CHECKING:
    import numpy


@dataclasses.dataclass(frozen=True)
class Signal:
    """One longword of the ring with a name."""

    name: str
    unit: str  #: SI; "1": a pure number
    node: str  #: the only node that may write it
    partition: str
    offset: int  #: in the ring's memory [longwords], from 0
    type: str  #: of the longword: "i32", "u32" or "f32"
    range: tuple[float, float] | None  #: lowest and highest value [unit]
    values: Mapping[str, float]  #: names of an integer's values
    tear_group: bool  #: read and written together with its partition


@dataclasses.dataclass(frozen=True)
class Write:
    """One write of a node: a word, or all followed words of a tear group."""

    node: str
    values: Mapping[str, float]  #: by signal [SI]


class Ring:
    """A ring of this host, or one in the memory of this process. Close it, or use it in a `with` statement.

    Closing removes a ring that this object created. Nodes, followers and views that are still in use keep its memory.
    """

    def __init__(self, handle: _rths.Ring, name: str, *, is_own: bool):
        self._handle: _rths.Ring | None = handle
        self._is_own = is_own
        self.name = name  #: empty: in the memory of this process
        self.map_name = handle.map_name
        self.map_toml = handle.map_toml  #: the map of the ring, as its file
        self.nodes = tuple(handle.nodes())  #: names of the map's nodes
        self.signals = {entry["name"]: Signal(**entry) for entry in handle.signals()}

    def join(self, node: str, *, plain: bool = False) -> Node:
        """Joins as a node of the map, to write its signals.

        plain: the node stores its words through `Node.view`, as programs for the cards do. No journal records these
        stores, so only a watch of the ring makes them visible to followers.
        Raises Error if the map has no such node, or if the node is on the ring already.
        """
        return Node(self, self._open().join(node, plain))

    def observe(self) -> Node:
        """Joins as a node that only reads."""
        return Node(self, self._open().observe())

    def follow(self, *patterns: str, idle_s: float = 1.0, for_s: float = 60.0) -> Follower:
        """Follows the writes to the signals that match a pattern (`*`, `?`), from now on. See `Follower`."""
        return Follower(self._open().follow(self.matching(*patterns)), idle_s, for_s)

    def matching(self, *patterns: str) -> list[str]:
        """Names of the signals that match a pattern (`*`, `?`); all without a pattern.

        Raises Error for a pattern that matches no signal.
        """
        return matching(list(self.signals), patterns, f"the map '{self.map_name}'")

    def close(self) -> None:
        """Detaches, and removes the ring if this object created it. Closing twice has no effect."""
        if self._handle is None:
            return
        self._handle = None
        if self._is_own:
            _rths.remove_ring(self.name)

    def _open(self) -> _rths.Ring:
        if self._handle is None:
            raise _rths.Error(f"ring '{self.name}' was closed")
        return self._handle

    def __enter__(self) -> Ring:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Node:
    """Membership of this program on a ring. Reads every signal; writes those of its node. Values are in SI.

    Leave it, or use it in a `with` statement.
    """

    def __init__(self, ring: Ring, member: _rths.Node):
        self.ring = ring
        self._member = member

    @property
    def name(self) -> str:
        """Name of the node; empty for an observer."""
        return self._member.name

    def read(self, signal: str) -> float:
        """Value of a signal [SI]. Raises Error with the most similar name if there is no such signal."""
        return self._member.read([signal])[0]

    def read_all(self, *patterns: str) -> dict[str, float]:
        """Values [SI] by name of the signals that match. Those of one tear group are from the same write."""
        names = self.ring.matching(*patterns)
        return dict(zip(names, self._member.read(names)))

    def write(self, signal: str, value: float | str) -> None:
        """Writes a signal of this node.

        value: [SI], or the name of one of the signal's values.
        Raises Error, and writes nothing, if the signal belongs to another node or the value does not fit.
        """
        self._member.write([(signal, value)])

    def write_all(self, values: Mapping[str, float | str]) -> None:
        """Writes signals of this node in this order; those of one tear group in one piece. Checks all of them before."""
        self._member.write(list(values.items()))

    def view(self, partition: str) -> numpy.ndarray:
        """The longwords of a partition in the ring's memory, without a copy: uint32, raw, as nodes change them.

        `view.view("float32")` shows words of type f32. Not SI: words are in the units of the map. Read-only, except for
        the partitions of a node that joined with `plain=True`. A tear group may be torn; `read_all` reads it whole.
        """
        return self._member.view(partition)

    def beat(self) -> None:
        """Increments the heartbeat of this node, which other nodes watch, and dates its writes."""
        self._member.beat()

    def beats_of(self, node: str) -> int:
        """Heartbeats of a node since it joined; 0 if it is not on the ring."""
        return self._member.beats_of(node)

    def presence_of(self, node: str) -> str:
        """State of a node: "absent", "alive", or "vanished" if its process ended without leaving."""
        return self._member.presence_of(node)

    def wait_for_node(self, node: str, timeout_s: float) -> bool:
        """True as soon as a node is on the ring; False if it is not until the timeout [s]."""
        deadline = time.monotonic() + timeout_s
        while self.presence_of(node) != "alive":
            if time.monotonic() >= deadline:
                return False
            time.sleep(0.001)
        return True

    def leave(self) -> None:
        """Leaves the ring. Leaving twice has no effect; views stay valid."""
        self._member.leave()

    def __enter__(self) -> Node:
        return self

    def __exit__(self, *_: object) -> None:
        self.leave()


class Follower:
    """The writes to given signals, each once and in its writer's order. An iterator that always ends.

    It ends if there is no write for `idle_s`, and `for_s` after its first step [s]. Raises LostWrites if more writes came
    than a journal holds; it then continues at the newest. One thread waits; other threads of Python run meanwhile.
    """

    def __init__(self, follower: _rths.Follower, idle_s: float, for_s: float):
        self._follower = follower
        self._idle_s = idle_s
        self._for_s = for_s
        self._end = math.nan

    def wait(self, timeout_s: float) -> Write | None:
        """The next write, or None if there is none within the timeout [s]."""
        change = self._follower.wait(timeout_s)
        return None if change is None else Write(change.node, dict(change.values))

    def __iter__(self) -> Iterator[Write]:
        self._end = time.monotonic() + self._for_s
        return self

    def __next__(self) -> Write:
        if math.isnan(self._end):
            self._end = time.monotonic() + self._for_s
        left_s = self._end - time.monotonic()
        write = self.wait(min(self._idle_s, left_s)) if left_s > 0 else None
        if write is None:
            raise StopIteration
        return write


def attach(name: str) -> Ring:
    """Attaches to a ring of this host. Raises Error if there is none of that name."""
    return Ring(_rths.Ring.attach(name), name, is_own=False)


def create_ring(name: str, map: str | pathlib.Path) -> Ring:
    """Creates a ring to which other processes of this host can attach; closing it removes it.

    map: name of a built-in map ("srmd"), or a file.
    Raises Error if a ring of that name is in use.
    """
    return Ring(_rths.Ring.create(name, map_file(map)), name, is_own=True)


def in_process_ring(map: str | pathlib.Path) -> Ring:
    """A ring in the memory of this process, with the same words and rules."""
    return Ring(_rths.Ring.in_process(map_file(map)), "", is_own=False)


def ring_names() -> list[str]:
    """Names of all rings of this host."""
    return _rths.ring_names()
