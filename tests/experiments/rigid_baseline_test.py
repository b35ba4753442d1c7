#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The rigid baseline: COLMAP's pipelines by version and with programs that fail, and the table of what they gave. The
programs here are small scripts in COLMAP's and Pliant's place; tests/e2e has COLMAP itself.

usage: rigid_baseline_test.py
"""

import contextlib
import importlib.util
import io
import json
import pathlib
import sys
import tempfile
import unittest

from support import MIN_PLOT_BYTES, SKIPPED, experiment_modules

experiment_modules("rigid_baseline")
if importlib.util.find_spec("yaml") is None:
    print("skipped: Python has no yaml")
    sys.exit(SKIPPED)

import baseline
import colmap_pipeline
import grid

# Says its version and commands; writes down how it was called; makes models of 3 and 7 images; fails where it is told to.
COLMAP = r'''#!/usr/bin/env python3
import pathlib, sys
here = pathlib.Path(__file__).parent
if sys.argv[1:] == ["help"]:
    print("COLMAP {version} -- Structure-from-Motion")
    print("  feature_extractor\n  sequential_matcher\n  mapper\n  {more}")
    sys.exit(0)
with open(here / "calls", "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\n")
if sys.argv[1] == "{fails}":
    print("{last_words}")
    sys.exit(1)
if sys.argv[1].endswith("mapper"):
    models = pathlib.Path(sys.argv[sys.argv.index("--output_path") + 1])
    for name, images in (("0", 3), ("1", 7)):
        (models / name).mkdir()
        (models / name / "images.bin").write_bytes(images.to_bytes(8, "little"))
'''
PLIANT = r'''#!/usr/bin/env python3
import pathlib, sys
given = dict(zip(sys.argv[2::2], sys.argv[3::2]))
output = pathlib.Path(given["--output_path"])
if sys.argv[1] == "import":
    output.mkdir()
    (output / "run.json").write_text(given["--input_path"])
'''


class Pipelines(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        (self.folder / "run/sparse").mkdir(parents=True)
        (self.folder / "run/sparse/cameras.txt").write_text("# a comment\n1 PINHOLE 640 480 500 501 320 240\n")
        (self.folder / "sequence/images").mkdir(parents=True)
        for i in range(9):
            (self.folder / f"sequence/images/{i}.png").touch()
        self.script("pliant", PLIANT)

    def script(self, name, text):
        path = self.folder / name
        path.write_text(text)
        path.chmod(0o755)
        return path

    def colmap(self, version="3.8", more="", fails="", last_words=""):
        text = COLMAP
        for name, value in (("version", version), ("more", more), ("fails", fails), ("last_words", last_words)):
            text = text.replace("{" + name + "}", value)
        return self.script("colmap", text)

    def make_run(self, pipeline, **colmap):
        return colmap_pipeline.make_run(pipeline, self.folder / "run", self.folder / "sequence", self.folder / "out",
                                        str(self.colmap(**colmap)), self.folder / "pliant", 3)

    def calls(self):
        return (self.folder / "calls").read_text().splitlines()

    def fails(self, sentence, pipeline, **colmap):
        with self.assertRaises(colmap_pipeline.Failure) as caught:
            self.make_run(pipeline, **colmap)
        self.assertIn(sentence, str(caught.exception))
        self.assertNotIn("\n", str(caught.exception))

    def test_the_largest_model_becomes_the_run(self):
        report = self.make_run("sift")
        self.assertEqual((report["model"], report["models"], report["images"]), ("models/1", 2, 7))
        self.assertTrue((self.folder / "out/run.json").read_text().endswith("models/1"))
        self.assertEqual([call.split()[0] for call in self.calls()], ["feature_extractor", "sequential_matcher", "mapper"])
        self.assertIn("--ImageReader.camera_model PINHOLE --ImageReader.camera_params 500,501,320,240", self.calls()[0])
        kept = json.loads((self.folder / "out/colmap/pipeline.json").read_text())
        self.assertEqual(set(kept["seconds"]), {"feature_extractor", "sequential_matcher", "mapper"})
        self.assertTrue((self.folder / "out/colmap/mapper.log").exists())
        self.make_run("sift")  # again, over what is there

    def test_our_tracks_need_no_features(self):
        report = self.make_run("tracks")
        self.assertEqual([call.split()[0] for call in self.calls()], ["mapper"])
        self.assertIn("export", report["seconds"])

    def test_options_have_the_names_of_the_version(self):
        for version, name in (("3.8", "SiftExtraction"), ("3.12", "SiftExtraction"), ("3.13.0", "FeatureExtraction"),
                              ("4.1", "FeatureExtraction")):
            self.make_run("sift", version=version)
            self.assertIn(f"--{name}.use_gpu 0", self.calls()[-3], version)
            self.assertIn(f"--{name.replace('Extraction', 'Matching')}.use_gpu 0", self.calls()[-2], version)

    def test_the_global_mapper_is_used_where_there_is_one(self):
        self.fails("COLMAP 3.8 has no global_mapper", "tracks_global")
        self.assertEqual(self.make_run("tracks_global", version="4.0", more="global_mapper")["images"], 7)
        self.assertEqual(self.calls()[-1].split()[0], "global_mapper")

    def test_a_command_that_fails_is_told_with_its_last_words_and_its_log_is_kept(self):
        self.fails("COLMAP's sequential_matcher ended with 1: no memory", "sift", fails="sequential_matcher", last_words="no memory")
        self.assertFalse((self.folder / "out").exists())
        self.assertIn("no memory", (self.folder / "out.colmap/sequential_matcher.log").read_text())
        self.fails("COLMAP's mapper ended with 1: out of memory", "sift", fails="mapper", last_words="out of memory")

    def test_no_model_is_an_answer(self):
        report = self.make_run("sift", fails="mapper", last_words="ERROR: failed to create sparse model")
        self.assertIsNone(report["model"])
        summary = json.loads((self.folder / "out/run.json").read_text())
        self.assertEqual((summary["status"], summary["counts"]), ("failed", {"frames_read": 9, "frames_tracked": 0}))

    def test_what_is_missing_is_told(self):
        self.fails("there is no pipeline 'surf', but sift, tracks", "surf")
        self.fails("does not say COLMAP's version", "sift", version="x")
        (self.folder / "run/sparse/cameras.txt").unlink()
        self.fails("give a run of Pliant that ended with a map", "sift")
        with self.assertRaisesRegex(colmap_pipeline.Failure, "install it"):
            colmap_pipeline.Colmap(str(self.folder / "nothing"))
        with contextlib.redirect_stderr(io.StringIO()) as said:
            sys.argv = ["colmap_pipeline.py", "sift", "--run", "r", "--sequence", "s", "--output_path", "o", "--colmap", "/nowhere"]
            self.assertEqual(colmap_pipeline.main(), 1)
        self.assertEqual(said.getvalue().count("\n"), 1)


class Table(unittest.TestCase):
    ROWS = [{"set": "dm", "amplitude_mm": amplitude, "omega_rad_s": "2.5", "seed": seed, "variant": variant,
             "status": "completed", "frames_tracked": 100, "rmse_mm": rmse, "null_rmse_mm": 13, "continuing_share": 0.25,
             "ate_percent": 2, "reprojection_px": 0.5, "seconds": 7}
            for amplitude in ("0", "5") for variant, figures in (("default", (1, 2, 9)), ("colmap_sift", (4, "", 6)))
            for seed, rmse in enumerate(figures)]

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory()
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        grid.write_rows(self.folder / "rows.csv", baseline.COLUMNS, self.ROWS)

    def test_has_medians_over_the_seeds_and_says_how_many_there_are(self):
        baseline.write(self.folder / "rows.csv", self.folder / "table.md", self.folder / "table.csv")
        ours, theirs = grid.read_rows(self.folder / "table.csv")[2:]
        self.assertEqual((ours["A, mm"], ours["run"], ours["seeds with a map"]), ("5", "default", "3/3"))
        self.assertEqual((ours["surface RMSE, mm"], ours["go on with another, %"], ours["points a frame"]), ("2.00", "25", "-"))
        self.assertEqual((theirs["seeds with a map"], theirs["surface RMSE, mm"]), ("2/3", "5.00"))
        self.assertIn("| 5 | colmap_sift | 2/3 |", (self.folder / "table.md").read_text())

    def test_curves_are_drawn(self):
        if importlib.util.find_spec("matplotlib") is None:
            self.skipTest("Python has no matplotlib")
        import baseline_plot

        baseline_plot.write(self.folder / "rows.csv", self.folder)
        self.assertGreater((self.folder / "comparison.png").stat().st_size, MIN_PLOT_BYTES)
        first = (self.folder / "comparison.svg").read_bytes()
        baseline_plot.write(self.folder / "rows.csv", self.folder)
        self.assertEqual((self.folder / "comparison.svg").read_bytes(), first)


if __name__ == "__main__":
    unittest.main()
