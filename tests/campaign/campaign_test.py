#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The campaign's checks see what is wrong, and a program that behaves badly is found out.

usage: campaign_test.py
"""

import pathlib
import random
import stat
import subprocess
import sys
import tempfile
import unittest

import checks
import mutations

CAMPAIGN = pathlib.Path(__file__).with_name("campaign.py")

# Makes the material's files, whatever it is asked; then behaves as the mode says.
PROGRAM = """#!{python}
import os, pathlib, sys, time
name = sys.argv[sys.argv.index("-o") + 1] if "-o" in sys.argv else None
if pathlib.Path.cwd().name == "material":
    for file in {files}:
        path = pathlib.Path(file)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("1 2 3\\n")
    sys.exit(0)
{behavior}
"""
FILES = ["seq/camera.yaml", "seq/times.txt", "seq/groundtruth.txt", "seq/simulation.yaml", "seq/images/000000.png",
         "seq/right/000000.png", "seq/depth/000000.png", "run/run.json", "run/config.yaml", "run/frames.csv",
         "run/trajectory.txt", "refined/frames.csv", "run/observations.csv", "run/map.ply", "run/sparse/images.bin", "text/images.txt",
         "tum/trajectory.txt", "csv/tracks.csv", "npz/tracks.npz", "surface/surface.json", "surface/depth/0",
         "surface/mesh/0", "surface/undeformed.ply", "film.mp4"]


class Checks(unittest.TestCase):
    def test_ends(self):
        for code, stderr, stopped_by in [(0, "", None), (1, "pliant track: no", None), (2, "pliant: no", None),
                                         (-9, "", 9), (-15, "", 15), (0, "pliant note", 2)]:
            self.assertEqual(checks.wrong_end(code, stderr, stopped_by), "", code)
        for code, stderr, stopped_by in [(-11, "", None), (-6, "", 15), (1, "", None), (3, "pliant: no", None),
                                         (-9, "", None), (1, "pliant: " + 400 * "x", None),
                                         (1, "pliant: OpenCV(4.6) error", None)]:
            self.assertNotEqual(checks.wrong_end(code, stderr, stopped_by), "", code)

    def test_files(self):
        whole = {"a.json": b"{}", "a.pdf": b"%PDF\n%%EOF\n", "a.svg": b"<svg/>", "a.png": b"\x89PNG....IEND\xaeB`\x82",
                 "a.html": b"<html></html>\n", "a.yaml": b"a: 1\n", "a.mp4": b"ftyp moov", "a.csv": b"1,2",
                 "a.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nend_header\n12345678"}
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for file, data in whole.items():
                path = folder / file
                path.write_bytes(data)
                self.assertEqual(checks.wrong_file(path), "", file)
                path.write_bytes(data[:-4])
                if file != "a.csv":
                    self.assertNotEqual(checks.wrong_file(path), "", file)
            self.assertEqual(len(checks.wrong_files(folder)), len(whole) - 1)
            (folder / ".unfinished").touch()
            self.assertEqual(checks.wrong_files(folder), [])


    def test_runs(self):
        with tempfile.TemporaryDirectory() as name:
            one, other = pathlib.Path(name, "one"), pathlib.Path(name, "other")
            for folder, word in ((one, "a"), (other, "b")):
                folder.mkdir()
                (folder / "frames.csv").write_text("1,2")
                (folder / "run.json").write_text(f'{{"command_line": ["{word}"], "points": 3}}')
            self.assertEqual(checks.differing_runs(one, other), [])
            (other / "frames.csv").write_text("1,3")
            (other / "map.ply").write_text("ply")
            (one / "run.json").write_text('{"command_line": [], "points": 4}')
            self.assertEqual(checks.differing_runs(one, other),
                             ["frames.csv differs", "map.ply is in one run only", "run.json differs"])


class Mutations(unittest.TestCase):
    def test_every_one_changes_something_and_repeats(self):
        data = b"ply 1 2.5 -3e4\nline\n" * 20
        for mutation in set(mutations.MUTATIONS):
            changed = [mutation(data, random.Random(seed)) for seed in range(20)]
            self.assertGreater(sum(one != data for one in changed), 10, mutation.__name__)
            self.assertEqual(changed, [mutation(data, random.Random(seed)) for seed in range(20)])

    def test_of_little_data(self):
        for data in (b"", b"x", b"12"):
            for seed in range(200):
                mutations.mutate(data, random.Random(seed))


class Campaign(unittest.TestCase):
    def run_on(self, behavior):
        with tempfile.TemporaryDirectory() as name:
            program = pathlib.Path(name) / "program"
            program.write_text(PROGRAM.format(python=sys.executable, files=FILES, behavior=behavior))
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            done = subprocess.run([sys.executable, "-B", CAMPAIGN, program, name + "/work", "--cases", "10"], text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, check=False)
            kept = list((pathlib.Path(name) / "work" / "wrong").iterdir())
            return done, kept

    def test_a_program_that_behaves_passes(self):
        done, kept = self.run_on("print('pliant: no', file=sys.stderr); sys.exit(1 if 'check' in sys.argv else 0)")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(kept, [])
        self.assertIn("10 cases", done.stdout)

    def test_one_that_crashes_is_found_out(self):
        done, kept = self.run_on("os.abort()")
        self.assertEqual(done.returncode, 1)
        self.assertGreater(len(kept), 6)
        self.assertIn("died of SIGABRT", done.stderr)

    def test_one_that_leaves_half_a_file_is_found_out(self):
        done, kept = self.run_on("if name: pathlib.Path(name).with_suffix('.pdf').write_text('%PDF')")
        self.assertEqual(done.returncode, 1)
        self.assertIn("a PDF without its end", done.stderr)
        self.assertTrue(kept)


if __name__ == "__main__":
    unittest.main()
