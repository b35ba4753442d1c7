# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Errors are exceptions with the sentence of the command line; options have its names and its checks."""

import os
import pathlib
import pickle
import unittest

import numpy as np

import pliant
from support import RUN, SEQUENCE, TestCase, sentence


class Errors(TestCase):
    def test_what_could_not_be_done_is_an_error_with_a_code(self):
        with self.assertRaises(pliant.Error) as caught:
            pliant.open_run(self.folder / "nowhere")
        self.assertEqual(caught.exception.code, "not_found")
        self.assertIn("there is no run folder", sentence(self, caught.exception))
        self.assertIsInstance(caught.exception, RuntimeError)

    def test_images_that_are_not_there_are_an_error_with_their_path(self):
        with self.assertRaises(pliant.Error) as caught:
            pliant.track(self.folder / "nowhere", self.folder / "run")
        self.assertEqual(caught.exception.code, "not_found")
        self.assertIn(str(self.folder / "nowhere"), sentence(self, caught.exception))

    def test_a_start_outside_of_the_sequence_is_a_value_error(self):
        with self.assertRaises(ValueError) as caught:
            pliant.track(SEQUENCE, self.folder / "run", start=1000)
        self.assertIn("start is 1000", sentence(self, caught.exception))

    def test_a_run_without_a_map_is_an_error_and_leaves_its_folder(self):
        with self.assertRaises(pliant.Error) as caught:
            pliant.track(SEQUENCE, self.folder / "run", end=1)
        self.assertEqual(caught.exception.code, "insufficient")
        self.assertIn("one frame is not enough for a map", str(caught.exception))
        self.assertEqual(pliant.open_run(self.folder / "run").summary["status"], "failed")


class Unmade(TestCase):
    """An object that __new__ alone made holds nothing, and no function takes it."""

    def test_objects_say_so(self):
        from pliant import _pliant
        camera = pliant.Camera.__new__(pliant.Camera)
        report = pliant.FrameReport.__new__(pliant.FrameReport)
        tracker, source, reader = (kind.__new__(kind) for kind in (pliant.Tracker, _pliant.SequenceSource,
                                                                   _pliant.FrameReader))
        made = pliant.Camera("PINHOLE", 640, 480, [400, 400, 320, 240])
        for call in (lambda: camera.params, lambda: camera.fps, lambda: camera.project(np.zeros((1, 3))),
                     lambda: repr(camera), lambda: hash(camera), lambda: made == camera, lambda: pickle.dumps(camera),
                     lambda: camera.write(self.folder / "camera.yaml"), lambda: report.name, lambda: repr(report),
                     lambda: report.observations, lambda: tracker.state, tracker.finish, lambda: source.camera,
                     source.begin, reader.next, lambda: pliant.Tracker(camera)):
            with self.assertRaises(TypeError) as caught:
                call()
            self.assertIn("was made by __new__ alone", sentence(self, caught.exception))


class Arguments(TestCase):
    """A value of the wrong kind is a TypeError, or a ValueError, that names its argument; nothing is written."""

    def refused(self, message, call, *arguments, **named):
        with self.subTest(message), self.assertRaises((TypeError, ValueError)) as caught:
            call(*arguments, **named)
        self.assertIn(message, sentence(self, caught.exception))
        self.assertFalse((self.folder / "out").exists())

    def test_of_tracking(self):
        out, image = self.folder / "out", np.zeros((480, 640), np.uint8)
        camera = pliant.Camera("PINHOLE", 640, 480, [400, 400, 320, 240])
        self.refused("end is a str; give a whole number", pliant.track, SEQUENCE, out, end="a")
        self.refused("end is a float; give a whole number", pliant.track, SEQUENCE, out, end=2.5)
        self.refused("stride is a NoneType", pliant.track, SEQUENCE, out, stride=None)
        self.refused("resume is a str; give True or False", pliant.track, SEQUENCE, out, resume="yes")
        self.refused("preset is a NoneType; give text", pliant.track, SEQUENCE, out, preset=None)
        self.refused("on_frame is a int; give a function", pliant.track, SEQUENCE, out, on_frame=3)
        self.refused("initializer is a int; give a function", pliant.track, SEQUENCE, out, initializer=3)
        self.refused("there is no initializer 'z'", pliant.track, SEQUENCE, out, initializer="z")
        self.refused("give the path of its calibration, which camera.write makes", pliant.track, SEQUENCE, out,
                     camera=camera)
        self.refused("timestamps is a str; give a number", pliant.track, [image] * 3, out, camera=camera,
                     timestamps=["a"] * 3)
        self.refused("apart, as nanoseconds would be; give seconds", pliant.track, [image] * 3, out, camera=camera,
                     timestamps=1403636579763555584 + 33333333 * np.arange(3))
        for value in (3, None, b"colon", np.array(3)):
            self.refused("give a path, a pliant.Sequence, or a list, an array or another iterable of images",
                         pliant.track, value, out)
        for given in ([image] * 3, (image for _ in range(3))):
            self.refused("there are 0 timestamps", pliant.track, given, out, camera=camera, timestamps=[])
        for given in ([image] * 3, np.array([image] * 3)):
            self.refused("there are 4 timestamps for 3 images; each image needs one", pliant.track, given, out,
                         camera=camera, timestamps=np.arange(4) / 30)
        for end in (5, 10, -1):
            self.refused(f"end is {end} and start is 10; end is one past the last frame, or None for all", pliant.track,
                         SEQUENCE, out, start=10, end=end)
        self.refused("end is one past the last frame, or None for all", pliant.open_sequence, SEQUENCE, end=0)
        self.refused("camera is a NoneType; give a pliant.Camera", pliant.Tracker, None)
        self.refused("examples is a NoneType", pliant.Tracker, camera, examples=None)
        sequence = pliant.open_sequence(SEQUENCE)
        self.refused("the input is a pliant.Sequence", pliant.track, sequence, out, end=3)
        self.refused("frame_idx is a str; give a whole number", sequence.depth, "a")
        for call in (sequence.depth, sequence.world_from_cam):
            self.refused("frame_idx is 1000000000000; give a whole number from -2147483648 to 2147483647", call, 10**12)
        self.refused("end is 1099511627776; give a whole number from", pliant.track, SEQUENCE, out, end=2**40)

    def test_that_are_paths_have_names_in_utf_8(self):
        out = self.folder / "out"
        camera = pliant.Camera("PINHOLE", 640, 480, [400, 400, 320, 240])
        for name, message in ((os.fsdecode(b"\xfcber"), r"'\udcfcber', is not UTF-8; rename it"),
                              ("a\0b", r"'a\x00b', has a character of the code 0; leave it out")):
            for call, arguments in ((pliant.open_run, [pathlib.Path(name)]), (pliant.open_sequence, [name]),
                                    (pliant.track, [name, out]), (pliant.export, [RUN, name, "ply"]),
                                    (pliant.read_camera, [name]), (camera.write, [name])):
                self.refused(message, call, *arguments)
            option = message.replace("rename it", "give another name")
            self.refused("the option TrackFile.path, " + option, pliant.track, SEQUENCE, out, {"TrackFile.path": name})
            self.refused("an option, " + option, pliant.track, SEQUENCE, out, {name: 3})
        self.refused("path is a bytes; give a path", pliant.open_run, b"run")

    def test_of_the_tracker(self):
        camera = pliant.Camera("PINHOLE", 640.0, np.int64(480), np.array([400, 400, 320, 240]))
        self.assertEqual((camera.width, camera.height), (640, 480))
        self.refused("width is 640.5; give a whole number", pliant.Camera, "PINHOLE", 640.5, 480, [400, 400, 320, 240])
        self.refused("width is 1099511627776; give a whole number of at most 2147483647", pliant.Camera, "PINHOLE", 2**40,
                     480, [400, 400, 320, 240])
        self.refused("params is a str; give a list of numbers", pliant.Camera, "PINHOLE", 640, 480, "abc")
        self.refused("fps is a str; give a number", pliant.Camera, "PINHOLE", 640, 480, [400, 400, 320, 240], fps="30")
        image, prior = np.zeros((480, 640), np.uint8), np.ones((5, 400), np.float32)
        tracker = pliant.Tracker(camera)
        self.refused("timestamp is a str; give a number", tracker.process, image, timestamp="a")
        tracker.process(image, timestamp=5.0)
        self.refused("not after that of the one before", tracker.process, image, timestamp=1.0)
        self.refused("as nanoseconds would be", tracker.process, image, timestamp=1403636579763555584)
        paused = pliant.Tracker(camera)
        for time in (0, 1 / 30, 1200):
            paused.process(image, timestamp=time)
        with self.assertRaisesRegex(pliant.Error, "is 400x5, but the images are 640x480"):
            tracker.process(image, depth_prior=prior)
        tracker.process(image, timestamp=6.0)

    def test_of_the_other_jobs(self):
        out, rays = self.folder / "out", np.tile([0.0, 0.0, 1.0], (9, 1))
        self.refused("format is a NoneType; give text", pliant.export, RUN, out, None)
        self.refused("system is 'orb'; give droid", pliant.convert_arrays, "a.npz", out, "orb", (640, 480))
        for name, value in (("size", (640,)), ("size", (640, 1)), ("size", "640x480"), ("start", -1), ("stride", 0),
                            ("step_px", 0.5), ("fps", 0), ("fps", "fast"), ("times", 3), ("path", 3)):
            arguments = {"size": (640, 480), name: value}
            self.refused(f"{name} is ", pliant.convert_arrays, "a.npz", out, "megasam", **arguments)
        self.refused("leave out start and stride", pliant.convert_arrays, "a.npz", out, "tapip3d", (640, 480), stride=2,
                     tracks_path="b.npz")
        for call, named in ((pliant.compare, {}), (pliant.join, {"output_path": out}), (pliant.report, {"output_path": out})):
            for value in (5, None, b"run"):
                self.refused(f"runs is a {type(value).__name__}; give a run or its folder, or a list of them", call, value,
                             **named)
        self.refused("other_runs is a int; give a run or its folder", pliant.evaluate, RUN, SEQUENCE, other_runs=5)
        self.refused("sequence is a int; give a path, or a list", pliant.compare, [RUN], 3)
        self.refused("surface_paths is a int; give a surface folder", pliant.report, RUN, out, surface_paths=3)
        for value in (3, None, b"run"):
            self.refused(f"path is a {type(value).__name__}; give a path", pliant.open_run, value)
        for call, run in ((pliant.refine, RUN), (pliant.join, [RUN, RUN])):
            self.refused(f"run would overwrite the run '{RUN}'; give another output_path", call, run, RUN / ".")
        self.refused("board is a NoneType; give text", pliant.calibrate, SEQUENCE, None, out)
        self.refused("frames is a str; give a list of whole numbers", pliant.surface, RUN, out, frames="12")
        self.refused("frames is a float; give a whole number", pliant.surface, RUN, out, frames=[1.9])
        for figure in (None, [1]):
            self.refused("there is no run to show", pliant.report, [], out / "page.html" if figure is None else
                         out / "still.png", figure=figure)
        for name, value in (("seed", -1), ("seed", 2**80), ("max_iterations", 0), ("max_iterations", 2**40)):
            self.refused(f"{name} is {value}; give a whole number from ", pliant.kernels.relative_pose, rays, rays, 400,
                         **{name: value})
        self.refused("solver is a NoneType", pliant.kernels.relative_pose, rays, rays, 400, solver=None)
        self.refused("focal_px is a str", pliant.kernels.relative_pose, rays, rays, "f")
        self.refused("options are a dictionary", pliant.kernels.deformation_graph, rays, options=[3])
        self.refused("camera is a NoneType", pliant.kernels.solve_frame, None, rays, rays[:, :2], np.eye(4))
        poses = np.tile(np.eye(4), (3, 1, 1))
        window = {"times": [0, 1, 2], "cams_from_world": poses, "points": rays, "rays": rays,
                  "view_idx": [0, 1, 2] * 3, "point_idx": np.arange(9), "focal_px": 400}
        for change, message in (({"times": np.zeros((3, 1))}, "times is a ndarray"),
                                ({"view_idx": np.arange(9) % 3 + 0.5}, "view_idx has to be whole numbers"),
                                ({"rays": 2 * rays}, "rays has vectors that are not of length 1"),
                                ({"cams_from_world": poses + np.eye(4, k=3)}, "the first of cams_from_world")):
            self.refused(message, lambda values=change: pliant.kernels.solve_window(**{**window, **values}))


class Options(TestCase):
    def refused(self, options, **arguments):
        with self.assertRaises(ValueError) as caught:
            pliant.track(SEQUENCE, self.folder / "run", options, **arguments)
        self.assertFalse((self.folder / "run").exists())
        return sentence(self, caught.exception)

    def test_an_unknown_name_names_its_nearest_neighbor(self):
        self.assertEqual(self.refused({"Init.metod": "window"}),
                         "there is no option 'Init.metod'; did you mean 'Init.method'?")

    def test_what_an_option_needs_is_named_without_dashes(self):
        with self.assertRaises(ValueError) as caught:
            pliant.track(SEQUENCE, self.folder / "run", {"Init.method": "colmap_model"})
        self.assertIn("name it with Init.model_path", sentence(self, caught.exception))

    def test_values_are_checked_as_on_the_command_line(self):
        self.assertEqual(self.refused({"General.threads": 0}),
                         "General.threads is '0'; give a whole number from 1 to 1024")
        self.assertIn("give one of", self.refused({"Init.method": "magic"}))
        self.assertIn("give a number from", self.refused({"Image.scale": float("nan")}))
        self.assertIn("give a whole number", self.refused({"General.seed": 1.5}))
        self.assertIn("give a number, a boolean, text", self.refused({"General.seed": object()}))
        self.assertIn("General.seed is '1,2'", self.refused({"General.seed": np.array([1, 2])}))
        self.assertIn("give one of default | paper", self.refused({}, preset="papre"))
        self.assertIn("Init.depth_cloud is for a start from depth", self.refused({"Init.depth_cloud": "cloud.ply"}))

    def test_options_that_are_no_dictionary_are_a_type_error(self):
        with self.assertRaises(TypeError) as caught:
            pliant.track(SEQUENCE, self.folder / "run", ["General.seed"])
        self.assertIn("options are a dictionary", sentence(self, caught.exception))

    def test_values_of_python_and_numpy_are_taken(self):
        options = {"General.seed": np.int64(3), "Growth.grow": np.bool_(False), "Image.working": "fixed",
                   "Image.smoothing_px": np.longdouble(0.5), "Image.scale": np.array(1)}
        with self.assertRaises(pliant.Error):  # one frame: options are resolved, and then there is no map
            pliant.track(SEQUENCE, self.folder / "run", options, end=1)
        config = (self.folder / "run" / "config.yaml").read_text()
        for line in ("seed: 3 ", "grow: off ", "working: fixed ", "smoothing_px: 0.5 ", "scale: 1 "):
            self.assertIn(" " + line, config)

    def test_the_list_has_defaults_units_and_sentences_and_can_be_given_back(self):
        options = pliant.options("track")
        self.assertEqual(options["General.seed"], 1)
        self.assertEqual(options["Image.working"], "measured")
        self.assertIn("the same seed gives the same files", options.help["General.seed"])
        self.assertEqual(options.unit["Image.working"], "measured | fixed")
        self.assertIn("seed: 1", str(options))
        self.assertEqual(set(options), set(options.help))
        with self.assertRaises(pliant.Error):
            pliant.track(SEQUENCE, self.folder / "run", options, end=1)
        with self.assertRaises(pliant.Error):
            pliant.track(SEQUENCE, self.folder / "default", end=1)
        self.assertEqual((self.folder / "run" / "config.yaml").read_text(),
                         (self.folder / "default" / "config.yaml").read_text())

    def test_presets_have_their_own_defaults(self):
        self.assertEqual(pliant.options("track", "paper")["Init.method"], "paper")
        self.assertEqual(pliant.options("simulate")["Sensor.gamma"], 2.2)
        self.assertNotEqual(pliant.options("simulate", "endoscope"), pliant.options("simulate"))
        for job in ("refine", "join", "surface", "evaluate", "export", "report"):
            self.assertTrue(pliant.options(job))
        with self.assertRaises(ValueError) as caught:
            pliant.options("trakc")
        self.assertIn("give one of track", sentence(self, caught.exception))


if __name__ == "__main__":
    unittest.main()
