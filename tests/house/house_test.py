#!/usr/bin/env python3
"""The functions of house.py and its modules, on small sources and trees."""
import sys
import unittest

import cpp
import house
import picture
import tree


def functions(text):
    return [(found.name, found.lines) for found in cpp.scan(text).functions]


def types(text):
    return [(found.space, found.name) for found in cpp.scan(text).types]


class Functions(unittest.TestCase):
    def test_are_counted_between_their_braces(self):
        self.assertEqual(functions("int f(int a) {\n  return a;\n}\nvoid g() {}\n"), [("f", 2), ("g", 0)])

    def test_have_members_among_them(self):
        self.assertEqual(functions("struct A { int f() const noexcept { return 1; } };\nint A::g() { return 2; }"), [("f", 0), ("g", 0)])

    def test_of_construction_have_lists_of_members(self):
        self.assertEqual(functions("A::A(int a) : a_{a}, b_(f({1})), c_{} {\n}\n"), [("A", 1)])

    def test_with_operators_have_names(self):
        self.assertEqual(functions("bool operator<(A a, A b) { return f(a, b); }\nint A::operator()(int) { return 1; }"),
                         [("operator<", 0), ("operator()", 0)])

    def test_with_templates_are_found(self):
        self.assertEqual(functions("template <class T, int n = 3>\nauto f(std::function<void(T)> a) -> std::vector<T> {\n}"), [("f", 1)])

    def test_have_lambdas_and_local_types_inside(self):
        self.assertEqual(functions("void f() {\n auto g = [](int a) { return a; };\n struct L { int h() { return 1; } };\n}"), [("f", 3)])

    def test_are_not_values_or_comments(self):
        self.assertEqual(functions('int a{3};\nconst A b = {f(1), {2}};\n// void g() {\nauto c = "void h() {";\n'), [])

    def test_keep_their_braces_with_characters_and_digits(self):
        self.assertEqual(functions("char f() {\n return '{';\n}\nint g() {\n return 1'000;\n}\n"), [("f", 2), ("g", 2)])


class Types(unittest.TestCase):
    def test_have_namespaces(self):
        self.assertEqual(types("namespace a::b { class C final : public D<int> {}; namespace { enum class E : int { x }; } }"),
                         [("a::b", "C"), ("a::b::(anonymous)", "E")])

    def test_declared_ahead_or_nested_are_none(self):
        self.assertEqual(types("struct A;\nstruct B { struct C { int d; }; };\nstruct B::E { };\ntemplate <> struct F<int> {};"), [("", "B")])

    def test_with_attributes_are_found(self):
        self.assertEqual(types("struct alignas(64) A {};\nstruct [[nodiscard]] B {};\ntemplate <class T> struct C {};"), [("", "A"), ("", "B"), ("", "C")])

    def test_of_c_are_no_functions(self):
        self.assertEqual(types("static struct point *f(int a) { return 0; }\ntypedef struct q { int a; } q;"), [("", "q")])


PLAN = {"outside": ["tests"], "names": {"algebra": "maths"}, "places": {"rths_all": "the table"},
        "arrows": {"core": [], "maths": [], "sim": ["maths"], "broker": [], "adapters": ["broker"], "adapters/*": ["adapters"],
                   "app": ["sim", "the table"], "the table": ["adapters/*"]},
        "never": {"sim": ["broker"]}, "counted": {}, "figures": {}}


def small(targets, sources=()):
    """A tree of targets "folder: used folders" and of sources (path, text)."""
    made = [tree.Target("rths_" + folder.replace("/", "_"), "STATIC_LIBRARY", folder, ["rths_" + used.replace("/", "_") for used in names])
            for folder, names in targets.items()]
    return tree.Tree(PLAN, [tree.Source(*source) for source in sources], made)


class Arrows(unittest.TestCase):
    def test_of_the_plan_are_allowed(self):
        found = small({"core": [], "algebra": ["core"], "sim": ["algebra", "core"], "tests": ["sim"]})
        self.assertEqual(house.forbidden_arrows(found), [])

    def test_beside_the_plan_are_forbidden(self):
        found = small({"broker": [], "algebra": ["broker"]})
        self.assertEqual(house.forbidden_arrows(found), ["maths -> broker  (rths_algebra)"])

    def test_to_a_folder_do_not_serve_the_folders_in_it(self):
        found = small({"broker": [], "adapters": ["broker"], "adapters/a": ["adapters"], "adapters/b": ["adapters/a"]})
        self.assertEqual(house.forbidden_arrows(found), ["adapters/b -> adapters/a  (rths_adapters_b)"])

    def test_of_includes_without_a_link_count(self):
        found = small({"broker": [], "algebra": []}, [("broker/include/rths/node.hpp", ""), ("algebra/src/a.cpp", "#include <rths/node.hpp>\n")])
        self.assertEqual(house.forbidden_arrows(found), ["maths -> broker  (algebra/src/a.cpp)"])

    def test_are_wrong_at_any_distance(self):
        found = small({"broker": [], "algebra": ["broker"], "sim": ["algebra"]})
        self.assertEqual(house.arrows_at_a_distance(found), ["rths_sim reaches rths_broker"])

    def test_need_a_place_in_the_plan(self):
        self.assertEqual(house.folders_without_place(small({"sim": [], "cellar": []})), ["cellar"])


class Includes(unittest.TestCase):
    def test_of_sources_of_another_folder_are_private(self):
        found = small({"broker": [], "sim": ["broker"]}, [
            ("broker/src/layout.hpp", ""), ("broker/include/ring.hpp", ""), ("broker/src/ring.cpp", '#include "layout.hpp"'),
            ("sim/src/a.cpp", '#include "layout.hpp"\n#include <ring.hpp>\n#include <vector>\n')])
        self.assertEqual(house.private_includes(found), ["sim/src/a.cpp includes broker/src/layout.hpp"])

    def test_prefer_headers_of_their_own_folder(self):
        found = small({"broker": [], "sim": []}, [("broker/src/a.hpp", ""), ("sim/src/a.hpp", ""), ("sim/src/terms/b.cpp", '#include "a.hpp"')])
        self.assertEqual(house.private_includes(found), [])


class Figures(unittest.TestCase):
    def test_of_names_have_two_places(self):
        found = small({"sim": []}, [("sim/src/a.cpp", "namespace { struct Line {}; }"), ("sim/src/b.cpp", "struct Line {};\nstruct Row {};"),
                                    ("tests/c.cpp", "struct Row {};")])
        self.assertEqual(house.names_with_two_meanings(found), ["Line: sim/src/a.cpp:1, sim/src/b.cpp:1"])

    def test_of_size_name_file_and_function(self):
        found = small({"sim": []}, [("sim/src/a.cpp", "void f() {\n" + "\n" * 61 + "}\n" + "\n" * 400)])
        self.assertEqual(house.long_functions(found), ["sim/src/a.cpp:1: f, 62"])
        self.assertEqual(house.long_files(found, True), ["sim/src/a.cpp: 463"])

    def test_by_patterns_read_no_comments(self):
        found = small({"sim": []}, [("sim/src/a.cpp", "// Eigen::FFT\nint f() { return nth_element(1); }\nint mean() { return 2; }\n"),
                                    ("tests/a.cpp", "int mean() { return 2; }\n")])
        count = lambda where, pattern, **more: list(house.counted(found, {"in": where, "patterns": [pattern], **more}))
        self.assertEqual(count("files", "Eigen::FFT"), [])
        self.assertEqual(count("functions", "nth_element"), ["sim/src/a.cpp:2: f"])
        self.assertEqual(count("names", "^mean$", also=["tests"]), ["sim/src/a.cpp:3: mean", "tests/a.cpp:1: mean"])
        self.assertEqual(count("lines", "nth_element", **{"except": "^sim/"}), [])

    def test_lower_their_limits_and_never_raise_them(self):
        text = '"a b" = {limit = 5, goal = 0}\n"c" = {limit = 1, goal = 0}\n'
        self.assertEqual(house.tightened(text, {"a b": ["x"] * 3, "c": ["x"] * 3}), '"a b" = {limit = 3, goal = 0}\n"c" = {limit = 1, goal = 0}\n')


class Picture(unittest.TestCase):
    graph = {"folders": [{"name": name, "parts": parts, "layer": layer} for name, parts, layer in (
        ("app", [], 3), ("adapters", ["one", "two"], 2), ("broker", [], 1), ("sim", [], 1), ("core", [], 0))],
        "arrows": [{"from": user, "to": used, "forbidden": user == "sim"} for user, used in (
            ("app", "core"), ("app", "adapters"), ("adapters", "broker"), ("adapters", "sim"), ("broker", "core"), ("sim", "core"))]}

    def test_has_every_folder_and_arrow(self):
        drawn = picture.draw(self.graph)
        for name in ("app", "adapters", "one, two", "broker", "sim", "core"):
            self.assertIn(f">{name}</text>", drawn)
        self.assertEqual(drawn.count("url(#head)"), 5)
        self.assertEqual(drawn.count("url(#wrong)"), 1)

    def test_has_no_overlap(self):
        boxes = {folder["name"]: picture.box_of(folder) for folder in self.graph["folders"]}
        layers = picture.order(picture.in_layers(boxes, picture.paths_of(boxes, self.graph["arrows"])))
        picture.place(layers)
        for layer in layers:
            for left, right in zip(layer, layer[1:]):
                self.assertGreaterEqual(right.x - left.x, (left.width + right.width) / 2 + picture.GAP - 1e-6)

    def test_is_the_same_twice(self):
        self.assertEqual(picture.draw(self.graph), picture.draw(self.graph))

    def test_leaves_out_arrows_that_others_imply(self):
        found = small({"core": [], "algebra": ["core"], "sim": ["algebra", "core"]})
        self.assertEqual([(arrow["from"], arrow["to"]) for arrow in picture.graph_of(found)["arrows"]], [("algebra", "core"), ("sim", "algebra")])

    def test_has_a_box_for_a_target_with_a_place_of_its_own(self):
        found = small({"adapters": [], "app": [], "sim": []})
        found.targets["rths_all"] = tree.Target("rths_all", "STATIC_LIBRARY", "app", ["rths_adapters"])
        found.targets["rths_sim"].names = ["rths_all"]
        found.targets["rths_app"].names = ["rths_sim"]
        self.assertEqual([(arrow["from"], arrow["to"]) for arrow in picture.graph_of(found)["arrows"]],
                         [("app", "sim"), ("sim", "the table"), ("the table", "adapters")])

    def test_of_a_circle_is_refused(self):
        with self.assertRaisesRegex(SystemExit, "sim -> algebra -> sim|algebra -> sim -> algebra"):
            picture.graph_of(small({"algebra": ["sim"], "sim": ["algebra"]}))


if __name__ == "__main__":
    sys.exit(unittest.main())
