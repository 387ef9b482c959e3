#!/usr/bin/env python3
"""Holds the tree to the plan of the house, house.toml, and prints its figures.

    tests/house/house.py TARGETS [--list FIGURE] [--tighten]
    tests/house/house.py TARGETS --graph GRAPH.json HOUSE.svg
    tests/house/house.py TARGETS --compare HOUSE.svg

TARGETS is the file targets.json of a build folder. Exits with 1 if a figure is above its limit, or if the picture is not
that of the tree. --list prints the places behind a figure. --tighten lowers limits to the figures. --graph writes folders
and arrows, and draws them. Standard library only.
"""
import argparse
import json
import pathlib
import re
import sys

import picture
import tree

PLAN = pathlib.Path(__file__).parent / "house.toml"
MOST_LINES = {"file": 450, "function": 60}
GROUPS = ("adapters", "broker", "diagnosis")  # folders whose folders are targets


def arrow_text(arrow, places):
    return f"{arrow.user} -> {arrow.used}  ({', '.join(sorted(set(places))[:3])})"


def forbidden_arrows(house):
    return [arrow_text(arrow, places) for arrow, places in house.arrows.items()
            if house.allowed(arrow.user) is not None and not house.is_allowed(arrow)]


def arrows_at_a_distance(house):
    return [f"{user} reaches {used}" for user, used in house.wrong_at_a_distance()]


def folders_without_place(house):
    places = {house.place_of(target) for target in house.product_targets}
    return sorted(place for place in places if house.allowed(place) is None)


def private_includes(house):
    return [f"{source.path} includes {header}" for source, _, header in house.includes if "/include/" not in header]


def long_files(house, product):
    return [f"{source.path}: {source.lines}" for source in house.sources
            if source.lines > MOST_LINES["file"] and house.is_product(source.path) == product]


def long_functions(house):
    return [f"{source.path}:{function.line}: {function.name}, {function.lines}" for source in house.cpp_sources()
            for function in source.found.functions if function.lines > MOST_LINES["function"]]


def names_with_two_meanings(house):
    """Types defined in two files, in any namespace. A type inside another has the name of that one beside its own."""
    files = {}
    for source in house.cpp_sources():
        for found in source.found.types:
            files.setdefault(found.name, {})[source.path] = found.line
    return [f"{name}: {', '.join(f'{path}:{line}' for path, line in sorted(places.items()))}"
            for name, places in sorted(files.items()) if len(places) > 1]


def folders_without_readme(house):
    tops = {source.path.split("/")[0] for source in house.sources if "/" in source.path}
    parts = {target.folder for target in house.product_targets if target.folder.split("/")[0] in GROUPS}
    readmes = {str(path.relative_to(tree.TOP).parent) for path in tree.TOP.glob("*/README.md")} | {
        str(path.relative_to(tree.TOP).parent) for path in tree.TOP.glob("*/*/README.md")}
    return sorted((tops | parts) - readmes)


def product_lines(house):
    return [source.path for source in house.sources if house.is_product(source.path) for _ in range(source.lines)]


def counted(house, rule):
    """Places that a rule of [counted] finds."""
    patterns = [re.compile(pattern) for pattern in rule["patterns"]]
    for source in house.cpp_sources(product=False):
        wanted = house.is_product(source.path) or any(tree.below(source.path, folder) for folder in rule.get("also", []))
        if not wanted or re.search(rule.get("except", "^$"), source.path):
            continue
        if rule["in"] == "files" and all(pattern.search(source.plain) for pattern in patterns):
            yield source.path
        if rule["in"] == "lines":
            yield from (f"{source.path}:{number}" for number, line in enumerate(source.text.splitlines(), 1)
                        if all(pattern.search(line) for pattern in patterns))
        if rule["in"] in ("functions", "names"):
            for function in source.found.functions:
                text = function.name if rule["in"] == "names" else function.body
                if all(pattern.search(text) for pattern in patterns):
                    yield f"{source.path}:{function.line}: {function.name}"


def figures_of(house):
    """The places behind each figure, in the order of the plan."""
    found = {
        "forbidden arrows": forbidden_arrows(house),
        "forbidden arrows at a distance": arrows_at_a_distance(house),
        "folders without a place": folders_without_place(house),
        "private includes": private_includes(house),
        "files over 450 lines": long_files(house, True),
        "functions over 60 lines": long_functions(house),
        "files of tests and benchmarks over 450 lines": long_files(house, False),
        "type names with two meanings": names_with_two_meanings(house),
        "folders without README": folders_without_readme(house),
        "lines of the product": product_lines(house),
    }
    found |= {name: list(counted(house, rule)) for name, rule in house.plan["counted"].items()}
    return {name: found[name] for name in house.plan["figures"]}


def tightened(text, found):
    """The text of the plan with each limit lowered to its figure."""
    for name, places in found.items():
        pattern = re.compile(rf'^("{re.escape(name)}" = {{limit = )(\d+)', re.MULTILINE)
        text = pattern.sub(lambda at: at.group(1) + str(min(int(at.group(2)), len(places))), text)
    return text


def print_table(plan, found):
    print(f"{'figure':46}{'now':>8}{'limit':>8}{'goal':>8}")
    for name, places in found.items():
        rule = plan["figures"][name]
        note = "  ABOVE ITS LIMIT" if len(places) > rule["limit"] else ""
        print(f"{name:46}{len(places):8}{rule['limit']:8}{rule['goal']:8}{note}")


def is_held(plan, found):
    """Prints the figures, and the places behind each that is above its limit."""
    print_table(plan, found)
    above = [name for name, places in found.items() if len(places) > plan["figures"][name]["limit"]]
    for name in above:
        print(f"\n{name}:")
        print("\n".join(f"  {place}" for place in sorted(set(found[name]))[:40]))
    return not above


def is_current(path, drawn):
    """True if the picture in the file is the one of the tree."""
    if path.is_file() and path.read_text() == drawn:
        return True
    print(f"{path} is not the picture of the targets as they are. This draws it:\n"
          "  python3 tests/house/house.py build/release/targets.json --graph /dev/null docs/images/house.svg")
    return False


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("targets", help="the file targets.json of a build folder")
    parser.add_argument("--list", metavar="FIGURE", help="prints the places behind a figure")
    parser.add_argument("--tighten", action="store_true", help="lowers limits to the figures")
    parser.add_argument("--graph", nargs=2, type=pathlib.Path, metavar=("JSON", "SVG"), help="writes folders and arrows")
    parser.add_argument("--compare", type=pathlib.Path, metavar="SVG", help="fails if the picture is an older one")
    options = parser.parse_args()
    house = tree.Tree.read(options.targets)
    if options.graph:
        graph = picture.graph_of(house)
        options.graph[0].write_text(json.dumps(graph, indent=2) + "\n")
        options.graph[1].write_text(picture.draw(graph))
        return 0
    if options.compare:
        return 0 if is_current(options.compare, picture.draw(picture.graph_of(house))) else 1
    found = figures_of(house)
    if options.list:
        print("\n".join(found[options.list]))
        return 0
    if options.tighten:
        PLAN.write_text(tightened(PLAN.read_text(), found))
        house.plan["figures"] = tree.tomllib.loads(PLAN.read_text())["figures"]
    return 0 if is_held(house.plan, found) else 1


if __name__ == "__main__":
    sys.exit(main())
