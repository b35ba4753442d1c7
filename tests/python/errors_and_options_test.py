# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Errors are exceptions with the sentence of the command line; options have its names and its checks."""

import unittest

import numpy as np

import pliant
from support import SEQUENCE, TestCase, sentence


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


class Options(TestCase):
    def refused(self, options, **arguments):
        with self.assertRaises(ValueError) as caught:
            pliant.track(SEQUENCE, self.folder / "run", options, **arguments)
        self.assertFalse((self.folder / "run").exists())
        return sentence(self, caught.exception)

    def test_an_unknown_name_names_its_nearest_neighbor(self):
        self.assertEqual(self.refused({"Init.metod": "window"}),
                         "there is no option 'Init.metod'; did you mean 'Init.method'?")

    def test_values_are_checked_as_on_the_command_line(self):
        self.assertEqual(self.refused({"General.threads": 0}),
                         "General.threads is '0'; give a whole number from 1 to 1024")
        self.assertIn("give one of", self.refused({"Init.method": "magic"}))
        self.assertIn("give a number from", self.refused({"Image.scale": float("nan")}))
        self.assertIn("give a whole number", self.refused({"General.seed": 1.5}))
        self.assertIn("give a number, a boolean, text", self.refused({"General.seed": object()}))
        self.assertIn("give one of default | paper", self.refused({}, preset="papre"))
        self.assertIn("Init.depth_cloud is for a start from depth", self.refused({"Init.depth_cloud": "cloud.ply"}))

    def test_options_that_are_no_dictionary_are_a_type_error(self):
        with self.assertRaises(TypeError) as caught:
            pliant.track(SEQUENCE, self.folder / "run", ["General.seed"])
        self.assertIn("options are a dictionary", sentence(self, caught.exception))

    def test_values_of_python_and_numpy_are_taken(self):
        options = {"General.seed": np.int64(3), "Growth.grow": np.bool_(False), "Image.working": "fixed",
                   "Image.smoothing_px": np.array(0.5), "Image.scale": np.array(1)}
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
