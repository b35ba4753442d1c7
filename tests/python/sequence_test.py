# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A sequence is what lies on disk, as often as it is read."""

import copy
import pickle
import unittest

import numpy as np

import pliant
from support import SEQUENCE, TestCase, images, sentence


class Sequences(TestCase):
    def test_frames_are_those_of_the_folder(self):
        sequence = pliant.open_sequence(SEQUENCE, start=2, end=8, stride=2)
        self.assertEqual(len(sequence), 3)
        stored = images(8)
        for _ in range(2):
            frames = list(sequence)
            self.assertEqual([frame.frame_idx for frame in frames], [2, 4, 6])
            for frame in frames:
                np.testing.assert_array_equal(frame.image, stored[frame.frame_idx])
                self.assertIsNone(frame.right)
        self.assertEqual(frames[0].name, "000002.png")
        self.assertAlmostEqual(frames[1].timestamp, float((SEQUENCE / "times.txt").read_text().split()[4]))

    def test_truth_is_of_any_frame(self):
        sequence = pliant.open_sequence(SEQUENCE)
        depth, pose = sequence.depth(5), sequence.world_from_cam(5)
        self.assertEqual((depth.dtype, depth.shape), (np.float32, (sequence.camera.height, sequence.camera.width)))
        self.assertTrue(10 < np.median(depth) < 300)
        row = (SEQUENCE / "groundtruth.txt").read_text().splitlines()[5].split()
        np.testing.assert_allclose(pose[:3, 3], [float(number) for number in row[1:4]], atol=1e-6)
        self.assertIsNone(sequence.baseline_mm)

    def test_a_copy_opens_it_again(self):
        sequence = pliant.open_sequence(SEQUENCE, start=2, end=8, stride=2)
        for again in (pickle.loads(pickle.dumps(sequence)), copy.deepcopy(sequence)):
            self.assertEqual(repr(again), repr(sequence))
            self.assertEqual([frame.frame_idx for frame in again], [2, 4, 6])

    def test_what_is_not_there_is_one_sentence(self):
        with self.assertRaises(pliant.Error) as raised:
            pliant.open_sequence(self.folder / "none")
        self.assertEqual(raised.exception.code, "not_found")
        sentence(self, raised.exception)
        with self.assertRaises(ValueError):
            pliant.open_sequence(SEQUENCE, start=50, end=40)

    def test_it_is_tracked_as_it_is(self):
        sequence = pliant.open_sequence(SEQUENCE, end=20)
        self.assertEqual(sequence.camera.fps, pliant.read_camera(SEQUENCE / "camera.yaml").fps)
        run = pliant.track((frame.image for frame in sequence), self.folder / "run", {"Image.working": "fixed"},
                           camera=sequence.camera)
        self.assertEqual(len(run.frames), 20)
        opened = pliant.track(sequence, self.folder / "opened", {"Image.working": "fixed"})
        np.testing.assert_array_equal(opened.observations.position, run.observations.position)
        self.assertIn("20 frames of 640x480", repr(sequence))


if __name__ == "__main__":
    unittest.main()
