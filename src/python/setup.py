# SPDX-License-Identifier: BSD-3-Clause
"""The compiled part is a target of CMake; the version is that of the library."""
import os
import re
import subprocess
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

ROOT = Path(__file__).resolve().parents[2]


def version() -> str:
    text = (ROOT / "include/rio/version.hpp").read_text()
    return ".".join(re.findall(r"#define RIO_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", text))


class CMakeBuild(build_ext):
    def build_extension(self, ext: Extension) -> None:
        build = Path(self.build_temp).absolute()
        subprocess.run(
            ["cmake", "-S", ROOT, "-B", build, f"-DPython3_EXECUTABLE={sys.executable}",
             "-DCMAKE_BUILD_TYPE=Release", "-DRIO_BUILD_PYTHON=ON",
             "-DRIO_BUILD_TESTS=OFF", "-DRIO_BUILD_LAB=OFF", "-DRIO_BUILD_EXAMPLES=OFF", "-DRIO_INSTALL=OFF"],
            check=True)
        jobs = os.environ.get("CMAKE_BUILD_PARALLEL_LEVEL", str(os.cpu_count()))
        subprocess.run(["cmake", "--build", build, "--target", "rio_python", "-j", jobs], check=True)
        (compiled,) = (build / "src/python/rio").glob("_rio.*.so")
        self.copy_file(compiled, self.get_ext_fullpath(ext.name))


BUILD = ROOT / "build/pip"  # nothing is left beside the sources
BUILD.mkdir(parents=True, exist_ok=True)
setup(version=version(), ext_modules=[Extension("rio._rio", [])], cmdclass={"build_ext": CMakeBuild},
      options={"build": {"build_base": str(BUILD)}, "egg_info": {"egg_base": str(BUILD)}})
