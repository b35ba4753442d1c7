# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The annotations of the package: mypy finds no error in them, and finds wrong arguments of a program that uses them;
the stub of the compiled module has its names. Skipped (exit code 77) without mypy.

usage: types_test.py ROOT
"""

import ast
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from pliant import _pliant

ROOT = pathlib.Path(sys.argv.pop())
SKIPPED = 77
RIGHT = """import numpy as np
import pliant
run = pliant.track("colon", "run", {"General.seed": 3}, end=40)
print(run.poses.world_from_cam.shape, pliant.evaluate(run, "colon")["surface"])
three = np.int64(3)
camera = pliant.Camera("PINHOLE", 640, np.int64(480), np.array([400, 400, 320, 240]), fps=np.float64(30))
images, tracks, seen = np.zeros((3, 480, 640), np.uint8), np.zeros((3, 9, 2)), np.ones((3, 9), bool)
pair = [tracks, seen]
pliant.track(images, "run", camera=camera, timestamps=np.arange(3) / 30.0, tracks=[tracks, seen])
pliant.track(images, "run", camera=camera, timestamps=[0, np.float64(0.1), 0.2], tracks=pair)
pliant.track("colon", "run", start=three, end=np.int32(9), stride=three, tracks=(tracks, seen.tolist()))
pliant.evaluate(None, "colon", tracks={"tracks": tracks, "visibility": seen})
pliant.evaluate(None, "colon", tracks=np.load("tracks.npz"))
pliant.convert_arrays("a.npz", "result", "droid", np.array([640, 480]), start=three, fps=np.float32(30), step_px=three)
pliant.surface(run, "surface", frames=np.array([20, 40]))
pliant.report(run, "still.png", figure=[three])
pliant.open_sequence("colon", end=three).depth(three)
print(run.frame(three), run.path(np.int64(7)))
pliant.Tracker(camera, examples=images).process(images[0], timestamp=np.float64(1))
"""
WRONG = RIGHT + 'pliant.track("colon", "run", stop=40)\nrun.pose\npliant.track("colon", "run", start="3")\n'


def names_of(body):
    """The public names that the statements of a stub define."""
    for statement in body:
        if isinstance(statement, (ast.ClassDef, ast.FunctionDef)):
            name = statement.name
        elif isinstance(statement, ast.AnnAssign):
            name = statement.target.id
        else:
            continue
        if not name.startswith("_"):
            yield name


class Types(unittest.TestCase):
    def mypy(self, *arguments):
        with tempfile.TemporaryDirectory() as cache:
            done = subprocess.run(
                [sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", cache, *arguments],
                cwd=ROOT, text=True, stdout=subprocess.PIPE, env={**os.environ, "MYPYPATH": str(ROOT / "python")},
                check=False)
        return done.returncode, done.stdout

    def test_the_package_has_no_error(self):
        code, said = self.mypy()
        self.assertEqual(code, 0, said)

    def test_a_program_is_checked_by_them(self):
        with tempfile.TemporaryDirectory() as folder:
            for name, program, wrong in (("right.py", RIGHT, []), ("wrong.py", WRONG, [len(RIGHT.splitlines()) + i for i in (1, 2, 3)])):
                file = pathlib.Path(folder) / name
                file.write_text(program)
                _, said = self.mypy(file)
                self.assertEqual([int(line.split(":")[1]) for line in said.splitlines() if ": error: " in line], wrong,
                                 said)

    def test_the_stub_has_the_names_of_the_compiled_module(self):
        stub = ast.parse((ROOT / "python/pliant/_pliant.pyi").read_text(encoding="utf-8"))
        self.assertEqual(set(names_of(stub.body)), {name for name in vars(_pliant) if not name.startswith("_")})
        for kind in stub.body:
            if isinstance(kind, ast.ClassDef) and kind.name != "Error":  # the code is of its objects
                named = {name for name in vars(getattr(_pliant, kind.name)) if not name.startswith("_")}
                self.assertEqual(set(names_of(kind.body)), named, kind.name)


if __name__ == "__main__":
    if importlib.util.find_spec("mypy") is None:
        print("skipped: Python has no mypy")
        sys.exit(SKIPPED)
    unittest.main()
