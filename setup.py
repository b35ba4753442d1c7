# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""`pip install .`: the compiled module comes from CMake, with the libraries of third_party_configs/debian/packages.txt.

environment
  PLIANT_BUILD_DIR  a build folder that is there already, such as build/release, is brought up to date and used; else
                    build/pip
  CMAKE_ARGS        more arguments for the configuration of a new build folder, such as -DPLIANT_BUILD_VIEWER=OFF
"""

import os
import pathlib
import runpy
import shlex
import shutil
import subprocess
import sys
import sysconfig

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

SOURCE = pathlib.Path(__file__).resolve().parent
TARGET = "_pliant"


class CMakeBuild(build_ext):
    """Lets CMake build the module, and takes it from the build folder."""

    def build_extension(self, ext):
        build = SOURCE / os.environ.get("PLIANT_BUILD_DIR", "build/pip")
        if not (build / "CMakeCache.txt").exists():
            subprocess.run(["cmake", "-S", SOURCE, "-B", build, "-DCMAKE_BUILD_TYPE=Release", "-DPLIANT_PYTHON=ON",
                            "-DPLIANT_BUILD_TESTS=OFF", "-DPLIANT_BUILD_BENCHMARKS=OFF",
                            f"-DPython3_EXECUTABLE={sys.executable}",
                            *shlex.split(os.environ.get("CMAKE_ARGS", ""))], check=True)
        jobs = os.environ.get("PLIANT_JOBS", str(os.cpu_count() or 1))
        subprocess.run(["cmake", "--build", build, "--target", TARGET, "--parallel", jobs], check=True)
        module = build / "python" / "pliant" / (TARGET + sysconfig.get_config_var("EXT_SUFFIX"))
        if not module.exists():
            sys.exit(f"{build} holds no module for this Python ({sys.executable}); give another PLIANT_BUILD_DIR")
        target = pathlib.Path(self.get_ext_fullpath(ext.name))
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(module, target)


def version():
    return runpy.run_path(str(SOURCE / "third_party_configs" / "debian" / "version.py"))["package_version"]()


# What is built on the way stays out of the sources.
(SOURCE / "build").mkdir(exist_ok=True)
setup(version=version(), ext_modules=[Extension(f"pliant.{TARGET}", sources=[])], cmdclass={"build_ext": CMakeBuild},
      options={"egg_info": {"egg_base": "build"}, "build": {"build_base": "build/setuptools"}})
