# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Two-view geometry and the deformation graph on constructed arrays: exact recovery without noise."""

import unittest

import numpy as np

import pliant
from pliant import kernels
from support import TestCase, sentence


def motion():
    """A turn by 0.2 rad about y and a step of length 1 to the right and ahead."""
    matrix = np.eye(4)
    matrix[:3, :3] = [[np.cos(0.2), 0, np.sin(0.2)], [0, 1, 0], [-np.sin(0.2), 0, np.cos(0.2)]]
    matrix[:3, 3] = [-0.8, 0, 0.6]
    return matrix


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


class TwoViews(TestCase):
    points = np.random.default_rng(3).uniform([-4, -3, 6], [4, 3, 14], (60, 3))
    rays0 = unit(points)
    rays1 = unit(points @ motion()[:3, :3].T + motion()[:3, 3])

    def test_rays_meet_in_their_points(self):
        for method in ("idwm", "midpoint", "linear", "optimal_l2"):
            points, ok = kernels.triangulate(motion(), self.rays0, self.rays1, method)
            self.assertTrue(ok.all())
            np.testing.assert_allclose(points, self.points, rtol=1e-9)

    def test_rays_that_meet_nowhere_are_not_numbers(self):
        rays0 = np.array([[0, 0, 1.0], [np.nan, 0, 1]])
        points, ok = kernels.triangulate(motion(), rays0, rays0 @ motion()[:3, :3].T)
        self.assertFalse(ok.any())
        self.assertTrue(np.isnan(points).all())

    def test_the_motion_is_recovered_among_outliers(self):
        rays1 = self.rays1.copy()
        rays1[:12] = unit(np.random.default_rng(4).normal(size=(12, 3)) + [0, 0, 3])
        found, inliers = kernels.relative_pose(self.rays0, rays1, 500, seed=2)
        np.testing.assert_allclose(found, motion(), atol=1e-6)
        self.assertTrue(inliers[12:].all())
        again, _ = kernels.relative_pose(self.rays0, rays1, 500, seed=2)
        np.testing.assert_array_equal(again, found)

    def test_wrong_input_is_one_sentence(self):
        with self.assertRaises(pliant.Error) as caught:
            kernels.relative_pose(self.rays0[:5], self.rays1[:5], 500)
        self.assertEqual(caught.exception.code, "insufficient")
        for call in (lambda: kernels.relative_pose(2 * self.rays0, self.rays1, 500),
                     lambda: kernels.relative_pose(self.rays0, self.rays1, 500, solver="nistar"),
                     lambda: kernels.relative_pose(self.rays0, self.rays1, float("nan")),
                     lambda: kernels.relative_pose(self.rays0, self.rays1[:9], 500),
                     lambda: kernels.triangulate(2 * motion(), self.rays0, self.rays1),
                     lambda: kernels.triangulate(motion()[:3], self.rays0, self.rays1),
                     lambda: kernels.triangulate(motion(), self.rays0, self.rays1[:9])):
            with self.assertRaises(ValueError) as caught:
                call()
            sentence(self, caught.exception)


class Graph(TestCase):
    def test_neighbors_on_a_line_are_joined_with_weights_by_distance(self):
        positions = np.zeros((4, 3))
        positions[:, 0] = [0, 1, 3, 7]
        graph = kernels.deformation_graph(positions, options={"Deformation.neighbors": 1, "Deformation.sigma_mm": 2})
        np.testing.assert_array_equal(graph.edges, [[0, 1], [1, 2], [2, 3]])
        np.testing.assert_array_equal(graph.multiplicity, [2, 1, 1])
        np.testing.assert_array_equal(graph.rest_length, [1, 2, 4])
        self.assertTrue(np.all(np.diff(graph.weight) < 0) and np.all(graph.weight > 0) and np.all(graph.weight <= 1))
        stretched = kernels.deformation_graph(positions, 2 * positions, {"Deformation.neighbors": 1})
        np.testing.assert_array_equal(stretched.rest_length, [2, 4, 8])

    def test_wrong_input_is_one_sentence(self):
        with self.assertRaises(ValueError) as caught:
            kernels.deformation_graph(np.full((3, 3), np.nan))
        sentence(self, caught.exception)
        with self.assertRaises(pliant.Error) as caught:
            kernels.deformation_graph(np.zeros((3, 3)), np.zeros((2, 3)))
        self.assertEqual(caught.exception.code, "mismatch")


if __name__ == "__main__":
    unittest.main()
