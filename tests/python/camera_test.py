# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cameras: made, read, and used on arrays."""

import copy
import pickle
import unittest

import numpy as np

import pliant
from support import SEQUENCE, TestCase, sentence


class Camera(TestCase):
    camera = pliant.Camera("OPENCV_FISHEYE", 640, 480, [300, 301, 319.5, 239.5, 0.02, -0.01, 0.003, 0.0])

    def test_it_says_what_it_was_made_of(self):
        self.assertEqual((self.camera.model, self.camera.width, self.camera.height), ("OPENCV_FISHEYE", 640, 480))
        np.testing.assert_array_equal(self.camera.params, [300, 301, 319.5, 239.5, 0.02, -0.01, 0.003, 0.0])
        self.assertIsNone(self.camera.fps)
        self.assertEqual(repr(eval(repr(self.camera))), repr(self.camera))

    def test_a_pinhole_projects_by_its_formula(self):
        camera = pliant.Camera("PINHOLE", 640, 480, [400, 410, 320, 240], fps=25)
        points = np.array([[1.0, 2.0, 4.0], [0.0, 0.0, 1.0], [-3.0, 1.0, 10.0]])
        expected = np.stack([400 * points[:, 0] / points[:, 2] + 320, 410 * points[:, 1] / points[:, 2] + 240], axis=1)
        np.testing.assert_allclose(camera.project(points), expected, rtol=1e-14)
        self.assertEqual(camera.fps, 25)

    def test_rays_project_where_they_come_from(self):
        columns, rows = np.meshgrid(np.arange(0, 640, 40.0), np.arange(0, 480, 40.0))
        pixels = np.stack([columns.ravel(), rows.ravel()], axis=1)
        rays = self.camera.unproject(pixels)
        np.testing.assert_allclose(np.linalg.norm(rays, axis=1), 1, rtol=1e-12)
        np.testing.assert_allclose(self.camera.project(7.5 * rays), pixels, atol=1e-8)

    def test_what_does_not_project_is_not_a_number(self):
        camera = pliant.Camera("SIMPLE_PINHOLE", 64, 48, [40, 32, 24])
        pixels = camera.project(np.array([[0, 0, 1.0], [0, 0, -1.0], [np.nan, 0, 1.0]]))
        np.testing.assert_array_equal(np.isnan(pixels), [[False, False], [True, True], [True, True]])

    def test_any_layout_and_real_type_is_taken_and_no_rows_are_no_rows(self):
        camera = pliant.Camera("SIMPLE_PINHOLE", 64, 48, [40, 32, 24])
        points = np.arange(24, dtype=np.float32).reshape(8, 3) + 1
        expected = camera.project(points.astype(np.float64))
        np.testing.assert_array_equal(camera.project(points), expected)
        np.testing.assert_array_equal(camera.project(np.asfortranarray(points)), expected)
        np.testing.assert_array_equal(camera.project(points[::2]), expected[::2])
        self.assertEqual(camera.project(np.zeros((0, 3))).shape, (0, 2))
        np.testing.assert_array_equal(camera.project(points.tolist()), expected)
        np.testing.assert_array_equal(camera.unproject([(32, 24)]), [[0, 0, 1]])

    def test_other_arrays_are_refused_in_one_sentence(self):
        for points, kind in ((np.zeros(3), ValueError), (np.zeros((3, 2)), ValueError), ([[0, 0, 1], [0]], TypeError), ([["a", 0, 1]], TypeError),
                             ([0, 0, 1], ValueError), ("abc", TypeError),
                             (np.zeros((2, 3), complex), TypeError), (np.zeros((2, 3), bool), TypeError)):
            with self.assertRaises(kind) as caught:
                self.camera.project(points)
            self.assertIn("points_in_cam is an array of real numbers of shape (n, 3)", sentence(self, caught.exception))

    def test_numbers_that_no_lens_has_are_a_value_error(self):
        for model, params in (("PINHOLE", [400, 400, 320]), ("PINHOLE", [400, float("nan"), 320, 240]),
                              ("PINHOLE", [-1, 400, 320, 240]), ("PINHOLL", [400, 400, 320, 240])):
            with self.assertRaises(ValueError) as caught:
                pliant.Camera(model, 640, 480, params)
            sentence(self, caught.exception)
        for fps in (0, 1e-300, 3e6, float("nan")):
            with self.assertRaises(ValueError):
                pliant.Camera("PINHOLE", 640, 480, [400, 400, 320, 240], fps=fps)

    def test_a_file_is_read(self):
        camera = pliant.read_camera(SEQUENCE / "camera.yaml")
        self.assertEqual((camera.model, camera.width, camera.height, camera.fps), ("PINHOLE", 640, 480, 30))
        with self.assertRaises(pliant.Error) as caught:
            pliant.read_camera(self.folder / "none.yaml")
        self.assertEqual(caught.exception.code, "not_found")

    def test_it_is_written_copied_and_compared(self):
        given = "model: OPENCV\nwidth: 640\nheight: 480\nparams: [457, 458, 319.5, 239.5, 0.01, 0, 0, 0.001]\nfps: 25\n"
        (self.folder / "given.yaml").write_text(given + "gamma: 2.0\n")
        camera = pliant.read_camera(self.folder / "given.yaml")
        camera.write(self.folder / "written.yaml")
        for same in (pliant.read_camera(self.folder / "written.yaml"), copy.deepcopy(camera),
                     pickle.loads(pickle.dumps(camera))):
            self.assertEqual(same, camera)
            self.assertEqual({same: 1}, {camera: 1})
            self.assertEqual((same.model, same.fps), ("OPENCV", 25))
            np.testing.assert_array_equal(same.params, camera.params)
        other = pliant.Camera("OPENCV", 640, 480, camera.params, fps=25)
        self.assertNotEqual(other, camera)  # which has a photometric calibration
        self.assertNotEqual(camera, "a camera")
        with self.assertRaises(pliant.Error):
            camera.write(self.folder / "nowhere" / "camera.yaml")


if __name__ == "__main__":
    unittest.main()
