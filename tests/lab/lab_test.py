#!/usr/bin/env python3
"""The functions of ./lab and its modules, and the target that `./lab build` builds for the installation.

    lab_test.py BUILD_FOLDER
"""
import contextlib
import io
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import checks
import main
import progress
import results
import runner
from session import Session

BUILD = pathlib.Path()  # of the command line
TOP = checks.TOP

CTEST = """<testsuite><testcase name="A.B" time="0.5" status="run"><system-out/></testcase>
<testcase name="A &lt;C&gt;" time="2" status="fail"><failure message=""/><system-out>wrong</system-out></testcase>
<testcase name="D.E" status="notrun"><skipped message="SKIP_REGULAR_EXPRESSION_MATCHED"/><system-out>a.cpp:1: Skipped
SKIPPED: no Chromium here
</system-out></testcase>
<testcase name="F.G" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>
<testcase name="H.I" status="notrun"><skipped message="Unable to find executable"/></testcase></testsuite>"""

GTEST = """<testsuites><testsuite name="S">
<testcase name="Passes" status="run" result="completed" time="0.25" classname="S"/>
<testcase name="Fails/0" status="run" result="completed" time="0" classname="All/S"><failure message="a.cpp:2&#x0A;Expected: 1"/></testcase>
<testcase name="Skips" status="run" result="skipped" time="0" classname="S"><skipped message="a.cpp:3&#x0A;SKIPPED: no network&#x0A;"/></testcase>
<testcase name="Other" status="notrun" result="suppressed" time="0" classname="S"/></testsuite></testsuites>"""

# A program of GoogleTest in shell: it passes, fails or dies as the names of its tests say.
PROGRAM = """#!/bin/sh
for argument; do case $argument in
  --gtest_filter=*) names=${argument#*=} ;;
  --gtest_flagfile=*) names=$(sed 's/--gtest_filter=//' "${argument#*=}") ;;
  --gtest_output=xml:*) output=${argument#*:} ;;
esac; done
echo "$names" >>"$(dirname "$0")/calls"
case $names in *Dies*) exit 3 ;; esac
status=0
{ echo '<testsuites>'
  for name in $(echo "$names" | tr : ' '); do
    case $name in *Fails*) failure='<failure message="no"/>' status=1 ;; *) failure= ;; esac
    echo "<testcase classname='${name%.*}' name='${name##*.}' result='completed' time='0'>$failure</testcase>"
  done
  echo '</testsuites>'; } >"${output-/dev/null}"
exit $status
"""


@contextlib.contextmanager
def quiet():
    """What is said, on both outputs."""
    with contextlib.redirect_stderr(io.StringIO()) as said, contextlib.redirect_stdout(said):
        yield said


class Folder(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def write(self, name, text, mode=0o644):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        path.chmod(mode)
        return path


class Results(Folder):
    def test_of_ctest_have_verdicts_and_reasons(self):
        found = results.of_ctest(self.write("results.xml", CTEST))
        self.assertEqual([(result.name, result.verdict) for result in found],
                         [("A.B", "passed"), ("A <C>", "failed"), ("D.E", "skipped"), ("F.G", "skipped"), ("H.I", "failed")])
        self.assertEqual((found[1].output, found[2].reason, found[1].seconds), ("wrong", "no Chromium here", 2.0))

    def test_of_a_program_have_the_names_of_its_filter(self):
        found = results.of_gtest(self.write("results.xml", GTEST))
        self.assertEqual([(result.name, result.verdict) for result in found],
                         [("S.Passes", "passed"), ("All/S.Fails/0", "failed"), ("S.Skips", "skipped")])
        self.assertEqual(found[2].reason, "no network")

    def test_of_a_program_that_died_are_none(self):
        self.assertEqual(results.of_gtest(self.folder / "absent.xml"), [])
        self.assertEqual(results.of_gtest(self.write("results.xml", "<testsuites><test")), [])

    def test_count_reasons(self):
        skipped = [results.Result(name, "skipped", reason="no network") for name in "ab"]
        self.assertEqual(results.reasons([*skipped, results.Result("c", "passed")]), "2 no network")


class ProgressLine(Folder):
    def test_has_the_newest_step_of_ninja_and_of_ctest(self):
        self.assertEqual(progress.newest_step("[1/9] x\n[7/9] y\n"), "7 of 9")
        self.assertEqual(progress.newest_step("  12/345 Test  #3: A.B ... Passed\n"), "12 of 345")
        self.assertEqual(progress.newest_step("configuring\n"), "started")

    def test_is_written_at_its_times(self):
        with quiet() as said:
            progress.watched("building", ["sh", "-c", "echo '[7/9] y'; sleep 0.6"], self.folder / "log", period=0.2)
        self.assertIn("building: 7 of 9, ", said.getvalue())

    def test_keeps_the_status_of_the_command(self):
        self.assertEqual(progress.watched("ends", ["sh", "-c", "exit 3"], self.folder / "log"), 3)


class SmallTests(Folder):
    def setUp(self):
        super().setUp()
        self.program = self.write("program", PROGRAM, 0o755)

    def make(self, name, number=1, labels=("unit",), **more):
        return runner.Test(number, name, [str(self.program), f"--gtest_filter={name}", "--gtest_also_run_disabled_tests"], set(labels), **more)

    def calls(self):
        return (self.folder / "calls").read_text().splitlines()

    def test_are_those_of_units_that_need_nothing(self):
        self.assertTrue(self.make("A.B").is_small)
        for other in (self.make("A.B", labels=["system"]), self.make("A.B", labels=["unit", "long"]), self.make("A.B", labels=["unit", runner.ALONE]),
                      self.make("A.B", has_more=True), runner.Test(1, "script", ["python3", "x.py"], {"unit"}), self.make("-A.*")):
            self.assertFalse(other.is_small)

    def test_of_a_program_run_in_one_process(self):
        found = runner.run_small([self.make("A.B", 1), self.make("A.Fails", 2), self.make("C.D", 3)], 2)
        self.assertEqual([(result.name, result.verdict) for result in found], [("A.B", "passed"), ("A.Fails", "failed"), ("C.D", "passed")])
        self.assertEqual(self.calls(), ["A.B:A.Fails:C.D"])

    def test_are_in_several_processes_if_they_are_many(self):
        batches = runner.batches_of([self.make(f"A.B{number}", number) for number in range(5)], most=2)
        self.assertEqual(sorted(test.number for batch in batches for test in batch), [0, 1, 3, 4] if len(batches) == 2 else [0, 1, 2, 3])

    def test_of_a_program_that_dies_are_left_to_ctest(self):
        tests = [self.make("A.B", 1), self.make("A.Dies", 2)]
        self.write("CTestTestfile.cmake", "".join(f'add_test({test.name} {self.program} --gtest_filter={test.name})\n' for test in tests))
        found = runner.run(self.folder, tests, "tests", 2)
        self.assertEqual(sorted((result.name, result.verdict) for result in found), [("A.B", "passed"), ("A.Dies", "failed")])

    def test_have_processes_of_their_own_in_a_long_run(self):
        tests = [self.make("A.B", 1), self.make("A.C", 2)]
        self.write("CTestTestfile.cmake", "".join(f'add_test({test.name} {self.program} --gtest_filter={test.name})\n' for test in tests))
        self.assertEqual(len(runner.run(self.folder, tests, "tests", 1, is_long=True)), 2)
        self.assertEqual(sorted(self.calls()), ["A.B", "A.C"])

    def test_keep_the_name_that_ctest_gives_them(self):
        tests = [self.make("A.B/0", 1), self.make("A.C/1", 2)]
        tests[0].name = "A.B/first"
        self.assertEqual([result.name for result in runner.run_small(tests, 1)], ["A.B/first", "A.C/1"])


class Suites(Folder):
    """Of tests of ctest: a steady one, one that fails the first time, one that always fails, and one of a unit."""

    def suite(self, *names):
        self.write("CTestTestfile.cmake", f"""
add_test(Good.Test true)
add_test(Busy.Test/0 sh -c "test -f {self.folder}/seen || {{ touch {self.folder}/seen; exit 1; }}")
add_test(Bad.Test false)
add_test(Plain.Test false)
set_tests_properties(Good.Test Busy.Test/0 Bad.Test PROPERTIES LABELS realtime)
set_tests_properties(Plain.Test PROPERTIES LABELS unit)
""")
        session = Session(jobs=2)
        with quiet() as said:
            session.suite(self.folder, [test for test in runner.tests_of(self.folder) if test.name in names], "tests")
            first = session.passed, session.failed
            session.repeat_alone()
        return first, (session.passed, session.failed), said.getvalue()

    def test_repeat_a_test_in_real_time_that_failed(self):
        first, then, said = self.suite("Good.Test", "Busy.Test/0")
        self.assertEqual((first, then), ((1, 0), (2, 0)))
        self.assertIn(f"lab: REPEATED  {self.folder.name} Busy.Test/0: failed beside other work, passed alone", said)

    def test_do_not_repeat_others_and_fail_at_the_second_failure(self):
        first, then, _ = self.suite("Good.Test", "Bad.Test", "Plain.Test")
        self.assertEqual((first, then), ((1, 1), (1, 2)))

    def test_refuse_many_repetitions(self):
        session = Session(jobs=1, again=[(self.folder, runner.Test(number, str(number), [])) for number in range(6)])
        with quiet():
            session.repeat_alone()
        self.assertEqual((session.passed, session.failed), (0, 6))

    def test_in_real_time_run_after_the_others(self):
        tests = [runner.Test(1, "A", [], {"realtime"}), runner.Test(2, "B", [], {"system"}), runner.Test(3, "C", [], {"physics"})]
        self.assertEqual([([test.number for test in group], count) for group, count in runner.in_groups(tests, 2)], [([2, 3], 3), ([1], 4)])
        self.assertEqual(runner.in_groups([], 2), [])

    def test_without_ctest_have_failed(self):
        session = Session(jobs=1)
        with quiet():
            session.suite(self.folder, [runner.Test(1, "A", ["absent"])], "tests")
        self.assertEqual((session.passed, session.failed), (0, 1))

    def test_that_ctest_leaves_out_have_failed(self):
        self.write("CTestTestfile.cmake", "add_test(A true)\n")
        found = runner.run(self.folder, [runner.Test(1, "A", ["true"]), runner.Test(2, "B", ["true"])], "tests", 1)
        self.assertEqual([(result.name, result.verdict) for result in found], [("A", "passed"), ("B", "failed")])


class Stages(Folder):
    def test_that_have_passed_are_not_repeated_and_are_counted(self):
        with quiet():
            first = Session(jobs=1, resumed=self.folder)
            first.stage("one check", lambda: True)
            first.stage("another", lambda: False)
            first.remember("tests of 'release', unit", 40)
            then = Session(jobs=1, resumed=self.folder)
            then.stage("one check", lambda: False)
            then.stage("another", lambda: True)
            then.suite(self.folder, [], "tests of 'release', unit")
        self.assertEqual((then.passed, then.failed), (42, 0))

    def test_that_build_are_repeated(self):
        session = Session(jobs=1, resumed=self.folder)
        with quiet():
            session.stage("a build", lambda: True, is_recalled=False)
            session.stage("a build", lambda: False, is_recalled=False)
        self.assertEqual((session.passed, session.failed), (1, 1))

    def test_are_all_repeated_without_a_folder(self):
        session = Session(jobs=1)
        session.remember("one check")
        self.assertFalse(session.has_passed("one check"))

    def test_end_with_the_count(self):
        with quiet() as said:
            self.assertEqual(Session(jobs=1, passed=3, failed=1).end(), 1)
        self.assertEqual(said.getvalue(), "3 passed, 1 failed\n")


ROW = '{"name": "tcp", "bare": {"p50_ns": 5.0}, "ring": {"p50_ns": 2.0}}'


class Checks(Folder):
    def test_measured_rows(self):
        self.assertTrue(checks.is_measured(f'{{"trips": [{ROW}]}}', ["trips"]))
        self.assertTrue(checks.is_measured('{"rows": [{"name": "word", "missing": "was not measured: one processor"}]}', ["rows"]))
        for result in ("", "{}", '{"trips": []}', f'{{"trips": [{ROW}, {{"name": "udp"}}]}}', f'{{"trips": [{ROW.replace("2.0", "null")}]}}',
                       '{"trips": [{"name": "udp", "missing": "iceoryx is not installed"}]}', f'{{"trips": [{ROW}]}} rths: an error'):
            self.assertFalse(checks.is_measured(result, ["trips"]), result)

    def bench(self, status, result):
        program = self.write("rths", f"#!/bin/sh\n[ \"$2\" != opensees ] || {{ echo '{result}'; exit {status}; }}\n"
                             f"echo '{{\"rows\": [{ROW}], \"peers\": [{ROW}], \"bearings\": [{ROW}]}}'\n", 0o755)
        with quiet() as said:
            return checks.benchmarks_run(bench=[str(program), "bench"]), said.getvalue()

    def test_a_missed_gate_with_measured_rows_passes(self):
        self.assertEqual(self.bench(2, f'{{"trips": [{ROW}]}}'), (True, ""))

    def test_an_error_of_a_benchmark_is_shown(self):
        has_passed, said = self.bench(2, "no peer")
        self.assertFalse(has_passed)
        self.assertIn("exit status 2\nno peer", said)

    def test_the_hash_of_a_tree_is_the_same_twice(self):
        self.assertEqual(checks.tree_hash(), checks.tree_hash())


class Packages(Folder):
    def lab(self, text):
        """Runs functions of ./lab with programs that install nothing, none of which is installed."""
        self.write("bin/dpkg-query", "#!/bin/sh\nexit 1\n", 0o755)
        self.write("bin/sudo", "#!/bin/sh\nexec \"$@\"\n", 0o755)
        self.write("bin/apt-get", f"#!/bin/sh\necho \"$1\" >>{self.folder}/calls\ncase \"$*\" in *absent*) echo no such package; exit 100 ;; esac\n", 0o755)
        return subprocess.run(["bash", "-c", f"source {TOP}/lab; PATH={self.folder}/bin:$PATH; {text}"], capture_output=True, text=True, check=False)

    def test_lists_are_read_once(self):
        self.lab("need first && need second third")
        self.assertEqual((self.folder / "calls").read_text().split(), ["update", "install", "install"])

    def test_that_fail_say_why(self):
        done = self.lab("need absent")
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "no such package")
        self.assertRegex(done.stderr, "failed; the lines above")

    def test_have_groups(self):
        self.assertIn("there is no group 'all'", self.lab("packages all").stderr)
        self.assertEqual(self.lab("packages sanitizers").returncode, 0)


class Tree(unittest.TestCase):
    """The project itself and its build."""

    def test_the_parts_of_all_tests_leave_none_out(self):
        tests = runner.tests_of(BUILD)
        parts = main.parts_of(tests, True)
        self.assertEqual(sorted(test.number for _, part in parts for test in part), [test.number for test in tests if "fixture" not in test.labels])
        self.assertEqual(len({name for name, _ in parts}), len(parts))
        short = main.parts_of(tests, False)[0][1]
        self.assertFalse([test.name for test in short if "long" in test.labels])
        self.assertGreater(len([test for test in short if test.is_small]), 1000)

    def test_every_folder_with_tests_is_in_the_list(self):
        lines = (BUILD / "tests.txt").read_text().splitlines()
        listed = {line.split()[0] for line in lines}
        folders = {name.split("/")[1] for name in checks.project_files("tests/*_test.cpp")} - {"support", "benchmarks"}
        self.assertEqual(folders - listed, set())
        for line in ("launch rths_command_test", "replicated rths_replicated_test", "scramnet rths_replicated_test", "lab rths_lab_test",
                     "style rths_figures_test", "style rths_prose_test", "style rths_options_test", "replicated rths_behaviours_test",
                     "models rths_Model_test"):
            self.assertEqual(lines.count(line), 1, line)
        self.assertNotIn("support", listed)

    def test_a_target_has_the_tests_of_its_program_or_suite(self):
        tests = [runner.Test(1, "A.B", ["/bin/rths_core_test", "--gtest_filter=A.B"], {"unit"}), runner.Test(2, "prose.Limits", ["python3", "prose.py"], {"unit"}),
                 runner.Test(3, "C.D", ["/bin/rths_sim_test"], {"unit"}), runner.Test(4, "E.F", ["/bin/rths_core_test"], {"unit", "long"})]
        self.assertEqual([test.number for test in main.tests_of_targets(tests, ["rths_core_test", "rths_prose_test"])], [1, 2])

    def test_help_needs_no_build(self):
        said = subprocess.run([TOP / "lab", "test", "--help"], capture_output=True, text=True, check=True).stdout
        self.assertTrue(said.startswith("The one script of this project"))

    def test_wrong_options_are_named(self):
        with quiet() as said, self.assertRaises(SystemExit):
            main.options_of(["absent"])
        self.assertIn("tests/absent is no folder; there are: ", said.getvalue())

    def test_the_demo_is_an_experiment_with_either_solver(self):
        settings = {name: "".join(part.strip("'") for part in parts) for name, parts in self._settings_of_demo().items()}
        changes = ["--set", f"node.opf={settings['opensees_node']}", "--set", f"solver={settings['opensees_solver']}"]
        for with_opensees in ([], changes):
            said = subprocess.run([BUILD / "bin/rths", "check", TOP / settings["demo_experiment"], *with_opensees],
                                  capture_output=True, text=True, check=False)
            self.assertEqual((said.returncode, said.stderr), (0, ""))

    @staticmethod
    def _settings_of_demo():
        found = {}
        for name, value in re.findall(r"^((?:demo|opensees)_(?:experiment|node|solver))\+?=('[^']*'|\S+)", (TOP / "lab").read_text(), re.MULTILINE):
            found.setdefault(name, []).append(value)
        return found

    def test_the_installation_is_built_by_its_target(self):
        """Every file that `cmake --install` copies from the build."""
        graph = subprocess.run(["ninja", "-C", BUILD, "-t", "graph", "rths_installed"], capture_output=True, text=True, check=True).stdout
        built = {name.removeprefix(f"{BUILD}/") for name in re.findall(r'label="([^"]*)"', graph)}
        scripts = [BUILD / "cmake_install.cmake"]
        for path in scripts:  # grows by the scripts that each includes
            scripts += [BUILD / name for name in re.findall(rf'include\("{re.escape(str(BUILD))}/([^"]*)"\)', path.read_text()) if not name.startswith("tests/")]
        pattern = re.compile(rf'"({re.escape(str(BUILD))}/(?:[^"]*\.(?:so|a|so\.[0-9.]*|1)|bin/[^"]*))"')
        copied = {name.removeprefix(f"{BUILD}/") for path in scripts for name in pattern.findall(path.read_text())}
        self.assertGreaterEqual(len(copied), 10)
        plain = {re.sub(r"\.so\.[0-9.]*$", ".so", name) for name in built}
        self.assertEqual({re.sub(r"\.so\.[0-9.]*$", ".so", name) for name in copied} - plain, set())


if __name__ == "__main__":
    BUILD = pathlib.Path(sys.argv.pop(1)).resolve()
    sys.exit(unittest.main())
