#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The campaign's checks see what is wrong, and a program that behaves badly is found out.

usage: campaign_test.py
"""

import math
import pathlib
import random
import stat
import subprocess
import sys
import tempfile
import unittest
import unittest.mock

import campaign
import checks
import material
import mutations
import options
import scenes

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
if "--print_config" in sys.argv:
    given = [word[2:] for word in sys.argv if word.startswith("--Group.")]
    if given:
        print("pliant track: " + given[0] + " is 'x'; give a number from 0.001 to 1e+06 px", file=sys.stderr)
        sys.exit(2)
    print("Group:  # of options\\n  one: 3   # [px] a size\\n  two: a   # [a | b] a choice")
    sys.exit(0)
{behavior}
"""
# Leaves a run whose rows in frames.csv, trajectory.txt are these.
RUN = """
if name and sys.argv[1] == "track":
    pathlib.Path(name).mkdir()
    pathlib.Path(name, "frames.csv").write_text("frame,state,cost\\n" + {frames!r})
    pathlib.Path(name, "trajectory.txt").write_text({trajectory!r})
"""
POSE = "0 1 2 3 0.6 0 0 0.8\n"
FILES = ["seq/camera.yaml", "seq/times.txt", "seq/groundtruth.txt", "seq/simulation.yaml", "seq/images/000000.png",
         "seq/right/000000.png", "seq/depth/000000.png", "run/run.json", "run/config.yaml", "run/frames.csv",
         "run/trajectory.txt", "refined/frames.csv", "run/observations.csv", "run/map.ply", "run/sparse/images.bin", "text/images.txt",
         "tum/trajectory.txt", "csv/tracks.csv", "npz/tracks.npz", "surface/surface.json", "surface/depth/0",
         "surface/mesh/0", "surface/undeformed.ply", "film.mp4", "film.y4m"]


class Checks(unittest.TestCase):
    def test_ends(self):
        for code, stderr, stopped_by in [(0, "", None), (1, "pliant track: no", None), (2, "pliant: no", None),
                                         (-9, "", 9), (-15, "", 15), (0, "pliant note", 2)]:
            self.assertEqual(checks.wrong_end(code, stderr, stopped_by), "", code)
        for code, stderr, stopped_by in [(-11, "", None), (-6, "", 15), (1, "", None), (3, "pliant: no", None),
                                         (-9, "", None), (1, "pliant: " + 400 * "x", None),
                                         (1, "pliant: OpenCV(4.6) error", None),
                                         (1, "pliant: no step: a fault that was asked for", None)]:
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


    def test_numbers_of_a_run(self):
        ply = b"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n" \
              b"property uchar red\nend_header\n"
        good = {"frames.csv": b"frame,state\n0,tracking\n1,lost\n", "trajectory.txt": POSE.encode(),
                "sparse/images.txt": b"# Images\n1 0.8 0 0.6 0 1 2 3 1 inf.png\n\n2 1 0 0 0 1 2 3 1 info.png\n1 2 -1\n",
                "observations.csv": b"frame,z\n0,0.0\n0,1e30\n", "map.ply": ply + b"\0\0\x80\x3f\xff",
                "run.json": b'{"note": "information; finance, nancy"}'}
        bad = {"frames.csv": [b"frame,state\n0,tracking\n1,confused\n", b"frame,state\n0,lost\n",
                              b"frame,state,cost\n0,tracking,-inf\n"],
               "trajectory.txt": [b"0 1 nan 3 0.6 0 0 0.8\n", b"0 1 2 3 0.6 0 0 0.81\n", b"0 1 2 3 0 0 0 0\n",
                                  POSE.encode() * 2],
               "sparse/images.txt": [b"1 0.8 0 0.6 0 1 2 3 1 0.png\n\n2 1 1 0 0 1 2 3 1 1.png\n1 2 -1\n"],
               "observations.csv": [b"frame,z\n0,NaN\n", b"frame,z\n0,0.000\n1,-0.000\n"],
               "run.json": [b'{"error": NaN}', b'{"error": -Infinity}'],
               "map.ply": [ply + b"\0\0\x80\x7f\xff", ply + b"\0\0\xc0\x7f\xff",
                           ply.replace(b"binary_little_endian", b"ascii") + b"nan 1\n"]}
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "sparse").mkdir()
            for file, data in good.items():
                (folder / file).write_bytes(data)
            self.assertEqual(checks.wrong_run(folder), [])
            for file, all_data in bad.items():
                for data in all_data:
                    (folder / file).write_bytes(data)
                    self.assertEqual(len(checks.wrong_run(folder)), 1, data)
                    (folder / file).write_bytes(good[file])


class Scenes(unittest.TestCase):
    def depths(self, shape):
        return [z for _, _, z in scenes.SHAPES[shape](random.Random(1))]

    def test_shapes_are_what_they_are_called(self):
        self.assertEqual(len(self.depths("dozen")), 12)
        self.assertEqual(len(set(self.depths("plane"))), 1)
        self.assertGreater(max(self.depths("depths_1_to_1000")), 500 * min(self.depths("depths_1_to_1000")))
        self.assertGreater(min(self.depths("far_away")), 1e7)
        line = scenes.SHAPES["line"](random.Random(1))
        for point in line[2:]:
            shares = [(at - first) / (second - first) for at, first, second in zip(point, *line[:2])]
            self.assertLess(max(shares) - min(shares), 1e-9)

    def test_motions_are_what_they_are_called(self):
        def moved(motion, first, last):
            frames = scenes.tracks("plane", motion, 0, False, random.Random(1))
            both = [(frames[first][dot], frames[last][dot]) for dot in frames[first].keys() & frames[last].keys()]
            return [(there[0] - here[0], there[1] - here[1]) for here, there in both]

        for u_px, v_px in moved("one_pixel", 0, scenes.FRAMES - 1):
            self.assertTrue(math.isclose(u_px, -80 / 60, rel_tol=1e-9) and v_px == 0)
        self.assertGreater(len(moved("300_pixels", 0, 2)), 100)
        self.assertEqual(moved("300_pixels", 0, 1), [])
        self.assertEqual(set(moved("still", 0, 20)), {(0.0, 0.0)})
        self.assertEqual(scenes.camera("quarter_turns", 21, 18), ((0.8 * 18 + 0.5 * 3, 0.1 * 18, 0.0), 270.0))

    def test_half_of_the_dots_keep_their_places_where_the_map_is_to_live_on(self):
        for shape in set(scenes.SHAPES) - {"cloud", "no_shape"}:
            frames = scenes.tracks(shape, "still", 18, True, random.Random(1))
            kept = [dot for dot in frames[17].keys() & frames[18].keys()
                    if math.dist(frames[17][dot], frames[18][dot]) < 10]
            self.assertGreater(sum(dot % 2 == 0 for dot in kept), 60, shape)
            self.assertTrue(any(dot % 2 == 1 for dot in frames[18]), shape)
            frames = scenes.tracks(shape, "still", 18, False, random.Random(1))
            kept = [dot for dot in frames[17].keys() & frames[18].keys()
                    if math.dist(frames[17][dot], frames[18][dot]) < 10]
            self.assertLess(len(kept), 30, shape)

    def test_huge_tracks_are_given_to_the_program(self):
        given = 0
        for seed in range(300):
            with tempfile.TemporaryDirectory() as name:
                case = campaign.Case("program", None, pathlib.Path(name), seed)
                said = []
                case.track = lambda *words: said.append(words)
                with unittest.mock.patch.object(scenes, "write"), \
                        unittest.mock.patch.object(options, "draw", return_value={}):
                    case.scene()
                if "huge_tracks" in case.what["scene"]:
                    given += 1
                    self.assertIn("--tracks", said[0])
        self.assertGreater(given, 10)

    def test_images_are_spoiled(self):
        gray = [scenes.GRAY] * 10000
        noisy = scenes.spoil(gray, 0, "noise", random.Random(1))
        self.assertAlmostEqual(math.sqrt(sum((level - scenes.GRAY) ** 2 for level in noisy) / len(noisy)), 50, delta=5)
        self.assertEqual([set(scenes.spoil([7], 9, what, None)) for what in ("none", "equal", "black", "white")],
                         [{7}, {scenes.GRAY}, {0}, {255}])
        self.assertEqual(scenes.spoil([7], 8, "black", None), [7])

    def test_dots_are_where_the_tracks_say(self):
        drawn = scenes.image({0: (100.25, 50.75)}, [(0, 0, 0)])
        weights = [level - scenes.GRAY for level in drawn]
        places = [sum(weight * at for weight, at in zip(weights, values)) / sum(weights) for values in
                  ([i % scenes.WIDTH for i in range(len(drawn))], [i // scenes.WIDTH for i in range(len(drawn))])]
        self.assertAlmostEqual(places[0], 100.25, delta=0.05)
        self.assertAlmostEqual(places[1], 50.75, delta=0.05)


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


class Material(unittest.TestCase):
    def test_a_command_that_fails_before_anything_is_damaged_is_found_out(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name) / "whole"
            for file in FILES + ["opencv.yaml", "opencv.xml", "text/a.txt"]:
                (folder / file).parent.mkdir(parents=True, exist_ok=True)
                (folder / file).write_text(f'{{"run": "{folder}/run"}}\n')
            program = pathlib.Path(name) / "program"
            program.write_text("#!/bin/sh\ngrep -q material/run surface/surface.json || exit 1\n"
                               "case \"$*\" in *$FAILS*) echo no such option >&2; exit 2;; esac\n")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            with unittest.mock.patch.dict("os.environ", {"FAILS": "none"}):
                material.check(str(program), folder)
            with unittest.mock.patch.dict("os.environ", {"FAILS": "mesh_path"}), \
                    self.assertRaisesRegex(ValueError, "mesh_path .* fails before .*no such option"):
                material.check(str(program), folder)


class Campaign(unittest.TestCase):
    def run_on(self, behavior, *arguments):
        with tempfile.TemporaryDirectory() as name:
            program = pathlib.Path(name) / "program"
            program.write_text(PROGRAM.format(python=sys.executable, files=FILES, behavior=behavior))
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            done = subprocess.run([sys.executable, "-B", CAMPAIGN, program, name + "/work", "--cases", "10",
                                   *arguments], text=True, stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE, check=False)
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

    def test_numbers_are_checked_after_random_options_and_hostile_scenes(self):
        for kind in ("options", "scene"):
            for frames, trajectory, what in [("0,tracking,1\n", POSE, None),
                                             ("0,tracking,nan\n", POSE, "frames.csv: nan"),
                                             ("0,tracking,1\n", POSE.replace("0.6", "0"), "no rotation")]:
                behavior = RUN.format(frames=frames, trajectory=trajectory)
                done, kept = self.run_on(behavior, "--kinds", kind, "--cases", "3")
                self.assertIn(f"(3 {kind})", done.stdout)
                self.assertEqual(done.returncode, 1 if what else 0, done.stderr)
                self.assertEqual(len(kept), 3 if what else 0)
                if what:
                    self.assertIn(what, done.stderr)

    def test_options_are_drawn_within_their_ranges(self):
        with tempfile.TemporaryDirectory() as name:
            program = pathlib.Path(name) / "program"
            program.write_text(PROGRAM.format(python=sys.executable, files=FILES, behavior=""))
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            drawn = [options.draw(str(program), random.Random(seed)) for seed in range(200)]
        sizes = [float(one["Group.one"]) for one in drawn if "Group.one" in one]
        self.assertEqual({one.get("Group.two") for one in drawn}, {"a", "b", None})
        self.assertTrue(all(0.001 <= size <= 1e6 for size in sizes))
        self.assertGreater(len(set(sizes)), 50)
        self.assertLess(min(sizes), 0.1)
        self.assertGreater(max(sizes), 1000)
        self.assertEqual(options.yaml({"B.x": "1", "A.y": "b", "A.x": "2"}), "A:\n  x: 2\n  y: b\nB:\n  x: 1\n")

    def test_a_sentence_that_is_not_understood_ends_the_campaign(self):
        with tempfile.TemporaryDirectory() as name:
            program = pathlib.Path(name) / "program"
            text = PROGRAM.replace("give a number from 0.001 to 1e+06 px", "use another one")
            program.write_text(text.format(python=sys.executable, files=FILES, behavior=""))
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
            with self.assertRaisesRegex(ValueError, "Group.one: no range is found in .*use another one"):
                options.check(str(program))
            program.write_text("#!/bin/sh\necho nothing\n")
            options.table.cache_clear()
            with self.assertRaisesRegex(ValueError, "no options"):
                options.check(str(program))


if __name__ == "__main__":
    unittest.main()
