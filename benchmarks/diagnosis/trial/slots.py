# SPDX-License-Identifier: Apache-2.0
"""What each case of a family conceals and under which conditions: a fixed sequence that repeats."""
import dataclasses

NOISE = {"noisy": 0.01}  # standard deviation over the rms of the signal
STANDARD_NOISE = 0.003
SIZE = {"small": 0.25}
REST_S = 2.0  # at the start of a record


@dataclasses.dataclass(frozen=True)
class Slot:
    tier: str
    kind: str  # none, library, pair, outside

    @property
    def noise(self):
        return NOISE.get(self.tier, STANDARD_NOISE)

    @property
    def size(self):
        return SIZE.get(self.tier, 1.0)

    def duration(self, standard):
        return standard / 2 if self.tier == "short" else standard


SLOTS = [Slot(*pair) for pair in (
    ("standard", "library"), ("pairs", "pair"), ("standard", "none"), ("standard", "outside"), ("small", "library"),
    ("noisy", "library"), ("missing", "library"), ("noisy", "none"), ("pairs", "pair"), ("short", "library"))]


def slot(number):
    return SLOTS[number % len(SLOTS)]


def effects_for(kind, rng, library, outsiders):
    """Random effects of a case of this kind; those of a pair act on different things."""
    if kind == "none":
        return []
    if kind == "outside":
        return [outsiders[rng.integers(len(outsiders))]]
    first = library[rng.integers(len(library))]
    if kind == "library":
        return [first]
    others = [effect for effect in library if _differ(first, effect)]
    return [first, others[rng.integers(len(others))]]


def _differ(one, other):
    def contains(a, b):
        return b.name in a.special_case_of or bool(set(a.special_case_of) & set(b.special_case_of))
    return one.name != other.name and not contains(one, other) and not contains(other, one)
