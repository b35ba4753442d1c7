#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What Pliant exports, opened by COLMAP itself: its converter, analyzer, bundle adjuster, triangulator, mapper and
undistorter.

usage: colmap_test.py PLIANT SEQUENCE RUN WORK

SEQUENCE is a simulated, rigid one, so that the undeformed map of its RUN is a rigid reconstruction too. Skipped (exit code 77)
where there is no COLMAP.
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import unittest

SKIPPED = 77
FILES = ("cameras", "images", "points3D")
PLIANT, SEQUENCE, RUN, WORK = (pathlib.Path(argument) for argument in sys.argv[1:5])

MIN_IMAGES = 40  # of 60; those without a map or with too few points are not registered
MIN_POINTS = 100  # of a map of some hundred
REPROJECTION_PX = 0.3  # what a track leaves of no error
RMSE_MM = 1  # at some 50 mm, scale per frame
DRIFT_PX = 0.3
SHARE_OF_PATH = 0.01


def run(*arguments):
    """What a program printed; a test fails with it if the program does."""
    environment = dict(os.environ, QT_QPA_PLATFORM="offscreen")
    done = subprocess.run([str(argument) for argument in arguments], env=environment, text=True, errors="replace",
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, arguments))} ended with {done.returncode}:\n{done.stdout[-2000:]}")
    return done.stdout


def colmap(command, **options):
    return run("colmap", command, *(text for name, value in options.items() for text in (f"--{name.replace('__', '.')}", value)))


def folder(name):
    path = WORK / name
    path.mkdir(parents=True, exist_ok=True)
    return path


def counts(model):
    """Images, points and observations as COLMAP's analyzer counts them."""
    figures = {}
    for line in colmap("model_analyzer", path=model).splitlines():
        name, colon, value = line.partition(": ")
        if colon and value.replace(".", "", 1).rstrip("px").isdigit():
            figures[name.split("]")[-1].strip()] = float(value.rstrip("px"))
    return figures


class ColmapOpens(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        shutil.rmtree(WORK, ignore_errors=True)

    def export(self, name, *options):
        path = WORK / name
        run(PLIANT, "export", "--run", RUN, "--format", name, "--output_path", path, "--quiet", *options)
        return path

    def test_the_runs_own_model(self):
        figures = counts(RUN / "sparse")
        self.assertGreater(figures["Registered images"], MIN_IMAGES)
        self.assertGreater(figures["Points"], MIN_POINTS)

    def test_what_it_converts_comes_back_byte_for_byte(self):
        text = folder("converted_text")
        binary = folder("converted_binary")
        colmap("model_converter", input_path=RUN / "sparse", output_path=text, output_type="TXT")
        colmap("model_converter", input_path=text, output_path=binary, output_type="BIN")
        for source, form, ending in ((text, "text", "txt"), (binary, "binary", "bin")):
            again = WORK / f"again_{form}"
            run(PLIANT, "model", "convert", "--input_path", source, "--output_path", again, "--format", form)
            for name in FILES:
                self.assertEqual((source / f"{name}.{ending}").read_bytes(), (again / f"{name}.{ending}").read_bytes(),
                                 f"{name}.{ending}")

    def test_spacetime_and_frames(self):
        spacetime = counts(self.export("spacetime"))
        self.assertEqual(spacetime["Points"], spacetime["Observations"])
        frames = sorted(self.export("frames").iterdir())
        self.assertEqual(len(frames), spacetime["Registered images"])
        self.assertEqual(counts(frames[-1])["Registered images"], 1)
        self.assertEqual(counts(self.export("colmap4d"))["Points"], spacetime["Points"])

    def test_bundle_adjustment_of_a_rigid_run(self):
        adjusted = folder("adjusted")
        output = colmap("bundle_adjuster", input_path=self.export("canonical"), output_path=adjusted)
        self.assertIn("Convergence", output)
        self.assertLess(counts(adjusted)["Mean reprojection error"], REPROJECTION_PX)

    def test_triangulation_and_mapping_from_our_tracks(self):
        database = self.export("database") / "database.db"
        triangulated = folder("triangulated")
        colmap("point_triangulator", database_path=database, image_path=SEQUENCE / "images",
               input_path=self.export("canonical"), output_path=triangulated)
        self.assertGreater(counts(triangulated)["Points"], MIN_POINTS)
        mapped = folder("mapped")
        # Its own bounds on the first pair are for photographs from all sides; this camera goes straight ahead.
        colmap("mapper", database_path=database, image_path=SEQUENCE / "images", output_path=mapped,
               Mapper__ba_refine_focal_length=0, Mapper__ba_refine_extra_params=0, Mapper__init_max_forward_motion=1,
               Mapper__init_min_tri_angle=2)
        figures = counts(mapped / "0")
        self.assertGreater(figures["Registered images"], MIN_IMAGES)
        self.assertLess(figures["Mean reprojection error"], REPROJECTION_PX)
        run(PLIANT, "model", "check", mapped / "0")
        self.compare_with_ours(mapped / "0")
        self.start_from(mapped / "0")

    def compare_with_ours(self, model):
        """A rigid scene: COLMAP's answer on our tracks and ours are one."""
        imported = WORK / "imported"
        run(PLIANT, "import", "--input_path", model, "--sequence", SEQUENCE, "--output_path", imported, "--quiet")
        compared = WORK / "compared"
        run(PLIANT, "compare", "--run", RUN, "--run", imported, "--sequence", SEQUENCE, "--output_path", compared,
            "--quiet")
        ours, theirs = json.loads((compared / "comparison.json").read_text())["runs"]
        self.assertGreater(theirs["survival"]["frames_tracked"], MIN_IMAGES)
        self.assertLess(theirs["surface"]["estimate"]["mean_rmse_mm"], RMSE_MM)
        self.assertLess(theirs["material"]["drift"]["median_px"], DRIFT_PX)
        self.assertLess(ours["surface"]["estimate"]["mean_rmse_mm"], RMSE_MM)
        self.assertLess(theirs["trajectory"]["ate_rmse_mm"], SHARE_OF_PATH * theirs["trajectory"]["true_path_length_mm"])

    def start_from(self, model):
        started = WORK / "started"
        run(PLIANT, "track", "--image_path", SEQUENCE, "--output_path", started, "--Init.method", "colmap_model",
            "--Init.model_path", model, "--quiet")
        summary = json.loads((started / "run.json").read_text())
        self.assertEqual(summary["status"], "completed")
        self.assertEqual(summary["first_map"]["reference_frame"], summary["first_map"]["declared_frame"])

    def test_undistortion(self):
        undistorted = folder("undistorted")
        colmap("image_undistorter", image_path=SEQUENCE / "images", input_path=self.export("canonical"),
               output_path=undistorted)
        self.assertGreater(len(list((undistorted / "images").iterdir())), MIN_IMAGES)


if __name__ == "__main__":
    if not shutil.which("colmap"):
        print("there is no COLMAP; ./run test installs it")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0]], verbosity=2)
