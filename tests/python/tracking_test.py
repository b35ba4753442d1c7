# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracking of images that Python has equals tracking of their folder, and images that are none are refused."""

import shutil
import threading
import unittest

import numpy as np

import pliant
from support import SEQUENCE, TestCase, images, sentence

COUNT = 25  # frames; the first map takes about fifteen
FIXED = {"General.timings": "none", "Image.working": "fixed"}
FILES = ("config.yaml", "trajectory.txt", "frames.csv", "observations.csv", "map.ply", "sparse/points3D.bin")


class Images(TestCase):
    images = images(COUNT)
    camera = pliant.read_camera(SEQUENCE / "camera.yaml")
    timestamps = [float(line) for line in (SEQUENCE / "times.txt").read_text().split()[:COUNT]]

    def same_files(self, run, other):
        for name in FILES:
            self.assertEqual((run.folder / name).read_bytes(), (other.folder / name).read_bytes(), name)

    def test_images_give_the_files_of_their_folder(self):
        options = {"General.timings": "none"}
        folder = pliant.track(SEQUENCE, self.folder / "folder", options, end=COUNT)
        self.assertGreater(len(folder.poses), 15)
        listed = pliant.track(self.images, self.folder / "list", options, camera=self.camera,
                              timestamps=self.timestamps)
        self.same_files(listed, folder)
        iterated = pliant.track((image for image in self.images), self.folder / "iterated", options, camera=self.camera)
        np.testing.assert_array_equal(iterated.observations.position, folder.observations.position)

    def test_images_that_come_one_by_one_may_have_times(self):
        asked, buffer = [], np.empty_like(self.images[0])
        times = 10 + np.cumsum(np.linspace(0.03, 0.06, COUNT))

        def camera():
            for idx, image in enumerate(self.images):
                asked.append(idx)
                buffer[:] = image  # the same memory again
                yield buffer

        listed = pliant.track(self.images, self.folder / "list", FIXED, camera=self.camera, timestamps=times)
        iterated = pliant.track(camera(), self.folder / "iterated", FIXED, camera=self.camera, timestamps=times)
        self.same_files(iterated, listed)
        np.testing.assert_allclose(iterated.frames.timestamp, times, atol=1e-6)
        self.assertEqual(asked, list(range(COUNT)))

    def test_images_that_come_one_by_one_are_as_many_as_their_times(self):
        reported = []
        options = {**FIXED, "General.threads": 1, "General.max_frames_back": 0, "Image.interlaced": "off"}
        for count, tracked, words in (
                (COUNT + 1, COUNT, f"there are {COUNT + 1} timestamps for {COUNT} images; each image needs one"),
                (COUNT - 1, COUNT - 2, f"there are {COUNT - 1} timestamps, and more images; each image needs one")):
            with self.assertRaises(ValueError) as caught:
                pliant.track((image for image in self.images), self.folder / "run", options, camera=self.camera,
                             timestamps=np.arange(count) / 30,
                             on_frame=lambda report: reported.append(report.frame_idx))
            self.assertEqual(sentence(self, caught.exception), words)
            self.assertEqual(reported, list(range(tracked)), "the images before are tracked")
            reported.clear()
        run = pliant.track((image for image in self.images), self.folder / "run", FIXED, camera=self.camera, end=20,
                           timestamps=np.arange(40) / 30)  # a part, whose images have their times
        self.assertEqual(len(run.frames), 20)

    def test_times_grow(self):
        for timestamps in ([0.1] * COUNT, [np.nan] + self.timestamps[1:]):
            with self.assertRaisesRegex(ValueError, "the timestamps are not finite, or not growing, at"):
                pliant.track(self.images, self.folder / "run", FIXED, camera=self.camera, timestamps=timestamps)
            self.assertFalse((self.folder / "run" / "frames.csv").exists())

    def test_no_image_is_asked_for_before_it_is_wanted(self):
        asked = []

        def camera():
            for idx, image in enumerate(self.images):
                asked.append(idx)
                yield image
            raise RuntimeError("unplugged")

        reported = []
        options = {**FIXED, "General.threads": 1, "General.max_frames_back": 0, "Image.interlaced": "off"}
        with self.assertRaisesRegex(RuntimeError, "unplugged"):
            pliant.track(camera(), self.folder / "run", options, camera=self.camera,
                         on_frame=lambda report: reported.append(report.frame_idx))
        self.assertEqual(reported, list(range(COUNT)), "the images before are tracked")

    def test_a_part_of_the_images_is_tracked_with_their_numbers(self):
        seen = []
        run = pliant.track(self.images, self.folder / "run", FIXED, camera=self.camera, start=2, stride=2,
                           on_frame=lambda report: seen.append(report.frame_idx))
        self.assertEqual(list(run.frames.frame_idx), list(range(2, COUNT, 2)))
        self.assertEqual(seen, list(range(2, COUNT, 2)))

    def test_a_report_is_what_the_run_has_of_its_frame(self):
        reports = []
        run = pliant.track(self.images, self.folder / "run", FIXED, camera=self.camera, on_frame=reports.append)
        self.assertEqual([report.state for report in reports], list(run.frames.state))
        for report in reports:
            row = run.frame(report.frame_idx)
            np.testing.assert_array_equal(report.observations.point_id, row.point_id)
            np.testing.assert_allclose(report.observations.position, row.position, atol=1e-5)  # the file's digits
            np.testing.assert_allclose(report.observations.pixel, row.pixel, atol=1e-3)
        posed = [report for report in reports if report.cam_from_world is not None]
        np.testing.assert_allclose([report.world_from_cam for report in posed], run.poses.world_from_cam, atol=1e-5)
        self.assertEqual(posed[-1].name, f"{COUNT - 1:06d}.png")
        self.assertEqual(set(posed[-1].costs), set(run.frames.costs))

    def test_a_depth_prior_starts_a_map_in_one_image(self):
        options = {"Init.method": "depth_prior", "DepthPrior.kind": "depth", **FIXED}
        run = pliant.track(SEQUENCE, self.folder / "run", options, depth_prior=SEQUENCE / "depth", end=3)
        self.assertEqual(set(run.frames.state), {"provisional"})
        self.assertEqual(run.summary["depth_prior"], str((SEQUENCE / "depth").resolve()))
        tracker = pliant.Tracker(self.camera, options)
        prior = np.full(self.images[0].shape[:2], 3.0)
        reports = tracker.process(self.images[0], depth_prior=prior)
        self.assertEqual([report.state for report in reports], ["provisional"])
        with self.assertRaisesRegex(TypeError, "the depth prior is a NumPy array of dtype float32"):
            tracker.process(self.images[1], depth_prior=prior.astype(np.uint8))
        with self.assertRaisesRegex(ValueError, "shape"):
            tracker.process(self.images[1], depth_prior=np.ones((2, 3, 4), np.float32))

    def test_an_exception_in_a_callback_ends_the_run_and_is_raised(self):
        def stop(report):
            if report.frame_idx == 20:
                raise LookupError("enough")
        with self.assertRaisesRegex(LookupError, "enough"):
            pliant.track(self.images, self.folder / "run", camera=self.camera, on_frame=stop)
        run = pliant.open_run(self.folder / "run")
        self.assertEqual(run.summary["status"], "interrupted")
        self.assertLess(len(run.frames), COUNT)
        self.assertGreater(len(run.frames), 20)

    def test_a_run_that_was_stopped_is_resumed(self):
        def stop(report):
            if report.frame_idx == 18:
                raise LookupError("enough")
        options = {**FIXED, "General.checkpoint_frames": 5}
        whole = pliant.track(SEQUENCE, self.folder / "whole", options, end=COUNT)
        with self.assertRaises(LookupError):
            pliant.track(SEQUENCE, self.folder / "run", options, end=COUNT, on_frame=stop)
        seen = []
        run = pliant.track(SEQUENCE, self.folder / "run", options, end=COUNT, resume=True,
                           on_frame=lambda report: seen.append(report.frame_idx))
        self.assertGreater(seen[0], 10)
        self.same_files(run, whole)
        with self.assertRaisesRegex(ValueError, "cannot be resumed; give a path"):
            pliant.track(self.images, self.folder / "run", options, camera=self.camera, resume=True)

    def test_an_exception_in_a_generator_is_raised(self):
        def broken():
            yield from self.images[:5]
            raise OSError("the camera was unplugged")
        with self.assertRaisesRegex(OSError, "unplugged"):
            pliant.track(broken(), self.folder / "run", camera=self.camera)

    def test_images_that_are_none_are_refused_in_one_sentence(self):
        good = self.images[0]
        for bad, kind, words in (
                (good.astype(np.float64), TypeError, "this one is float64 of shape (480, 640, 3)"),
                (good.astype(np.int16), TypeError, "this one is int16"),
                (np.full((480, 640), np.nan), TypeError, "this one is float64"),
                (good[:, :, :2], ValueError, "of shape (480, 640, 2)"),
                (good[None], ValueError, "of shape (1, 480, 640, 3)"),
                (good[:0], ValueError, "of shape (0, 640, 3)"),
                ([[0]], TypeError, "not list")):
            with self.assertRaises(kind) as caught:
                pliant.track([good, bad], self.folder / "run", camera=self.camera)
            text = sentence(self, caught.exception)
            self.assertIn("image 1 is a NumPy array of dtype uint8 and shape (height, width)", text)
            self.assertIn(words, text)

    def test_images_of_another_size_are_an_error(self):
        with self.assertRaises(pliant.Error) as caught:
            pliant.track([image[:240] for image in self.images], self.folder / "run", camera=self.camera)
        self.assertEqual(caught.exception.code, "mismatch")
        self.assertIn("is for images of 640x480, but image 0 is 640x240", sentence(self, caught.exception))

    def test_what_goes_wrong_on_the_way_has_the_code_that_it_has_at_the_beginning(self):
        for given in (list, iter):
            for before in (0, 6):
                wrong = [*self.images[:before], self.images[6][:240], self.images[7]]
                with self.subTest(before=before), self.assertRaises(pliant.Error) as caught:
                    pliant.track(given(wrong), self.folder / "run", FIXED, camera=self.camera)
                self.assertEqual(caught.exception.code, "mismatch")
                self.assertIn(f"image {before} is 640x240", sentence(self, caught.exception))
        depth = self.folder / "depth"
        shutil.copytree(SEQUENCE / "depth", depth)
        sorted(depth.iterdir())[6].write_bytes(b"no image")
        options = {"Init.method": "depth_prior", "DepthPrior.kind": "depth", **FIXED}
        with self.assertRaises(pliant.Error) as caught:
            pliant.track(SEQUENCE, self.folder / "run", options, depth_prior=depth, end=10)
        self.assertEqual(caught.exception.code, "unreadable")
        self.assertIn("6 tracked frames are in", sentence(self, caught.exception))

    def test_what_does_not_go_together_is_a_value_error(self):
        for arguments, words in (
                (dict(input=self.images), "images need their camera"),
                (dict(input=[], camera=self.camera), "there are no images"),
                (dict(input=SEQUENCE, camera=self.camera), "give the path of its calibration"),
                (dict(input=SEQUENCE, timestamps=[0.0]), "timestamps are for images that are given")):
            with self.assertRaises(ValueError) as caught:
                pliant.track(output_path=self.folder / "run", **arguments)
            self.assertIn(words, sentence(self, caught.exception))
        with self.assertRaises(TypeError):
            pliant.track(7, self.folder / "run", camera=self.camera)
        with self.assertRaises(ValueError) as caught:
            pliant.track(self.images, self.folder / "run", camera=self.camera, timestamps=[0.0, 1.0])
        self.assertIn("there are 2 timestamps for 25 images", sentence(self, caught.exception))
        with self.assertRaisesRegex(TypeError, "timestamps is a generator; give a list of numbers"):
            pliant.track(self.images, self.folder / "run", camera=self.camera, timestamps=(t for t in self.timestamps))

    def test_images_that_come_one_by_one_may_have_tracks_of_a_file(self):
        tracks = self.folder / "tracks.npz"
        pixels = np.random.default_rng(1).uniform(50, 400, (COUNT, 300, 2))
        np.savez(tracks, tracks=pixels, visibility=np.ones((300, COUNT), bool).T)  # stored columns first
        for name, given in (("one_by_one", (image for image in self.images)), ("list", self.images)):
            with self.assertRaises(pliant.Error) as caught:  # of random tracks there is no map
                pliant.track(given, self.folder / name, FIXED, camera=self.camera, tracks=tracks)
            self.assertEqual(caught.exception.code, "insufficient")

    def test_other_threads_run_meanwhile(self):
        count, done = 0, threading.Event()

        def work():
            nonlocal count
            while not done.is_set():
                count += 1
                done.wait(0.001)
        thread = threading.Thread(target=work)
        thread.start()
        before = count
        pliant.track(SEQUENCE, self.folder / "run", end=COUNT)
        during = count - before
        done.set()
        thread.join()
        self.assertGreater(during, 20)

    def test_tracking_in_another_thread_gives_the_same(self):
        runs = []
        thread = threading.Thread(target=lambda: runs.append(
            pliant.track(self.images, self.folder / "thread", FIXED, camera=self.camera)))
        thread.start()
        thread.join()
        self.same_files(runs[0], pliant.track(self.images, self.folder / "main", FIXED, camera=self.camera))


class InMemory(TestCase):
    images = Images.images
    camera = Images.camera

    def track(self, tracker, frames=None, **arguments):
        reports = []
        for image in self.images if frames is None else frames:
            reports += tracker.process(image, **arguments)
        return reports + tracker.finish()

    def test_a_tracker_reports_what_a_run_has(self):
        options = {**FIXED, "General.max_frames_back": 0}
        run = pliant.track(self.images, self.folder / "run", options, camera=self.camera)
        tracker = pliant.Tracker(self.camera, options)
        reports = self.track(tracker)
        self.assertEqual([report.frame_idx for report in reports], list(range(COUNT)))
        self.assertEqual([report.state for report in reports], list(run.frames.state))
        self.assertEqual(tracker.state, reports[-1].state)
        posed = [report for report in reports if report.cam_from_world is not None]
        self.assertGreater(len(posed), 15)
        np.testing.assert_allclose([report.world_from_cam for report in posed], run.poses.world_from_cam, atol=1e-5)
        position = np.concatenate([report.observations.position for report in reports])
        np.testing.assert_allclose(position, run.observations.position, atol=1e-5)

    def test_reports_are_held_back_until_there_is_a_map(self):
        tracker = pliant.Tracker(self.camera, FIXED)
        self.assertEqual(tracker.process(self.images[0]), [])
        self.assertEqual((tracker.held, tracker.state), (1, "initializing"))
        self.assertEqual([report.frame_idx for report in tracker.finish()], [0])
        with self.assertRaisesRegex(ValueError, "the tracker is finished"):
            tracker.process(self.images[0])

    def test_examples_choose_the_image_as_a_run_does(self):
        noise = np.random.default_rng(1)
        noisy = [np.clip(image + noise.normal(0, 12, image.shape), 0, 255).astype(np.uint8) for image in self.images]
        options = {"General.timings": "none", "General.max_frames_back": 0}
        run = pliant.track(noisy, self.folder / "run", options, camera=self.camera)
        tracker = pliant.Tracker(self.camera, options, examples=noisy[:16])
        self.assertEqual(tracker.working_scale, run.summary["working_image"]["scale"])
        reports = self.track(tracker, noisy)
        np.testing.assert_allclose(np.concatenate([report.observations.pixel for report in reports]),
                                   run.observations.pixel, atol=1e-3)

    def test_any_layout_gray_images_and_masks_are_taken(self):
        gray = [np.ascontiguousarray(image[:, :, 1]) for image in self.images]
        mask = np.zeros((480, 640), bool)
        mask[:, 320:] = True
        reports = self.track(pliant.Tracker(self.camera, FIXED), gray, mask=mask)
        strided = [np.asfortranarray(image) for image in gray]
        others = self.track(pliant.Tracker(self.camera, FIXED), strided, mask=(mask * 7).astype(np.uint8))
        pixels = np.concatenate([report.observations.pixel for report in reports])
        self.assertGreater(len(pixels), 100)
        self.assertGreater(pixels[:, 0].min(), 315)  # of a point that has moved since it was placed
        np.testing.assert_array_equal(pixels, np.concatenate([report.observations.pixel for report in others]))

    def test_an_image_may_be_written_to_again(self):
        expected = self.track(pliant.Tracker(self.camera, FIXED))
        tracker, buffer, reports = pliant.Tracker(self.camera, FIXED), np.empty_like(self.images[0]), []
        for image in self.images:
            buffer[:] = image
            reports += tracker.process(buffer)
            buffer[:] = 0
        reports += tracker.finish()
        np.testing.assert_array_equal(reports[-1].observations.position, expected[-1].observations.position)

    def test_wrong_images_masks_and_times_are_refused_and_passed_over(self):
        tracker = pliant.Tracker(self.camera, FIXED)
        image = self.images[0]
        with self.assertRaises(pliant.Error) as caught:
            tracker.process(image[:100])
        self.assertEqual(caught.exception.code, "mismatch")
        self.assertIn("640x100 pixels, and the camera 640x480", sentence(self, caught.exception))
        for arguments, kind in ((dict(mask=np.zeros((480, 640))), TypeError), (dict(mask=image), ValueError),
                                (dict(timestamp=float("nan")), ValueError)):
            with self.assertRaises(kind) as caught:
                tracker.process(image, **arguments)
            sentence(self, caught.exception)
        with self.assertRaises(TypeError):
            tracker.process(image.astype(np.float32))
        tracker.process(image)
        self.assertEqual([report.frame_idx for report in tracker.finish()], [0])

    def test_a_start_that_needs_more_than_images_is_a_value_error(self):
        for options in ({"Init.method": "depth"}, {"Init.method": "stereo"}, {"Oracle.poses": True},
                        {"TrackFile.path": "tracks.npz"}):
            with self.assertRaises(ValueError) as caught:
                pliant.Tracker(self.camera, options)
            sentence(self, caught.exception)


if __name__ == "__main__":
    unittest.main()
