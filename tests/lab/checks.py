"""The stages of `./lab test` that are no tests of ctest. Each returns True if it has passed."""
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
RELEASE = TOP / "build/release"
BENCH = [str(RELEASE / "bin/rths"), "bench"]


def quietly(*command, **options):
    """Runs a command and prints its output only if it fails."""
    done = subprocess.run([str(part) for part in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", cwd=options.pop("cwd", TOP), check=False, **options)
    if done.returncode != 0:
        sys.stderr.write(done.stdout)
    return done.returncode == 0


def build(preset, *arguments):
    """Configures if needed, and builds."""
    return subprocess.run([TOP / "lab", "build-preset", preset, *arguments], cwd=TOP, check=False).returncode == 0


def project_files(*patterns):
    listing = subprocess.run(["git", "-c", f"safe.directory={TOP}", "ls-files", *patterns], cwd=TOP, capture_output=True, text=True, check=True)
    return listing.stdout.split()


def tree_hash():
    """A hash of all files of the project as they are."""
    git = lambda *arguments: subprocess.run(["git", "-c", f"safe.directory={TOP}", *arguments], cwd=TOP, capture_output=True, check=True).stdout
    found = hashlib.sha256(git("rev-parse", "HEAD") + git("diff", "HEAD"))
    for name in filter(None, git("ls-files", "-z", "--others", "--exclude-standard").split(b"\0")):
        found.update(name + (TOP / os.fsdecode(name)).read_bytes())
    return found.hexdigest()[:16]


def is_formatted():
    return quietly("clang-format-14", "--dry-run", "--Werror", *project_files("*.hpp", "*.cpp", "*.h", "*.c"))


def reference_seconds():
    """CPU seconds of the compiler for tests/reference.cpp: a slow host shows here."""
    before = os.times().children_user
    subprocess.run(["g++", "-std=c++20", "-O2", "-I/usr/include/eigen3", "-c", "tests/reference.cpp", "-o", os.devnull], cwd=TOP, check=False)
    return os.times().children_user - before


# --- the installed package ----------------------------------------------------------------------------

def serves_a_consumer(times):
    """A project outside this tree builds with the installed package, and its tests pass the given number of times."""
    prefix, consumer = TOP / "build/install", TOP / "build/consumer"
    for folder in (prefix, consumer):
        shutil.rmtree(folder, ignore_errors=True)
    rths = prefix / "bin/rths"
    ninja = ["-G", "Ninja", f"-DCMAKE_PREFIX_PATH={prefix}"]
    return (quietly("cmake", "--install", RELEASE, "--prefix", prefix)
            and quietly("cmake", "-S", "tests/consumer", "-B", consumer, "-DCMAKE_BUILD_TYPE=Release", *ninja)
            and quietly("ninja", "-C", consumer)
            and quietly(consumer / "consumer", prefix / "share/rths/maps/srmd.ringmap.toml")
            and quietly(rths, "check", prefix / "share/rths/examples/srmd_lprb_2d.toml")
            and quietly("/usr/bin/python3", "tests/consumer/testing_page.py", prefix, consumer / "page", "--times", times)
            and quietly(rths, "new", "adapter", "demo", cwd=consumer)
            and quietly("cmake", "-S", "demo", "-B", "demo/build", *ninja, cwd=consumer)
            and quietly("cmake", "--build", "demo/build", cwd=consumer)
            and quietly("ctest", "--test-dir", "demo/build", "--output-on-failure", cwd=consumer))


def serves_vendor_clients():
    """Programs written for the vendor's cards compile and link against the installed libraries."""
    return quietly("tests/scramnet/serves_vendor_clients", TOP / "build/install", TOP / "build/vendor_clients")


def installs_by_pip():
    """`pip install ./python` in new environments, for each Python of this host with an old and a new NumPy."""
    folder = TOP / "build/clean_installs"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return quietly("python3", "tests/python/clean_installs.py", TOP / "build/install", folder)


# --- sources ------------------------------------------------------------------------------------------

def configured(folder, *options):
    return quietly("cmake", "--preset", "asan", "-B", folder, "-DRTHS_TESTS=OFF", "-DRTHS_PYTHON=ON", "-DRTHS_BENCHMARKS=ON", *options) and quietly(
        "ninja", "-C", folder, "rths_dds_topic")


def sources_stand_alone():
    """The compiler's commands for every source of the product by itself, which finds missing includes. The batches of the
    other builds would hide them."""
    folder = TOP / "build/alone"
    if not configured(folder, "-DRTHS_UNITY=OFF"):
        return False
    listing = subprocess.run(["ninja", "-C", folder, "-t", "commands"], capture_output=True, text=True, check=True).stdout
    commands = re.findall(r"^(.*) -MD -MT .* -c (\S*/src/\S*\.cpp)$", listing, re.MULTILINE)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        checks = pool.map(lambda each: quietly("sh", "-c", f"{each[0]} -fsyntax-only {each[1]}", cwd=folder), commands)
        return bool(commands) and all(list(checks))


def tidy_stamp(unit, headers, folder):
    """The file that says that a source, or one that includes a batch of sources, has passed as it is."""
    text = pathlib.Path(unit).read_bytes()
    for name in re.findall(rb'^#include "(.*\.cpp)"$', text, re.MULTILINE):
        text += pathlib.Path(os.fsdecode(name)).read_bytes()
    return folder / "passed" / f"{hashlib.sha256(text).hexdigest()[:16]}-{headers}"


def is_tidy():
    """clang-tidy on every source of the product, all of a library at once: nine tenths of its time are headers of others.
    What has passed is checked again only if it, a header or the settings changed."""
    folder = TOP / "build/tidy"
    if not configured(folder, "-DRTHS_BATCH=0", "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON"):
        return False
    (folder / "passed").mkdir(exist_ok=True)
    headers = hashlib.sha256(b"".join((TOP / name).read_bytes() for name in project_files(".clang-tidy", "*.hpp", "*.h"))).hexdigest()[:16]
    units = {entry["file"] for entry in json.loads((folder / "compile_commands.json").read_text())}

    def check(unit):
        stamp = tidy_stamp(unit, headers, folder)
        if not stamp.exists():
            if not quietly("clang-tidy-19", "-p", folder, "--quiet", "--checks=-bugprone-suspicious-include",
                           "--extra-arg=-Wno-deprecated-declarations", unit):
                return False
            stamp.touch()
        return True

    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        return all(list(pool.map(check, sorted(unit for unit in units if re.search(r"/(Unity/.*\.cxx|src/.*\.cpp)$", unit)))))


# --- benchmarks and blind cases ------------------------------------------------------------------------

def medians(row):
    for key, value in row.items():
        if isinstance(value, dict):
            yield from medians(value)
        elif key == "p50_ns":
            yield value


def is_row_measured(row):
    """With one processor the ring is not measured, and its rows say so."""
    found = list(medians(row))
    return "was not measured" in row.get("missing", "") or (found != [] and all(median and median > 0 for median in found))


def is_measured(text, lists):
    """The result of a benchmark is JSON, and every row of these of its lists is measured."""
    try:
        result = json.loads(text)
        rows = [row for name in lists for row in result[name]]
    except (ValueError, KeyError, TypeError):
        return False
    return bool(rows) and all(map(is_row_measured, rows))


def measures(most, lists, *options, bench=None):
    """The benchmark ends with at most this exit status and every row measured. Status 2 is a missed gate and an error, but
    an error has no rows."""
    done = subprocess.run([*(bench or BENCH), *options, "--json"], capture_output=True, text=True, cwd=TOP, check=False)
    if 0 <= done.returncode <= most and is_measured(done.stdout, lists):
        return True
    print(f"rths bench {' '.join(options)}: exit status {done.returncode}\n{done.stdout}{done.stderr}", file=sys.stderr)
    return False


def benchmarks_run(bench=None):
    """Every row is measured; their values are not checked."""
    return (measures(1, ["rows", "peers"], "ring", "--cycles", "1", "--round-trips", "1000", bench=bench)
            and measures(1, ["bearings"], "bearings", "--passes", "1", "--steps", "2000", bench=bench)
            and measures(2, ["trips"], "opensees", "--cycles", "1", "--round-trips", "200", bench=bench))  # 2: other processes disturbed it


def benchmarks_build_and_run():
    return (build("release", "rths_bench", "rths_loop_bench", "rths_peers", "-DRTHS_BENCHMARKS=ON")
            and quietly(RELEASE / "bin/rths_loop_bench", "--benchmark_min_time=0.01") and benchmarks_run())


def finds_concealed_effects():
    """Blind cases of the diagnosis with a fixed seed."""
    done = subprocess.run([*BENCH, "diagnosis", "--no-peers", "--seed", "20", "--cases", "40", "--require", "0.6", "--out", "out/tests/trial-full"],
                          cwd=TOP, capture_output=True, text=True, check=False)
    if done.returncode not in (0, 1):
        sys.stderr.write(done.stdout + done.stderr)
    return done.returncode in (0, 1)
