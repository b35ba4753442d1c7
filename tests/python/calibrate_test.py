# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Calibration with a board."""

import os
import unittest
from pathlib import Path

import pliant
from support import SEQUENCE, TestCase, sentence

RECORDINGS = Path(os.environ.get("PLIANT_RECORDINGS", Path(__file__).resolve().parents[3] / "shared" / "data"))
BOARDS = RECORDINGS / "capsule_boards"


class Calibrate(TestCase):
    def test_images_without_the_board_are_an_error_and_nothing_is_written(self):
        told = []
        with self.assertRaises(pliant.Error) as caught:
            pliant.calibrate(Path(SEQUENCE) / "images", "chessboard:7x6:2", self.folder / "camera.yaml",
                             {"Calibrate.max_images": 3}, on_progress=lambda *at: told.append(at))
        sentence(self, caught.exception)
        self.assertIn("is in none of the", str(caught.exception))
        self.assertFalse((self.folder / "camera.yaml").exists())
        self.assertEqual({"search", "size"}, {task for task, _, _ in told})
        self.assertIn(("search", told[0][2], told[0][2]), told)

    def test_a_board_that_is_none_is_a_value_error(self):
        with self.assertRaisesRegex(ValueError, "chessboard:9x6:2.0"):
            pliant.calibrate(SEQUENCE, "7x6:2")

    def test_its_options_are_listed(self):
        self.assertEqual(pliant.options("calibrate")["Calibrate.model"], "auto")

    def test_pairs_are_given_in_one_way(self):
        with self.assertRaisesRegex(ValueError, "right_path"):
            pliant.calibrate_stereo(SEQUENCE, "chessboard:7x6:2")
        with self.assertRaisesRegex(ValueError, "right_path"):
            pliant.calibrate_stereo(SEQUENCE, "chessboard:7x6:2", right_path=SEQUENCE, pairs="left_right")

    def test_pairs_without_the_board_are_an_error(self):
        with self.assertRaises(pliant.Error) as caught:
            pliant.calibrate_stereo(SEQUENCE, "chessboard:7x6:2", options={"Calibrate.max_images": 3},
                                    right_path=SEQUENCE)
        sentence(self, caught.exception)
        self.assertIn("is in none of the", str(caught.exception))

    @unittest.skipUnless(BOARDS.exists(), f"there are no images in {BOARDS}")
    def test_one_camera_twice_is_no_pair(self):
        with self.assertRaises(pliant.Error) as caught:
            pliant.calibrate_stereo(BOARDS, "chessboard:7x6:2", options={"Calibrate.model": "RADIAL"},
                                    right_path=BOARDS)
        self.assertIn("at the same place", str(caught.exception))

    @unittest.skipUnless(BOARDS.exists(), f"there are no images in {BOARDS}")
    def test_a_camera_from_images_of_a_real_board(self):
        found = pliant.calibrate(BOARDS, "chessboard:7x6:2", self.folder / "camera.yaml",
                                 {"Calibrate.model": "OPENCV_FISHEYE"}, figure=self.folder / "figure.png")
        self.assertEqual(found.camera.model, "OPENCV_FISHEYE")
        self.assertEqual(len(found.sigmas), len(found.camera.params))
        self.assertEqual(len(found.images), 10)
        self.assertTrue(130 < found.camera.params[0] < 160)
        self.assertTrue(any("tilt" in sentence for sentence in found.advice))
        read = pliant.read_camera(self.folder / "camera.yaml")
        self.assertEqual(list(read.params), list(found.camera.params))
        self.assertGreater((self.folder / "figure.png").stat().st_size, 1000)


if __name__ == "__main__":
    unittest.main()
