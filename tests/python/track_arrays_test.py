# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of another program as arrays of the program."""

import unittest
from unittest import mock

import numpy as np

import pliant
from support import RUN, SEQUENCE, TestCase, images, sentence

FRAMES = 30
OPTIONS = {"General.timings": "none"}


class Arrays(TestCase):
    """Tracks that are arrays are read, checked and scored as a file of them."""

    def setUp(self):
        super().setUp()
        pliant.export(RUN, self.folder / "exported", "tracks_npz", sequence=SEQUENCE)
        with np.load(self.folder / "exported" / "tracks.npz") as arrays:
            self.arrays = dict(arrays)
        self.pair = self.arrays["tracks"], self.arrays["visibility"]
        self.temporary = self.folder / "temporary"
        self.temporary.mkdir()
        patch = mock.patch("tempfile.tempdir", str(self.temporary))
        patch.start()
        self.addCleanup(patch.stop)

    def track(self, name, tracks, **arguments):
        return pliant.track(SEQUENCE, self.folder / name, OPTIONS, end=FRAMES, tracks=tracks, **arguments)

    def same(self, run, other):
        for name in ("trajectory.txt", "observations.csv", "frames.csv"):
            self.assertEqual((run.folder / name).read_bytes(), (other.folder / name).read_bytes(), name)
        self.assertEqual(len(run.poses), FRAMES)
        self.assertEqual(list(self.temporary.iterdir()), [])

    def test_they_are_tracked_as_their_file_is(self):
        file = self.track("file", self.folder / "exported" / "tracks.npz")
        self.same(self.track("names", self.arrays), file)
        with np.load(self.folder / "exported" / "tracks.npz") as arrays:
            self.same(self.track("npz", arrays), file)
        np.savez(self.folder / "plain.npz", tracks=self.pair[0], visibility=self.pair[1])
        plain = self.track("plain", self.folder / "plain.npz")
        self.same(self.track("pair", self.pair), plain)
        self.same(self.track("batch", [self.pair[0][None], self.pair[1][None]]), plain)  # as CoTracker gives them
        self.same(self.track("corner", (np.float64(self.pair[0]) + 0.5, self.pair[1]), tracks_pixel_origin="corner"),
                  plain)

    def test_images_that_come_one_by_one_are_as_many_as_their_frames(self):
        camera, frames = pliant.read_camera(SEQUENCE / "camera.yaml"), images(FRAMES)
        tracks, seen = (array[:FRAMES] for array in self.pair)
        listed, iterated = (pliant.track(given, self.folder / name, OPTIONS, camera=camera, tracks=(tracks, seen))
                            for name, given in (("list", frames), ("iterated", (image for image in frames))))
        self.same(iterated, listed)
        turned = np.ascontiguousarray(tracks.transpose(1, 0, 2)), np.ascontiguousarray(seen.T)
        with self.assertRaises(ValueError) as caught:
            pliant.track((image for image in frames), self.folder / "turned", OPTIONS, camera=camera, tracks=turned)
        self.assertEqual(sentence(self, caught.exception),
                         f"there are {tracks.shape[1]} frames of tracks for {FRAMES} images; each image needs one")

    def test_they_are_scored_as_their_file_is(self):
        file = pliant.evaluate(None, SEQUENCE, tracks=self.folder / "exported" / "tracks.npz")["tracks"]
        self.assertEqual(pliant.evaluate(None, SEQUENCE, tracks=self.pair)["tracks"], file)

    def test_what_does_not_fit_is_refused_in_one_sentence(self):
        tracks, seen = self.pair
        turned = np.ascontiguousarray(tracks.transpose(1, 0, 2))  # (points, frames, 2)
        for kind, message, given in (
                (pliant.Error, "it has to be (frames, points)", (turned, seen)),
                (pliant.Error, "(points, frames, 2) is to be transposed", (turned, np.ascontiguousarray(seen.T))),
                (pliant.Error, "frames and the images", (tracks[1:], seen[1:])),
                (pliant.Error, "it has to be (frames, points, 2) with x before y", (tracks[0], seen[0])),
                (pliant.Error, "save bools, for example visibility > 0.5", (tracks, seen.astype(float))),
                (ValueError, "the tracks have the arrays points, occluded; name them",
                 {"points": tracks, "occluded": ~seen}),
                (ValueError, "tracks is a tuple of 3; give a pair", (tracks, seen, seen)),
                (TypeError, "visibility of the tracks is no array of numbers", (tracks, None)),
                (TypeError, "tracks of the tracks is no array of numbers", ([[1, 2], [1]], seen))):
            with self.subTest(message), self.assertRaises(kind) as caught:
                self.track("refused", given)
            self.assertIn(message, sentence(self, caught.exception))
            self.assertFalse((self.folder / "refused").exists())
            self.assertEqual(list(self.temporary.iterdir()), [])
        with self.assertRaisesRegex(ValueError, "a run with arrays of tracks cannot be resumed"):
            self.track("refused", self.pair, resume=True)
        with self.assertRaisesRegex(ValueError, "give them to pliant.track"):
            pliant.Tracker(pliant.read_camera(SEQUENCE / "camera.yaml"), tracks=self.pair)
        with self.assertRaisesRegex(TypeError, "tracks_pixel_origin is a int; give text"):
            self.track("refused", self.pair, tracks_pixel_origin=0)


if __name__ == "__main__":
    unittest.main()
