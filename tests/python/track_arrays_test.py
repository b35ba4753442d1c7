# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of another program as arrays of the program."""

import json
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
        self.same(self.track("floats", (self.pair[0], self.pair[1].astype(float))), plain)
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
        for given in (frames, (image for image in frames)):
            with self.assertRaises(ValueError) as caught:
                pliant.track(given, self.folder / "turned", OPTIONS, camera=camera, tracks=turned)
            self.assertEqual(sentence(self, caught.exception),
                             f"there are {tracks.shape[1]} frames of tracks for {FRAMES} images; each image needs one")

    def test_they_are_scored_as_their_file_is(self):
        file = pliant.evaluate(None, SEQUENCE, tracks=self.folder / "exported" / "tracks.npz")["tracks"]
        self.assertEqual(pliant.evaluate(None, SEQUENCE, tracks=self.pair)["tracks"], file)

    def test_an_evaluation_names_the_arrays_and_warns_of_its_notes(self):
        rounded = np.round(self.pair[0]), self.pair[1]
        with self.assertWarns(UserWarning) as caught:
            evaluation = pliant.evaluate(None, SEQUENCE, tracks=rounded, output_path=self.folder)
        self.assertEqual(evaluation["run"], "the given arrays")
        self.assertEqual(evaluation["notes"], [str(caught.warning)])
        self.assertIn("the pixels in the given arrays are whole numbers", str(caught.warning))
        self.assertEqual(evaluation, json.loads((self.folder / "evaluation.json").read_text()))

    def test_a_run_names_arrays_by_a_file_that_is_gone(self):
        run = self.track("run", self.pair)
        self.assertEqual((run.summary["tracks"].rsplit("/")[-1], run.summary["tracks"] in
                          (run.folder / "config.yaml").read_text()), ("given_arrays.npz", True))

    def test_there_is_one_source_of_tracks_and_of_depth(self):
        file = str(self.folder / "exported" / "tracks.npz")
        for options, arguments, message in (
                ({"TrackFile.path": file}, {"tracks": self.pair}, "the argument tracks, and the option TrackFile.path is"),
                ({"TrackFile.path": file}, {"tracks": "other.npz"}, "the option TrackFile.path is"),
                ({"DepthPrior.path": "a"}, {"depth_prior": "b"}, "the option DepthPrior.path is 'a'; give one of them")):
            with self.subTest(message), self.assertRaises(ValueError) as caught:
                pliant.track(SEQUENCE, self.folder / "refused", options, **arguments)
            self.assertIn(message, sentence(self, caught.exception))
        with self.assertRaisesRegex(pliant.Error, "one frame is not enough"):
            pliant.track(SEQUENCE, self.folder / "same", {"TrackFile.path": file}, tracks=file, end=1)

    def test_other_arrays_of_a_file_are_passed_over_however_it_is_given(self):
        file = self.folder / "more.npz"
        np.savez(file, queries=np.zeros(3), **self.arrays)
        with np.load(file) as arrays:
            scored = pliant.evaluate(None, SEQUENCE, tracks=arrays)["tracks"]
        self.assertEqual(scored, pliant.evaluate(None, SEQUENCE, tracks=file)["tracks"])

    def test_what_does_not_fit_is_refused_in_one_sentence(self):
        tracks, seen = self.pair
        turned = np.ascontiguousarray(tracks.transpose(1, 0, 2))  # (points, frames, 2)
        for kind, message, given in (
                (pliant.Error, "it has to be (frames, points)", (turned, seen)),
                (pliant.Error, "(points, frames, 2) is to be transposed", (turned, np.ascontiguousarray(seen.T))),
                (pliant.Error, "frames and the images", (tracks[1:], seen[1:])),
                (pliant.Error, "it has to be (frames, points, 2) with x before y", (tracks[0], seen[0])),
                (pliant.Error, "has the value 0.75, which is neither 0 nor 1; save bools, for example visibility > 0.5",
                 (tracks, np.where(seen, 0.75, 0))),
                (pliant.Error, "has the value -1, which is neither 0 nor 1; save bools, for example visibility > 0.5",
                 (np.nan_to_num(tracks), np.where(seen, 1, -1))),
                (pliant.Error, "no pixel of the given tracks is in the image with a sigma_px of",
                 {"tracks": tracks, "visibility": seen, "sigma_px": np.full(seen.shape, 9.0)}),
                (ValueError, "the array 'tracks' has masked entries",
                 (np.ma.array(tracks, mask=np.repeat(~seen[..., None], 2, 2)), seen)),
                (ValueError, "the tracks have the arrays points, occluded; name them",
                 {"points": tracks, "occluded": ~seen}),
                (ValueError, "tracks is a tuple of 3; give a pair", (tracks, seen, seen)),
                (pliant.Error, "the given arrays have 59 frames and the images 60", (tracks[1:], seen[1:])),
                (pliant.Error, "the given tracks have the shape", (tracks[0], seen[0])),
                (pliant.Error, "of the given arrays is not a finite number", (np.nan * tracks, seen)),
                (pliant.Error, "have no point that is seen in a frame: tracks has the shape (60, 0, 2)",
                 (tracks[:, :0], seen[:, :0])),
                (pliant.Error, "have no point that is seen in a frame: all of visibility is False", (tracks, 0 * seen)),
                (ValueError, "an array 'sigma', which is not known; the names are tracks, visibility, sigma_px, track_id",
                 {"tracks": tracks, "visibility": seen, "sigma": seen}),
                (TypeError, "the array 'visibility' is a NoneType, not of real numbers", (tracks, None)),
                (TypeError, "the array 'tracks' is a list, not of real numbers", ([[1, 2], [1]], seen)),
                (TypeError, "the array 'tracks' is of complex64, not of real numbers", (tracks + 0j, seen))):
            with self.subTest(message), self.assertRaises(kind) as caught:
                self.track("refused", given)
            self.assertIn(message, sentence(self, caught.exception))
            self.assertNotIn(str(self.temporary), str(caught.exception))
            self.assertFalse((self.folder / "refused").exists())
            self.assertEqual(list(self.temporary.iterdir()), [])
        with self.assertRaisesRegex(TypeError, "tracks is a ndarray; give the path of a file, or arrays as a pair"):
            pliant.evaluate(None, SEQUENCE, tracks=tracks)
        with self.assertRaises(pliant.Error) as error:
            pliant.evaluate(None, SEQUENCE, tracks=(tracks[0], seen[0]))
        self.assertEqual(error.exception.code, "unreadable")
        self.assertNotIn(str(self.temporary), sentence(self, error.exception))
        with self.assertRaisesRegex(ValueError, "a run with arrays of tracks cannot be resumed"):
            self.track("refused", self.pair, resume=True)
        with self.assertRaisesRegex(ValueError, "give them to pliant.track"):
            pliant.Tracker(pliant.read_camera(SEQUENCE / "camera.yaml"), tracks=self.pair)
        with self.assertRaisesRegex(TypeError, "tracks_pixel_origin is a int; give text"):
            self.track("refused", self.pair, tracks_pixel_origin=0)


if __name__ == "__main__":
    unittest.main()
