# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of other systems that cannot be meant are refused, and nothing of others is overwritten."""

import shutil
import unittest

import numpy as np

import pliant
from support import RUN, TestCase, sentence

SIZE = (640, 480)
FRAMES, POINTS = 3, 20
INTRINSICS = np.array([[240.0, 0, 127.5], [0, 240, 95.5], [0, 0, 1]])  # of images of 256x192 pixels


def tapip3d(**changed):
    grid = np.stack([*np.mgrid[-20:21:10, -15:16:10].reshape(2, -1), np.full(POINTS, 60)], 1)
    return {"coords": np.tile(grid, (FRAMES, 1, 1)), "visibs": np.ones((FRAMES, POINTS), bool),
            "video": np.zeros((FRAMES, 3, 192, 256), np.uint8), "intrinsics": np.tile(INTRINSICS, (FRAMES, 1, 1)),
            "extrinsics": np.tile(np.eye(4), (FRAMES, 1, 1)), **changed}


class ConvertArrays(TestCase):
    def convert(self, arrays, output="result", system="tapip3d", size=SIZE, **named):
        np.savez(self.folder / "arrays.npz", **arrays)
        return pliant.convert_arrays(self.folder / "arrays.npz", self.folder / output, system, size, **named)

    def refused(self, kind, message, *arguments, **named):
        with self.subTest(message), self.assertRaises(kind) as caught:
            self.convert(*arguments, **named)
        self.assertIn(message, sentence(self, caught.exception))
        self.assertFalse((self.folder / "result").exists())

    def test_a_folder_with_files_of_others_is_refused_and_a_former_result_is_replaced(self):
        shutil.copytree(RUN, self.folder / "run")
        (self.folder / "notes").mkdir()
        (self.folder / "notes" / "notes.txt").write_text("mine")
        for folder, name in (("run", "config.yaml"), ("notes", "notes.txt")):
            with self.assertRaises(ValueError) as caught:
                self.convert(tapip3d(), folder)
            self.assertIn(f"holds files that are not a converted result's, such as {name}; give a new or an empty folder",
                          sentence(self, caught.exception))
        self.assertEqual(sorted(file.name for file in (self.folder / "notes").iterdir()), ["notes.txt"])
        for name in ("observations.csv", "trajectory.txt"):
            self.assertEqual((self.folder / "run" / name).read_bytes(), (RUN / name).read_bytes())
        (self.folder / "result").mkdir()
        for frames in (FRAMES, 2):
            arrays = {name: array[:frames] for name, array in tapip3d().items()}
            self.convert(arrays, tracks_path=self.folder / "result" / "tracks.npz")
            self.assertEqual(len(pliant.open_run(self.folder / "result").poses), frames)

    def test_a_result_without_points_is_a_warning(self):
        for changed in ({"visibs": np.zeros((FRAMES, POINTS), bool)}, {"coords": np.full((FRAMES, POINTS, 3), np.nan)}):
            with self.subTest(next(iter(changed))), self.assertWarnsRegex(UserWarning, "has the camera path alone"):
                written = self.convert(tapip3d(**changed))
            self.assertEqual((written["poses"], written["points"]), (FRAMES, 0))

    def test_visibility_is_true_and_false(self):
        for values in (np.full((FRAMES, POINTS), 0.3), np.full((FRAMES, POINTS), np.nan), np.full((FRAMES, POINTS), 2)):
            self.refused(pliant.Error, "'visibs' has values other than 0 and 1; save bools", tapip3d(visibs=values))
        self.assertEqual(self.convert(tapip3d(visibs=np.ones((FRAMES, POINTS), np.float32)))["points"], FRAMES * POINTS)

    def test_intrinsics_are_a_camera_of_the_images(self):
        for k in (0 * INTRINSICS, INTRINSICS * [[-1], [1], [1]], INTRINSICS * np.nan):
            self.refused(pliant.Error, "'intrinsics' has focal lengths that are not above 0, or values that are not",
                         tapip3d(intrinsics=np.tile(k, (FRAMES, 1, 1))))
        self.refused(pliant.Error, "'intrinsics' has principal points far outside of its images of 256x192",
                     tapip3d(intrinsics=np.tile(INTRINSICS * [[4], [4], [1]], (FRAMES, 1, 1))))
        megasam = {"cam_c2w": np.tile(np.eye(4), (FRAMES, 1, 1)), "depths": np.ones((FRAMES, 384, 512)),
                   "intrinsic": np.zeros((3, 3))}
        self.refused(pliant.Error, "'intrinsic' has focal lengths that are not above 0", megasam, system="megasam")

    def test_a_size_is_width_and_height(self):
        self.refused(pliant.Error, "images of 480x640 do not fit the focal lengths in 'intrinsics', and images of 640x480 "
                     "do; size is (width, height)", tapip3d(), size=(480, 640))
        narrow = np.tile(INTRINSICS * [[0.5], [1], [1]], (FRAMES, 1, 1))  # as of fields of interlaced images
        self.assertGreater(self.convert(tapip3d(intrinsics=narrow))["points"], 0)

    def test_what_a_system_has_no_use_for_is_refused(self):
        self.refused(ValueError, "path is for droid, and system is tapip3d; leave it out", tapip3d(), path="path.npy")
        self.refused(ValueError, "tracks_path is for tapip3d, and system is megasam; leave it out", {"a": 1},
                     system="megasam", tracks_path="tracks.npz")

    def test_tracks_are_written_where_they_are_wanted(self):
        self.convert(tapip3d(), tracks_path=self.folder / "points.tracks")
        self.assertFalse((self.folder / "points.tracks.npz").exists())
        with np.load(self.folder / "points.tracks") as tracks:
            self.assertEqual(tracks["tracks"].shape, (FRAMES, POINTS, 2))


if __name__ == "__main__":
    unittest.main()
