# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The package is found where it is installed: by `cmake --install` in the Python of the prefix, by `pip install .` in
an environment of its own.

usage: install_test.py SOURCE BUILD CMAKE WORK
"""

import os
import pathlib
import shutil
import subprocess
import sys
import unittest

SOURCE, BUILD, CMAKE, WORK = (pathlib.Path(path) for path in sys.argv[1:5])
SAY = "import pliant; print(pliant.__file__); print(pliant.options('track')['General.seed'])"


def environment(name):
    """A fresh environment that sees the packages of the system; its Python."""
    folder = WORK / name
    shutil.rmtree(folder, ignore_errors=True)
    subprocess.run([sys.executable, "-m", "venv", "--system-site-packages", folder], check=True)
    return folder / "bin" / "python"


def output_of(*command):
    """Without the package of the build tree on the path."""
    without = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    done = subprocess.run(command, env={**without, "PLIANT_BUILD_DIR": str(BUILD)}, cwd=WORK, text=True,
                          capture_output=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{command} failed:\n{done.stdout}\n{done.stderr}")
    return done.stdout.splitlines()


class Install(unittest.TestCase):
    def found_in(self, python):
        where, seed = output_of(python, "-c", SAY)
        self.assertTrue(where.startswith(str(python.parent.parent / "lib")), where)
        self.assertEqual(seed, "1")
        package = pathlib.Path(where).parent
        names = {path.name for path in package.iterdir()}
        self.assertLessEqual({"py.typed", "_pliant.pyi", "run.py"}, names)

    def test_cmake_installs_into_the_python_of_the_prefix(self):
        python = environment("prefix")
        output_of(CMAKE, "--install", BUILD, "--component", "python", "--prefix", python.parent.parent)
        self.found_in(python)

    def test_pip_installs_into_its_environment(self):
        python = environment("pip")
        before = sorted(path.name for path in SOURCE.iterdir())
        output_of(python, "-m", "pip", "install", "--no-build-isolation", "--no-index", "--no-deps", "--quiet", SOURCE)
        self.found_in(python)
        self.assertEqual(sorted(path.name for path in SOURCE.iterdir()), before)
        self.assertEqual([path.name for path in (SOURCE / "python").iterdir()], ["pliant"])


if __name__ == "__main__":
    WORK.mkdir(parents=True, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
