# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""First maps and point tracks from Python: what they give is used as ours is, and what cannot be meant is refused."""

import gc
import json
import unittest
import weakref

import numpy as np

import pliant
from support import RUN, SEQUENCE, TestCase, images, sentence

FRAMES = 40
FIXED = {"General.timings": "none", "Image.working": "fixed"}
MAX_DEPTH_ERROR = 0.05  # median; one constant depth has above 0.1
LEAST_POINTS = 60


def two_views(frames, camera, is_last):
    """The map of the reference and the frame 12 frames later, out of the kernels."""
    if len(frames) < 13:
        return pliant.Wait(f"{len(frames)} of 13 frames")
    first, last = frames[0], frames[-1]
    point_id, in_first, in_last = np.intersect1d(first.point_id, last.point_id, return_indices=True)
    rays0, rays1 = camera.unproject(first.pixel[in_first]), camera.unproject(last.pixel[in_last])
    motion, inliers = pliant.kernels.relative_pose(rays0, rays1, camera.params[0])
    points, there = pliant.kernels.triangulate(motion, rays0, rays1)
    good = inliers & there
    poses = np.full((len(frames), 4, 4), np.nan)  # those between are estimated
    poses[0], poses[-1] = np.eye(4), motion
    return pliant.FirstMap(point_id[good], points[good], poses, reason="two views")


class RecordedTracks:
    """Follows points as a run has them: by the observation nearest to a pixel."""

    def __init__(self, run):
        self.seen = run.observations
        self.calls = 0

    def follow(self, previous, image, pixel, predicted):
        self.calls += 1
        assert image.gray.ndim == 2 and image.gray.dtype == np.uint8 and predicted.shape == pixel.shape
        before, now = (self.seen.frame_idx == frame.frame_idx for frame in (previous, image))
        found, visible = np.zeros_like(pixel), np.zeros(len(pixel), bool)
        pixels, ids = self.seen.pixel[before], self.seen.point_id[before]
        at = dict(zip(self.seen.point_id[now].tolist(), self.seen.pixel[now]))
        for k, point in enumerate(pixel):
            nearest = np.argmin(np.linalg.norm(pixels - point, axis=1)) if len(pixels) else None
            if nearest is None or np.linalg.norm(pixels[nearest] - point) > 1.0 or ids[nearest] not in at:
                continue
            found[k], visible[k] = at[ids[nearest]], True
        return found, visible


class Initializers(TestCase):
    def track(self, initializer, name="run", **arguments):
        return pliant.track(SEQUENCE, self.folder / name, FIXED, end=FRAMES, initializer=initializer, **arguments)

    def test_a_map_out_of_the_kernels_is_right(self):
        run = self.track(two_views)
        self.assertEqual(len(run.poses), FRAMES)
        self.assertEqual(run.summary["extensions"], ["initializer python"])
        self.assertEqual(run.summary["first_map"]["declared_frame"], 12)
        evaluation = pliant.evaluate(run, SEQUENCE)
        self.assertLess(evaluation["surface"]["estimate"]["median_relative_depth"], MAX_DEPTH_ERROR)
        self.assertGreater(len(run.frame(FRAMES - 1).point_id), LEAST_POINTS)

    def test_it_is_chosen_by_its_name(self):
        pliant.register_initializer("kernels", two_views)
        run = pliant.track(SEQUENCE, self.folder / "named", {**FIXED, "Init.method": "kernels"}, end=FRAMES)
        self.assertEqual(run.summary["extensions"], ["initializer kernels"])
        given = self.track(two_views)
        np.testing.assert_array_equal(run.observations.position, given.observations.position)
        with self.assertRaisesRegex(ValueError, "another one"):
            pliant.track(SEQUENCE, self.folder / "both", {"Init.method": "kernels"}, initializer=two_views)
        with self.assertRaisesRegex(ValueError, "a method of Pliant"):
            pliant.register_initializer("window", two_views)
        with self.assertRaisesRegex(ValueError, "Init.method is 'no_such'; give one of window | .*registered: kernels"):
            pliant.track(SEQUENCE, self.folder / "unknown", {"Init.method": "no_such"})
        again = self.track("kernels", "by_argument")
        self.assertEqual(again.summary["extensions"], ["initializer kernels"])
        np.testing.assert_array_equal(again.observations.position, given.observations.position)

    def test_it_may_wait_and_take_another_reference(self):
        asked = []

        def never(frames, camera, is_last):
            asked.append((frames[0].frame_idx, len(frames), is_last))
            return pliant.NewReference("not this one") if len(frames) == 5 else None

        with self.assertRaises(pliant.Error):
            self.track(never)
        self.assertIn((0, 5, False), asked)
        self.assertIn((4, 2, False), asked)
        self.assertTrue(asked[-1][2])

    def test_what_it_returns_is_checked(self):
        good = {}

        def spoiled(**changes):
            def answer(frames, camera, is_last):
                result = two_views(frames, camera, is_last)
                if isinstance(result, pliant.FirstMap):
                    good.update(ids=np.asarray(result.point_id))
                    for name, change in changes.items():
                        setattr(result, name, change(getattr(result, name)))
                return result
            return answer

        cases = [
            ({"position": lambda p: p[:, :2]}, "position of a map is an array"),
            ({"position": lambda p: p[:-1]}, "position of a map has"),
            ({"position": lambda p: p * np.nan}, "finite numbers"),
            ({"sigma": lambda _: [1.0]}, "sigma of a map has 1"),
            ({"point_id": lambda i: np.concatenate([i[:1], i[:1], i[2:]])}, "twice"),
            ({"point_id": lambda i: np.concatenate([i[:-1], [10 ** 6]])}, "in none of the frames"),
            ({"cam_from_world": lambda c: c[1:]}, "12 poses, and there are 13 frames"),
            ({"cam_from_world": lambda c: 2 * c}, "no rigid motion"),
            ({"cam_from_world": lambda c: np.full_like(c, np.nan)}, "have to be known"),
            ({"cam_from_world": lambda c: c[::-1]}, "identity"),
        ]
        for number, (changes, message) in enumerate(cases):
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                self.track(spoiled(**changes), f"case{number}")
        with self.assertRaisesRegex(TypeError, "whole numbers"):
            self.track(spoiled(point_id=lambda i: i + 0.5), "halves")
        with self.assertRaisesRegex(TypeError, "FirstMap"):
            self.track(lambda frames, camera, is_last: 5, "five")

    def test_an_exception_in_it_ends_the_run_and_is_raised(self):
        def broken(frames, camera, is_last):
            raise RuntimeError("broken on purpose")

        with self.assertRaisesRegex(RuntimeError, "on purpose"):
            self.track(broken)
        self.assertNotEqual(json.loads((self.folder / "run" / "run.json").read_text())["status"], "completed")


class Tracks(TestCase):
    def test_points_are_followed_by_an_object(self):
        tracks = RecordedTracks(pliant.open_run(RUN))
        run = pliant.track(SEQUENCE, self.folder / "run", FIXED, end=FRAMES, tracks=tracks)
        self.assertEqual(len(run.poses), FRAMES)
        self.assertGreaterEqual(tracks.calls, FRAMES - 1)
        self.assertEqual(run.summary["extensions"], ["tracks"])
        self.assertGreater(len(run.frame(FRAMES - 1).point_id), LEAST_POINTS)
        self.assertLess(pliant.evaluate(run, SEQUENCE)["surface"]["estimate"]["median_relative_depth"], MAX_DEPTH_ERROR)

    def test_they_are_chosen_by_their_name(self):
        made = []

        def make():
            made.append(RecordedTracks(pliant.open_run(RUN)))
            return made[-1]

        pliant.register_tracks("recorded", make)
        runs = [pliant.track(SEQUENCE, self.folder / f"run{k}", FIXED, end=FRAMES, tracks="recorded") for k in range(2)]
        self.assertEqual(len(made), len(runs))
        for run, tracks in zip(runs, made):
            self.assertGreaterEqual(tracks.calls, FRAMES - 1)
            self.assertEqual(run.summary["extensions"], ["tracks"])
        with self.assertRaisesRegex(ValueError, "no tracks of that name .registered: .*recorded"):
            pliant.track(SEQUENCE, self.folder / "run", FIXED, tracks="recoded")
        pliant.Tracker(pliant.read_camera(SEQUENCE / "camera.yaml"), FIXED, tracks="recorded")
        self.assertEqual(len(made), len(runs) + 1)

    def test_a_path_is_a_file_of_tracks(self):
        pliant.export(RUN, self.folder / "tracks", "tracks_csv", sequence=SEQUENCE)
        file = self.folder / "tracks" / "tracks.csv"
        run = pliant.track(SEQUENCE, self.folder / "run", FIXED, end=FRAMES, tracks=file)
        self.assertEqual(run.summary["tracks"], str(file))

    def test_what_it_returns_is_checked(self):
        class Wrong:
            def __init__(self, answer):
                self.answer = answer

            def follow(self, previous, image, pixel, predicted):
                return self.answer(pixel)

        for answer, message in [(lambda p: (p[1:], np.ones(len(p), bool)), "as many"),
                                (lambda p: (p, np.ones(len(p) - 1, bool)), "as many"),
                                (lambda p: (p[:, 0], np.ones(len(p), bool)), "the pixels that follow returns"),
                                (lambda p: (p * np.nan, np.ones(len(p), bool)), "not a number")]:
            with self.subTest(message), self.assertRaisesRegex(ValueError, message):
                pliant.track(SEQUENCE, self.folder / "run", FIXED, end=FRAMES, tracks=Wrong(answer))
        for answer, message in [(lambda p: None, "this one returned NoneType"),
                                (lambda p: (p, p, p), "this one returned tuple of 3"),
                                (lambda p: (p, np.full(len(p), 5.0)), "these are float64. Of scores say"),
                                (lambda p: (p, np.full(len(p), -1)), "these are int64")]:
            with self.subTest(message), self.assertRaisesRegex(TypeError, message):
                pliant.track(SEQUENCE, self.folder / "run", FIXED, end=FRAMES, tracks=Wrong(answer))
        with self.assertRaisesRegex(ValueError, "TrackFile.path names a file of others"):
            pliant.track(SEQUENCE, self.folder / "both", {"TrackFile.path": "a.npz"}, tracks=Wrong(None))
        with self.assertRaisesRegex(TypeError, "arrays as a pair"):
            pliant.track(SEQUENCE, self.folder / "arrays", tracks=np.zeros((FRAMES, 5, 2)))


class InMemory(TestCase):
    """pliant.Tracker takes the same parts."""

    camera = pliant.read_camera(SEQUENCE / "camera.yaml")
    options = {**FIXED, "General.max_frames_back": 0}

    def process(self, count=FRAMES, **extensions):
        tracker = pliant.Tracker(self.camera, self.options, **extensions)
        reports = []
        for image in images(count):
            reports += tracker.process(image)
        return reports + tracker.finish()

    def same(self, reports, run):
        self.assertEqual([report.state for report in reports], list(run.frames.state))
        position = np.concatenate([report.observations.position for report in reports])
        self.assertGreater(len(position), FRAMES * LEAST_POINTS)
        np.testing.assert_allclose(position, run.observations.position, atol=1e-5)

    def test_a_tracker_reports_what_a_run_has_with_an_initializer_of_the_program(self):
        run = pliant.track(SEQUENCE, self.folder / "run", self.options, end=FRAMES, initializer=two_views)
        self.same(self.process(initializer=two_views), run)
        pliant.register_initializer("in_memory", two_views)
        self.options = {**self.options, "Init.method": "in_memory"}
        self.same(self.process(), run)

    def test_a_tracker_reports_what_a_run_has_with_tracks_of_the_program(self):
        recorded = pliant.open_run(RUN)
        run = pliant.track(SEQUENCE, self.folder / "run", self.options, end=FRAMES, tracks=RecordedTracks(recorded))
        tracks = RecordedTracks(recorded)
        self.same(self.process(tracks=tracks), run)
        self.assertGreaterEqual(tracks.calls, FRAMES - 1)

    def test_an_exception_in_it_is_raised_and_finishes_the_tracker(self):
        def broken(frames, camera, is_last):
            raise LookupError("broken on purpose")

        tracker = pliant.Tracker(self.camera, self.options, initializer=broken)
        with self.assertRaisesRegex(LookupError, "on purpose"):
            for image in images(5):
                tracker.process(image)
        with self.assertRaisesRegex(ValueError, "the tracker is finished"):
            tracker.process(images(1)[0])
        self.assertEqual(tracker.finish(), [])

    def test_an_object_that_holds_its_tracker_is_freed(self):
        class Program:
            def __init__(self, camera, options):
                self.tracker = pliant.Tracker(camera, options, initializer=self.first_map)

            def first_map(self, frames, camera, is_last):
                return None

        program = Program(self.camera, self.options)
        for image in images(3):
            program.tracker.process(image)
        freed = weakref.ref(program)
        del program
        gc.collect()
        self.assertIsNone(freed())

    def test_a_file_of_tracks_is_refused(self):
        with self.assertRaises(ValueError) as raised:
            pliant.Tracker(self.camera, tracks=self.folder / "tracks.npz")
        self.assertIn("pliant.track", sentence(self, raised.exception))


class Names(TestCase):
    def test_what_cannot_be_called_is_no_initializer(self):
        with self.assertRaises(TypeError) as raised:
            pliant.register_initializer("five", 5)
        self.assertIn("cannot be called", sentence(self, raised.exception))

    def test_what_cannot_follow_is_no_source_of_tracks(self):
        with self.assertRaises(TypeError) as raised:
            pliant.track(SEQUENCE, self.folder / "run", tracks=5)
        self.assertIn("follow", sentence(self, raised.exception))
        with self.assertRaises(TypeError) as raised:
            pliant.register_tracks("object", object())
        self.assertIn("cannot be made", sentence(self, raised.exception))
        pliant.register_tracks("nothing", lambda: None)
        with self.assertRaises(TypeError) as raised:
            pliant.track(SEQUENCE, self.folder / "run", tracks="nothing")
        self.assertIn("made a NoneType", sentence(self, raised.exception))


if __name__ == "__main__":
    unittest.main()
