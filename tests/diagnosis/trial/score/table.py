# SPDX-License-Identifier: Apache-2.0
"""The score table: rates with Wilson's intervals, medians with quantiles, and their required values."""
from chance import fewest, median, quantile, wilson


class Rate:
    """A number of hits among a number of rows."""

    def __init__(self, key, label, rows, is_hit, bar=None):
        self.key, self.label, self.bar = key, label, bar
        self.of, self.hits = len(rows), sum(1 for row in rows if is_hit(row))

    def text(self):
        if not self.of:
            return "no case"
        low, high = wilson(self.hits, self.of)
        return f"{self.hits}/{self.of} = {self.hits / self.of:.3f}  [{low:.3f}, {high:.3f}]"

    def asked(self):
        return "" if self.bar is None else f"≥ {self.bar:.2f}"

    def is_met(self):
        return self.bar is None or not self.of or self.hits >= self.bar * self.of

    def is_refuted(self):
        """Whether the required rate would give so few hits with at most 1 % probability."""
        return self.bar is not None and self.hits < fewest(self.of, self.bar)

    def as_json(self):
        low, high = wilson(self.hits, self.of)
        return {"hits": self.hits, "of": self.of, "wilson95": [low, high], "asked": self.bar}


class Median:
    """Median of values, of which more or less is better."""

    def __init__(self, key, label, values, bar=None, more_is_better=False, digits=3):
        self.key, self.label, self.bar, self.digits = key, label, bar, digits
        self.more_is_better = more_is_better
        self.values = [value for value in values if value is not None]

    def _tail(self):
        return quantile(self.values, 0.1 if self.more_is_better else 0.9)

    def text(self):
        if not self.values:
            return "no case"
        tail = "10" if self.more_is_better else "90"
        return (f"{median(self.values):.{self.digits}g}  ({tail} %: {self._tail():.{self.digits}g}; "
                f"{len(self.values)} values)")

    def asked(self):
        return "" if self.bar is None else f"{'≥' if self.more_is_better else '≤'} {self.bar:g}"

    def _passes(self, value):
        return value >= self.bar if self.more_is_better else value <= self.bar

    def is_met(self):
        return self.bar is None or not self.values or self._passes(median(self.values))

    def is_refuted(self):
        """Whether the required median would leave so few values on its good side with at most 1 % probability."""
        good = sum(1 for value in self.values if self.bar is not None and self._passes(value))
        return self.bar is not None and good < fewest(len(self.values), 0.5)

    def as_json(self):
        if not self.values:
            return {"of": 0, "asked": self.bar}
        return {"median": median(self.values), "tail": self._tail(), "of": len(self.values),
                "asked": self.bar}


class Mean:
    """A mean count per case."""

    def __init__(self, key, label, rows, count):
        self.key, self.label = key, label
        self.of, self.sum = len(rows), sum(count(row) for row in rows)

    def text(self):
        return f"{self.sum} in {self.of} = {self.sum / self.of:.3f}" if self.of else "no case"

    def asked(self):
        return ""

    def is_met(self):
        return True

    def is_refuted(self):
        return False

    def as_json(self):
        return {"sum": self.sum, "of": self.of}


def _names(rows):
    single = [r for r in rows if r["kind"] == "library"]
    seen = [r for r in single if r["detectable"]]
    clear = [r for r in seen if r["distinguishable"]]
    alike = [r for r in seen if not r["distinguishable"]]
    pairs = [r for r in rows if r["kind"] == "pair"]
    none = [r for r in rows if r["kind"] == "none"]
    return [
        Rate("right_first", "named right first (detectable, distinguishable)", clear,
             lambda r: r["right_first"], 0.95),
        Rate("right_in_tie", "right in the tie (detectable)", seen, lambda r: r["right_in_tie"]),
        Rate("ties", "  of these: indistinguishable from a rival, reported as a tie", alike,
             lambda r: r["right_in_tie"]),
        Rate("right_first_all", "named right first (all, including undetectable)", single,
             lambda r: r["right_first"]),
        Mean("alternatives", "alternatives per case with a cause",
             [r for r in rows if r["names"]], lambda r: len(r["alternatives"])),
        Rate("both_named", "both effects of a pair", pairs, lambda r: r["all_named"]),
        Mean("spurious", "spurious names per case", rows, lambda r: len(r["spurious"])),
        Mean("spurious_library", "  where the effect is in the library", single,
             lambda r: len(r["spurious"])),
        Rate("rule", "wrong rule of hysteresis, reported",
             [r for r in rows if r["has_wrong_rule"]], lambda r: r["rules"]),
        Rate("rule_right", "  right rule, not blamed",
             [r for r in rows if not r["has_wrong_rule"]], lambda r: not r["rules"]),
        Rate("silent", "silent where nothing is missing", none,
             lambda r: r["outcome"] == "none", 1.0),
    ]


def _abstentions(rows):
    outside = [r for r in rows if r["kind"] == "outside"]
    seen = [r for r in outside if r["detectable"]]
    return [
        Rate("abstained", "outsiders: unknown, or with a remainder", outside,
             lambda r: r["abstained"], 0.9),
        Rate("abstained_seen", "  detectable ones", seen, lambda r: r["abstained"]),
        Rate("form", "  with the right form first", outside, lambda r: r["form_right"]),
    ]


def _places(rows):
    seen = [r for r in rows if r["kind"] in ("library", "outside") and r["detectable"]]
    library = [r for r in seen if r["kind"] == "library"]
    faults = [r for r in library if r["part_truth"] == "sensor"]
    table = [
        Rate("part", "part right (detectable, library)", library, lambda r: r["part_right"], 0.95),
        Rate("part_all", "  with outsiders", seen, lambda r: r["part_right"]),
        Rate("channel", "channel right (detectable faults of a channel)", faults,
             lambda r: r["channel_right"], 0.95),
    ]
    for quantity, bar in (("time", 0.80), ("frequency", 0.88), ("state", 0.85)):
        for whose, key, asked in (("", "iou", bar), (" of the effect before any refit", "iou_effect", None)):
            table.append(Median(f"{key}_{quantity}", f"intersection over union, {quantity}{whose}",
                                [r[key][quantity] for r in library], asked, more_is_better=True))
    return table


def _sizes_and_proof(rows):
    right = [r for r in rows if r["kind"] == "library" and r["detectable"] and r["right_first"]]
    forces = [r for r in right if r["channel_truth"] == "force"]
    found = [size for r in right for size in r["sizes"]]
    intervals = [size for size in found if size["covered"] is not None]
    return [
        Median("size_error", "error of sizes (named right)", [s["error"] for s in found]),
        Rate("coverage", "95 % intervals that contain the size", intervals, lambda s: s["covered"]),
        Median("before", "error on the unseen record before, NRMSE", [r["nrmse_before"] for r in forces]),
        Median("after", "  after", [r["nrmse_after"] for r in forces]),
        Median("oracle", "  of the oracle", [r["oracle"] for r in forces]),
        Median("ratio", "  after over oracle", [r.get("after_to_oracle") for r in forces]),
        Median("variance", "whitened variance after naming, unseen record",
               [r["variance_after"] for r in right], 1.05),
        Rate("white", "residual white after naming", right, lambda r: r["white"]),
    ]


def _cost(rows):
    return [
        Rate("finished", "cases that end in a verdict", rows, lambda r: r["outcome"] != "failed", 1.0),
        Median("cpu_s", "seconds per case, processor", [r.get("cpu_s") for r in rows], 5),
        Median("wall_s", "seconds per case, clock, on one core", [r.get("wall_s") for r in rows]),
    ]


def score(rows):
    """All rows of the table, from the rows of the cases."""
    return _names(rows) + _abstentions(rows) + _places(rows) + _sizes_and_proof(rows) + _cost(rows)


def print_table(table):
    width = max(len(row.label) for row in table)
    for row in table:
        mark = "" if row.is_met() else "   MISSED"
        print(f"{row.label:<{width}}  {row.text():<44}{row.asked()}{mark}")


def _three(values):
    return "/".join("  - " if v is None else f"{v:.2f}" for v in values.values())


def print_cases(rows):
    """One line each: concealed effects, verdict, place, and a mark for an error."""
    for r in rows:
        truth = " + ".join(r["truth"]) or "none"
        named = ", ".join(r["names"]) or "-"
        also = f" ({', '.join(r['alternatives'])})" if r["alternatives"] else ""
        rest = " + remainder" if r["remainder"] else ""
        print(f"case_{r['case']:<4}{mark(r):<2}{truth:<28}{visibility(r):<18}{r['outcome']}: {named}{also}{rest}"
              f"{forms(r)}  | {r['part']}, {r['channel']} | "
              f"{_three(r['iou']) if 'iou' in r else ''} | {r.get('cpu_s') or 0:.1f} s")


def visibility(row):
    if "information" not in row:
        return ""
    tie = "" if row["distinguishable"] else " tie"
    return f"{row['information']:.0f} nat{tie}" if row["detectable"] else "too small"


def forms(row):
    return f" [{row['forms'][0]}]" if row["forms"] and row["outcome"] == "unknown" else ""


def mark(row):
    """'x' for a wrong verdict, 'p' if only the part is wrong, '.' for an undetectable effect."""
    if row["kind"] == "none":
        return "" if row["outcome"] == "none" else "x"
    if row["kind"] == "outside":
        return "" if row["abstained"] else "x"
    if not row["detectable"]:
        return "."
    right = row["all_named"] if row["kind"] == "pair" else (
        row["right_first"] if row["distinguishable"] else row["right_in_tie"])
    if not right:
        return "x"
    return "" if row.get("part_right", True) else "p"
