"""One run of `./lab test`: its stages, its counts, and what it has to say at the end."""
import pathlib
import sys
import time
from dataclasses import dataclass, field

import results
import runner
from progress import say

# A test in real time or of several processes can fail because the host is busy. It is repeated once, alone, after all
# others.
REPEATED = {"realtime", "system"}
MOST_REPEATED = 5


@dataclass
class Session:
    jobs: int
    resumed: pathlib.Path = None  # a folder with a file for each stage that has passed on this very tree
    passed: int = 0
    failed: int = 0
    skipped: list = field(default_factory=list)
    times: list = field(default_factory=list)
    slowest: list = field(default_factory=list)
    again: list = field(default_factory=list)  # (build, test)

    def has_passed(self, name):
        """An interrupted run with --full continues with the first stage that has not passed."""
        return self.resumed is not None and (self.resumed / name.replace("/", "_")).exists()

    def remember(self, name, count=1):
        if self.resumed is not None:
            (self.resumed / name.replace("/", "_")).write_text(f"{count}\n")

    def recall(self, name):
        self.passed += int((self.resumed / name.replace("/", "_")).read_text())
        say(f"passed  {name}, in an interrupted run of the same tree")

    def note_time(self, begun, name):
        self.times.append(f"{time.monotonic() - begun:5.0f} s  {name}")

    def stage(self, name, check, is_recalled=True):
        """One check, passed or failed, and how long it took. A build is never recalled: ninja repeats nothing, and a run in
        between may have configured it differently."""
        if is_recalled and self.has_passed(name):
            self.recall(name)
            return True
        begun = time.monotonic()
        has_passed = bool(check())
        self.passed += has_passed
        self.failed += not has_passed
        if has_passed and is_recalled:
            self.remember(name)
        self.note_time(begun, name)
        say(f"{'passed' if has_passed else 'FAILED'}  {name} ({time.monotonic() - begun:.0f} s)")
        return has_passed

    def fail(self, text):
        self.failed += 1
        say(f"FAILED  {text}")

    def suite(self, build, tests, name):
        """Tests of a build, counted one by one."""
        if self.has_passed(name):
            self.recall(name)
            return
        begun = time.monotonic()
        found = runner.run(build, tests, name, self.jobs, is_long=self.resumed is not None)
        self.note_time(begun, name)
        if found is None:
            self.failed += 1
            return
        self.count(found, build, tests, name)
        say(f"{name}: {time.monotonic() - begun:.0f} s")

    def count(self, found, build, tests, name):
        by_name = {test.name: test for test in tests}
        failed = [result for result in found if result.verdict == "failed"]
        idle = [result for result in found if result.verdict == "skipped"]
        repeated = [result for result in failed if result.name in by_name and by_name[result.name].labels & REPEATED]
        for result in failed:
            print(f"--- {result.name}\n{result.output}", file=sys.stderr, flush=True)
        self.again += [(build, by_name[result.name]) for result in repeated]
        passed = len(found) - len(failed) - len(idle)
        self.passed += passed
        self.failed += len(failed) - len(repeated)
        if idle:
            self.skipped.append(f"{name}: {results.reasons(idle)}")
        if not failed:
            self.remember(name, passed)
        self.slowest += [(result.seconds, f"{pathlib.Path(build).name} {result.name}") for result in found]
        say(f"{name}: {passed} passed, {len(failed) - len(repeated)} failed, {len(repeated)} to be repeated, {len(idle)} skipped")

    def repeat_alone(self):
        """The failed tests in real time or of several processes, one after another. More than five are no accident."""
        if len(self.again) > MOST_REPEATED:
            for build, test in self.again:
                self.fail(f"{pathlib.Path(build).name} {test.name}")
            say(f"FAILED  {len(self.again)} tests needed a repetition, expected at most {MOST_REPEATED}")
            return
        for build, test in self.again:
            name = f"{pathlib.Path(build).name} {test.name}"
            found = runner.run_ctest(build, [test], name, 1) or []
            verdicts = [result.verdict for result in found if result.name == test.name]
            if verdicts == ["passed"]:
                self.passed += 1
                say(f"REPEATED  {name}: failed beside other work, passed alone")
            else:
                self.fail(f"{name}: twice")
                print("\n".join(result.output for result in found), file=sys.stderr, flush=True)

    def print_slowest(self, most):
        for seconds, name in sorted(self.slowest, reverse=True)[:most]:
            say(f"  {seconds:.1f} {name}")

    def end(self):
        """The last line counts; the exit status is 0 if no test failed."""
        print(f"{self.passed} passed, {self.failed} failed", flush=True)
        return 0 if self.failed == 0 else 1
