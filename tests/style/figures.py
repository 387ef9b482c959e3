#!/usr/bin/env python3
"""Checks that the figures of README.md and of the result tables of docs agree with committed results.

    tests/style/figures.py            checks; prints one line per wrong figure and exits with 1 if there is one
    tests/style/figures.py --write    copies the results into the pages, then checks

docs/figures.toml binds figures to results and describes the format. Standard library only.
"""
import argparse
import collections
import dataclasses
import json
import pathlib
import re
import string
import sys
import tomllib

TREE = pathlib.Path(__file__).resolve().parents[2]
BINDINGS = "docs/figures.toml"
NUMBER = re.compile(r"\d+(?:[.,]\d+)*(?:e[-+]\d+)?")
ALONE = (r"(?<!\d)(?<!\d[.,])", r"(?!\d|[.,]\d)")  # no part of a longer number
NUMERIC_FIELD = ALONE[0] + rf"([−+]?{NUMBER.pattern}|–)" + ALONE[1]
TEXT_FIELD = r"([^|]+?)"


class Missing(Exception):
    """A result file or a value in it does not exist."""


def comments_in(text):
    """Spans of the comments, which no reader sees."""
    return [comment.span() for comment in re.finditer(r"<!--.*?-->", text, re.DOTALL)]


class Node:
    """A value of a result file, for the fields of str.format: `rows[word].p50_ns`, `bearings[*].dual_ratio`."""

    def __init__(self, value):
        self._value = value

    def __getitem__(self, key):
        value = self._value
        if key == "*" and isinstance(value, list):
            return Nodes([Node(item) for item in value])
        if isinstance(value, dict) and key in value:
            return Node(value[key])
        if isinstance(value, list) and isinstance(key, int) and key < len(value):
            return Node(value[key])
        if isinstance(value, list):
            for item in value:
                if isinstance(item, dict) and key in (item.get("name"), item.get("protocol")):
                    return Node(item)
        raise Missing(key)

    __getattr__ = __getitem__


class Nodes:
    """The same field of every item of a list."""

    def __init__(self, nodes):
        self._nodes = nodes

    @property
    def _value(self):
        return [node._value for node in self._nodes]

    def __getattr__(self, key):
        return Nodes([node[key] for node in self._nodes])


def missed_goals(ring):
    """Names of the rows of ring.json that miss their goal."""
    more_is_better = ("times_cheaper", "times_ours")
    return [row["name"] for row in ring["rows"] + ring["peers"] if row["goal"] is not None and
            (row["value"] < row["goal"] if row["quantity"] in more_is_better else row["value"] > row["goal"])]


def single_tests(results):
    """How many of each test that was made once were completed: one that ended early has no delay."""
    return {name: {"tests": 1, "completed": int("delay_ms" in test)} for name, test in results.items()
            if isinstance(test, dict) and name != "machine" and "tests" not in test}


DERIVED = {"benchmarks/results/ring.json": {"missed_goals": missed_goals},
           "benchmarks/results/three_dimensions.json": {"single": single_tests}}


def ladders_in(text):
    """Rows {"name", …, {sizes}, size} of a test in C++: the size that is found, and the last one before it, which passes."""
    ladders = {}
    for name, sizes, found in re.findall(r'\{"(\w+)",.*\{([\d.e, -]+)\}, ([\d.e-]+)\}', text):
        sizes = [float(size) for size in sizes.split(",")]
        ladders[name] = {"found": float(found), "passed": sizes[sizes.index(float(found)) - 1]}
    return ladders


def load(root, name):
    """A source file as a dictionary; None if it does not exist. Of a page: the number of its ### headings."""
    path = root / name
    if not path.is_file():
        return None
    text = path.read_text()
    if path.suffix == ".md":
        return {"headings": len(re.findall(r"^### ", text, re.MULTILINE))}
    if path.suffix == ".toml":
        return tomllib.loads(text)
    if path.suffix == ".cpp":
        return ladders_in(text)
    document = json.loads(text)
    return document | {key: derive(document) for key, derive in DERIVED.get(name, {}).items()}


@dataclasses.dataclass
class Field:
    """A placeholder of a binding: `path[ / path][!l|!h|!s][:[*factor ]spec]`."""
    path: str
    conversion: str | None
    spec: str

    def source(self):
        return re.split(r"[.\[]", self.path)[0]

    def expected(self, sources):
        """The figure as the page has to show it."""
        values = [self.lookup(part.strip(), sources) for part in self.path.split(" / ")]
        value = values[0] if len(values) == 1 else values[0] / values[1]
        if self.conversion in ("l", "h"):
            value = min(value) if self.conversion == "l" else max(value)
        if isinstance(value, list):
            return ", ".join(f"`{item}`" for item in value)
        if value is None:
            return "–"
        factor, _, spec = self.spec[1:].partition(" ") if self.spec.startswith("*") else ("1", "", self.spec)
        if isinstance(value, str):
            if not spec.endswith("f"):
                return format(value, spec)
            value = float(value)
        scaled = value * float(factor) if factor != "1" else value
        text = format(scaled, spec)
        is_zero = text.startswith("-") and not text.strip("-0.")
        return text[1:] if is_zero else re.sub("^-", "−", text)

    @staticmethod
    def lookup(path, sources):
        try:
            return string.Formatter().get_field(path, (), sources)[0]._value
        except (Missing, KeyError, IndexError):
            raise Missing(path) from None


@dataclasses.dataclass
class Pattern:
    """A text of a page with placeholders, as a regular expression."""
    text: str
    regex: re.Pattern
    fields: list
    keys: int  # groups before the fields: the row's name


def literal(text):
    """A regular expression for text; any blanks match any others, … matches any text of a cell."""
    parts = [re.escape(part).replace("…", "[^|]*?") for part in re.split(r"\s+", text)]
    return r"\s+".join(parts)


def pattern_of(text, name="@", label="@"):
    """A binding; in those of rows, @ in a field is the row's name in the results and @ elsewhere its label on the page."""
    keys, source, fields = 0, "", []
    for before, path, spec, conversion in string.Formatter().parse(text):
        for part in re.split("(@)", before):
            source += f"({literal(label)})" if part == "@" else literal(part)
            keys += part == "@"
        if path is not None:
            fields.append(Field(path.replace("@", name), conversion, spec))
            source += TEXT_FIELD if conversion == "s" else NUMERIC_FIELD
    return Pattern(text.replace("@", label), re.compile(source), fields, keys)


def patterns_of(page):
    patterns = [pattern_of(text) for text in page.get("figures", [])]
    for rows in page.get("rows", []):
        for entry in rows["names"]:
            label, name = (entry, entry) if isinstance(entry, str) else entry
            patterns.append(pattern_of(rows["text"], name, label))
    return patterns


def ranges_of(text, page):
    """The parts of a page in which every number has to be bound: `all`, or the named sections with their subsections."""
    if page.get("complete") == "all":
        return [(0, len(text))]
    ranges = []
    for title in page.get("complete", []):
        heading = re.search(r"^(#+) " + re.escape(title) + r"$", text, re.MULTILINE)
        if heading is None:
            raise Missing(title)
        following = re.compile(r"^#{1,%d} " % len(heading[1]), re.MULTILINE).search(text, heading.end())
        ranges.append((heading.start(), following.start() if following else len(text)))
    return ranges


class Check:
    """The check of a tree; `texts` replaces pages, for the test of this check."""

    def __init__(self, root=TREE, texts=None):
        self.root = root
        self.texts = texts or {}
        self.bindings = tomllib.loads((root / BINDINGS).read_text())
        documents = {name: load(root, source["file"]) for name, source in self.bindings["sources"].items()}
        self.absent = {name for name, document in documents.items() if document is None}
        self.sources = {name: Node(document) for name, document in documents.items() if document is not None}
        self.patterns = {page["file"]: patterns_of(page) for page in self.bindings["page"]}
        self.waiting = collections.Counter()  # figures that wait for an absent source
        self.unchecked = {}  # page: spans of these figures
        self.problems = []

    def text_of(self, name):
        return self.texts.get(name) or (self.root / name).read_text()

    def file_of(self, source):
        return self.bindings["sources"][source]["file"]

    def run(self):
        """Problems, one line each."""
        for page in self.bindings["page"]:
            self.check_page(page)
        self.check_other_tables()
        for name, figures in sorted(self.waiting.items()):
            self.problems.append(f"{self.file_of(name)}: missing, {figures} figures depend on it; made by: "
                                 f"{self.bindings['sources'][name]['made_by']}")
        for name, source in self.sources.items():
            lacking = [key for key in ("commit", "date", "machine")
                       if self.file_of(name).endswith(".json") and key not in source._value]
            if lacking:
                self.problems.append(f"{self.file_of(name)}: has no {', '.join(lacking)}")
        return self.problems

    def check_page(self, page):
        name, text = page["file"], self.text_of(page["file"])
        covered, unchecked = [], []
        for line, found, expected, field, span in self.figures_of(page, text, covered, unchecked):
            if re.sub(r"\s+", " ", found) != expected:
                self.problems.append(f"{name}:{line}: found {found}, expected {expected} "
                                     f"({field.path} in {self.file_of(field.source())})")
        self.unchecked[name] = unchecked
        self.check_constants(page, text, covered)
        self.check_coverage(page, text, covered)
        self.check_rows(page, text)

    def figures_of(self, page, text, covered, unchecked):
        """Yields the figures that can be checked: line, found, expected, field, span."""
        for pattern in self.patterns[page["file"]]:
            matches = list(pattern.regex.finditer(text))
            if not matches:
                self.problems.append(f"{BINDINGS}: {page['file']} has no text like: {pattern.text}")
            for match in matches:
                covered += [match.span(group + 1) for group in range(pattern.keys)]
                for group, field in enumerate(pattern.fields, pattern.keys + 1):
                    covered.append(match.span(group))
                    if field.source() in self.absent:
                        self.waiting[field.source()] += 1
                        unchecked.append(match.span(group))
                        continue
                    try:
                        expected = field.expected(self.sources)
                    except Missing as missing:
                        self.problems.append(f"{BINDINGS}: {missing} is in no result; bound in {page['file']} by: {pattern.text}")
                        continue
                    yield text.count("\n", 0, match.start(group)) + 1, match[group], expected, field, match.span(group)

    def check_constants(self, page, text, covered):
        anywhere = page.get("anywhere", [])
        listed = collections.Counter(entry for entries in [*page.get("constants", {}).values(), anywhere] for entry in entries)
        for entry, times in listed.items():
            before = ALONE[0] if entry[0].isdigit() else ""
            after = ALONE[1] if entry[-1].isdigit() else ""
            spans = [match.span() for match in re.finditer(before + literal(entry) + after, text)]
            covered += spans
            if len(spans) != times and entry not in anywhere:
                self.problems.append(f"{BINDINGS}: {page['file']} has the constant '{entry}' {len(spans)} times, expected {times}")

    def check_coverage(self, page, text, covered):
        if not page.get("complete"):
            self.problems.append(f"{BINDINGS}: {page['file']} has no complete part")
        try:
            ranges = ranges_of(text, page)
        except Missing as title:
            self.problems.append(f"{BINDINGS}: {page['file']} has no section '{title}'")
            return
        marks = bytearray(len(text))
        for first, last in covered + comments_in(text):
            marks[first:last] = b"\1" * (last - first)
        for begin, end in ranges:
            for number in NUMBER.finditer(text, begin, end):
                if 0 in marks[number.start():number.end()]:
                    line = text.count("\n", 0, number.start()) + 1
                    self.problems.append(f"{page['file']}:{line}: {number[0]} is bound to no result and is no constant in {BINDINGS}")

    def check_rows(self, page, text):
        """Every row of a result is on the page, also those that do not flatter."""
        for path in page.get("all_of", []):
            if path.split(".")[0] in self.absent:
                continue
            for row in Field.lookup(path, self.sources):
                if f"| `{row['name']}`" not in text:
                    self.problems.append(f"{page['file']}: has no row `{row['name']}` of {path}")

    def check_other_tables(self):
        """A page of docs with numbers in its tables is bound, or listed with the reason why it holds no results."""
        listed = {page["file"] for page in self.bindings["page"]} | set(self.bindings["without_results"])
        for path in sorted((self.root / "docs").rglob("*.md")):
            name = str(path.relative_to(self.root))
            if name not in listed and re.search(r"^ *\|.*\d", path.read_text(), re.MULTILINE):
                self.problems.append(f"{name}: has numbers in tables, but neither figures nor a reason in {BINDINGS}")

    def write(self):
        """Copies the results into the pages; returns the number of changed figures."""
        changed = 0
        for page in self.bindings["page"]:
            text = self.text_of(page["file"])
            spans = {}
            for _, found, expected, _, span in self.figures_of(page, text, [], []):
                if re.sub(r"\s+", " ", found) != expected:
                    spans[span] = expected
            for (first, last), expected in sorted(spans.items(), reverse=True):
                text = text[:first] + expected + text[last:]
            if spans:
                (self.root / page["file"]).write_text(text)
            changed += len(spans)
        return changed


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("--write", action="store_true", help="copy the results into the pages first")
    arguments.add_argument("--root", type=pathlib.Path, default=TREE, help="the source tree")
    options = arguments.parse_args()
    if options.write:
        print(f"{Check(options.root).write()} figures changed")
    problems = Check(options.root).run()
    print(*problems, sep="\n" if problems else "", end="\n" if problems else "")
    print(f"{len(problems)} problems" if problems else "all figures agree with the results")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
