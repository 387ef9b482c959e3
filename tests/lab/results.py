"""Results of tests, from the files of ctest and of GoogleTest."""
import re
import xml.etree.ElementTree
from collections import Counter
from dataclasses import dataclass

REASON = re.compile(r"SKIPPED: ([^\n]*)")


@dataclass
class Result:
    name: str
    verdict: str  # passed, failed or skipped
    seconds: float = 0.0
    reason: str = ""  # why it was skipped
    output: str = ""


def reason_in(text):
    found = REASON.search(text or "")
    return found.group(1).strip() if found else ""


def of_ctest(path):
    """Results in the file of `ctest --output-junit`. A test that did not run has failed, unless it skipped itself."""
    results = []
    for case in xml.etree.ElementTree.parse(path).getroot().iter("testcase"):
        output = case.findtext("system-out") or ""
        skipped = case.find("skipped")
        verdict = "passed" if case.get("status") == "run" else "failed"
        if skipped is not None and (skipped.get("message") or "").startswith("SKIP_"):
            verdict = "skipped"
        results.append(Result(case.get("name"), verdict, float(case.get("time") or 0), reason_in(output), output))
    return results


def of_gtest(path):
    """Results in the file of `--gtest_output=xml`, by the names of --gtest_filter; empty if the program ended before."""
    try:
        root = xml.etree.ElementTree.parse(path).getroot()
    except (OSError, xml.etree.ElementTree.ParseError):
        return []
    results = []
    for case in root.iter("testcase"):
        if case.get("result") not in ("completed", "skipped"):
            continue
        failures = [failure.get("message") or "" for failure in case.findall("failure")]
        skipped = case.find("skipped")
        verdict = "failed" if failures else "skipped" if skipped is not None else "passed"
        reason = reason_in((skipped.get("message") or "") + "\n" + (skipped.text or "")) if skipped is not None else ""
        results.append(Result(f"{case.get('classname')}.{case.get('name')}", verdict, float(case.get("time") or 0), reason, "\n".join(failures)))
    return results


def reasons(results):
    """How many tests skipped themselves, by reason."""
    found = Counter(result.reason for result in results if result.verdict == "skipped")
    return "; ".join(f"{count} {reason}".strip() for reason, count in sorted(found.items()))
