# SPDX-License-Identifier: Apache-2.0
"""Maps the tool's ranges of time, frequency and state to the generator's cells."""
import math

COVERED = 0.5  # fraction of a cell that the tool's ranges must cover
FINE = 8  # sampling points of a state cell along each side


def _finite(ranges):
    """Ranges with infinity in place of JSON's null."""
    return [(-math.inf if a is None else a, math.inf if b is None else b) for a, b in ranges]


def _overlap(low, high, ranges):
    """Length of [low, high] inside a union of ranges."""
    held, reached = 0.0, low
    for begin, end in sorted((max(a, low), min(b, high)) for a, b in _finite(ranges)):
        begin = max(begin, reached)
        if end > begin:
            held += end - begin
            reached = end
    return held


def _cells_along(edges, ranges):
    return {cell for cell, (low, high) in enumerate(zip(edges, edges[1:]))
            if _overlap(low, high, ranges) >= COVERED * (high - low)}


def time_cells(intervals, step):
    """Cells of `step` seconds that the intervals cover."""
    last = max((b for _, b in intervals), default=0)
    edges = [k * step for k in range(int(last / step) + 2)]
    return _cells_along(edges, intervals)


def frequency_cells(bands, edges):
    """Third octaves that the bands cover."""
    return _cells_along(edges, bands)


def _holds(rectangle, u, v):
    (u0, u1), (v0, v1) = _finite([rectangle["displacement_m"], rectangle["velocity_m_per_s"]])
    return u0 <= u < u1 and v0 <= v < v1


def state_cells(rectangles, cells):
    """Cells of displacement × velocity that the rectangles cover.

    @param cells  the generator's: cells per side, half ranges
    """
    side = int(cells["state_cells_per_side"])
    reach_u, reach_v = cells["state_displacement_m"], cells["state_velocity_m_per_s"]
    centres = [(2 * (i + 0.5) / (side * FINE) - 1) for i in range(side * FINE)]
    held = {}
    for i, u in enumerate(centres):
        for j, v in enumerate(centres):
            if any(_holds(r, u * reach_u, v * reach_v) for r in rectangles):
                cell = i // FINE * side + j // FINE
                held[cell] = held.get(cell, 0) + 1
    return {cell for cell, points in held.items() if points >= COVERED * FINE * FINE}


def overlap(said, truth):
    """Intersection over union of two sets of cells; None if both are empty."""
    union = set(said) | set(truth)
    return len(set(said) & set(truth)) / len(union) if union else None


def compare(where, place, cells):
    """{"time", "frequency", "state"}: intersections over unions.

    @param where  of the verdict
    @param place  of the answer
    """
    return {
        "time": overlap(time_cells(where.get("intervals_s", []), cells["time_s"]),
                        place["time_cells"]),
        "frequency": overlap(frequency_cells(where.get("band_Hz", []), cells["frequency_edges_Hz"]),
                             place["frequency_cells"]),
        "state": (None if place["state_cells"] is None
                  else overlap(state_cells(where.get("state", []), cells), place["state_cells"])),
    }
