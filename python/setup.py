# SPDX-License-Identifier: Apache-2.0
"""Builds the extension rths._rths with CMake, from the tree that this folder is in.

RTHS_BUILD names the folder of a build with RTHS_PYTHON=ON for the same interpreter, whose extension is taken as it is.
Without it, the extension is built in build/wheel.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

TREE = pathlib.Path(__file__).resolve().parent.parent
BUILD = TREE / "build" / "wheel"  # beside other builds, which share downloads with it
WORK = BUILD / "setuptools"


def version():
    """That of the project in CMakeLists.txt."""
    return re.search(r"project\(rths VERSION ([\d.]+)", (TREE / "CMakeLists.txt").read_text(encoding="utf-8"))[1]


def built():
    """Folder of the build that holds the extension."""
    if given := os.environ.get("RTHS_BUILD"):
        return pathlib.Path(given)
    subprocess.run(["cmake", "-S", TREE, "-B", BUILD, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DRTHS_TESTS=OFF",
                    "-DRTHS_UNITY=ON", "-DRTHS_PYTHON=ON", f"-DRTHS_PYTHON_EXECUTABLE={sys.executable}"], check=True)
    subprocess.run(["cmake", "--build", BUILD, "--target", "rths_python"], check=True)
    return BUILD


class CMakeBuild(build_ext):
    def build_extension(self, extension):
        target = pathlib.Path(self.get_ext_fullpath(extension.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(built() / "python" / "rths" / target.name, target)


WORK.mkdir(parents=True, exist_ok=True)
setup(version=version(), ext_modules=[Extension("rths._rths", sources=[])], cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": str(WORK)}, "egg_info": {"egg_base": str(WORK)}})
