#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`pip install ./python` in new environments, from PyPI: each Python of this host, with an old and a new NumPy.

    clean_installs.py PREFIX FOLDER

PREFIX has an installation of rths; FOLDER gets the environments. Prints a line for each. An installation must take less
than a minute of one processor, and every function must give the same results in all environments. Standard library only.
"""
import os
import pathlib
import resource
import subprocess
import sys

TREE = pathlib.Path(__file__).resolve().parents[2]
# NumPy 1.26 has no wheel for Python 3.13.
NUMPYS = {"3.11": ("1.26.4", "2.3.5"), "3.12": ("1.26.4", "2.3.5"), "3.13": ("2.1.3", "2.3.5")}
OTHERS = ["pandas", "xarray", "pytest"]
MOST_S = 60


def run(arguments, **variables):
    result = subprocess.run([str(word) for word in arguments], capture_output=True, text=True, timeout=900,
                            env={**os.environ, **variables})
    if result.returncode != 0:
        sys.exit(f"{' '.join(map(str, arguments))}\n{result.stdout}{result.stderr}")
    return result.stdout


def processor_seconds():
    """Of all ended children: the wall time on an idle host, because an installation runs one job."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def interpreter(version):
    """The Python of this version of the system, of pyenv or of uv, if there is one."""
    home = pathlib.Path.home()
    for name in (f"/usr/bin/python{version}", f"python{version}", *home.glob(f".pyenv/versions/{version}.*/bin/python"),
                 *home.glob(f".local/share/uv/python/cpython-{version}.*/bin/python{version}")):
        try:
            if subprocess.run([name, "-c", "import ensurepip"], capture_output=True, timeout=60).returncode == 0:
                return name
        except OSError:
            pass
    return None


def results(python, numpy, folder, prefix):
    """Text of every function's results in a new environment."""
    run([python, "-m", "venv", folder])
    pip = [folder / "bin/pip", "install", "--quiet", "--disable-pip-version-check"]
    run([*pip, f"numpy=={numpy}", *OTHERS])
    begun = processor_seconds()
    run([*pip, TREE / "python"], CMAKE_PREFIX_PATH=str(prefix))
    seconds = processor_seconds() - begun
    print(f"{folder.name}: installed in {seconds:.0f} s of one processor", flush=True)
    if seconds > MOST_S:
        sys.exit(f"{folder.name}: expected at most {MOST_S} s")
    (folder / "files").mkdir()
    return run([folder / "bin/python", TREE / "tests/python/every_function.py", folder / "files"], PYTHONPATH="",
               RTHS_LONG="1", RTHS_COMMAND=str(prefix / "bin/rths")).replace(str(folder), "FOLDER")


def main(prefix, folder):
    found = {}
    for version, numpys in NUMPYS.items():
        python = interpreter(version)
        if python is None:
            print(f"SKIPPED: this host has no Python {version}, expected that of the system, of pyenv or of uv")
        for numpy in numpys if python else ():
            name = f"python-{version}-numpy-{numpy}"
            found[name] = results(python, numpy, folder / name, prefix)
    first, *others = found
    for name in others:
        if found[name] != found[first]:
            lines = zip(found[first].splitlines(), found[name].splitlines())
            sys.exit(f"{name} differs from {first}: " + next((f"{a[:200]} | {b[:200]}" for a, b in lines if a != b), "length"))
    print(f"{len(found)} environments give the same {len(found[first].splitlines())} results")


main(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:3]))
