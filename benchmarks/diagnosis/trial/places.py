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


def overlap(said, truth, share=None):
    """Intersection over union of two sets of cells; None if both are empty.

    @param share  energy of each cell, by which it counts; None: all count alike
    """
    union = set(said) | set(truth)
    if share is not None:
        def weight(cells):
            return sum(share[cell] for cell in cells if cell < len(share))
        whole = weight(union)
        return weight(set(said) & set(truth)) / whole if whole else None
    return len(set(said) & set(truth)) / len(union) if union else None


def compare(where, place, cells, by_energy=False):
    """{"time", "frequency", "state"}: intersections over unions.

    @param where      of the verdict
    @param place      of the answer
    @param by_energy  every cell counts with its energy
    """
    is_in_time = not where.get("intervals_rows")  # rows without time have no band and no state
    said = {"time": time_cells(where.get("intervals_s", []), cells["time_s"]),
            "frequency": frequency_cells(where.get("band_Hz", []), cells["frequency_edges_Hz"]) if is_in_time else None,
            "state": state_cells(where.get("state", []), cells) if is_in_time and place["state_cells"] is not None else None}
    return {axis: None if own is None else overlap(own, place[f"{axis}_cells"], place[f"{axis}_share"] if by_energy else None)
            for axis, own in said.items()}
