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
        with self.assertRaises(pliant.Error) as caught:
            kernels.relative_pose(np.repeat(self.rays0[:3], 20, 0), np.repeat(self.rays1[:3], 20, 0), 500)
        self.assertEqual(caught.exception.code, "degenerate")
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


class Frame(TestCase):
    """A camera before a bumpy surface, a part of which has moved."""

    camera = pliant.Camera("PINHOLE", 640, 480, [500, 500, 319.5, 239.5])
    grid = np.stack(np.meshgrid(np.linspace(-25, 25, 9), np.linspace(-18, 18, 7)), axis=-1).reshape(-1, 2)
    before = np.column_stack([grid, 60 + 4 * np.sin(grid[:, 0] / 7)])
    moved = before + np.column_stack([1.5 * np.exp(-(grid ** 2).sum(axis=1) / 100), np.zeros((len(grid), 2))])

    def pixels(self, pose):
        return self.camera.project(self.moved @ pose[:3, :3].T + pose[:3, 3])

    def test_pose_and_displacements_explain_the_pixels(self):
        pose = np.eye(4)
        pose[:3, 3] = [0.8, -0.4, 0.2]
        solutions = [kernels.solve_frame(self.camera, self.before, self.pixels(pose), np.eye(4),
                                         options={"Optimization.solver": solver})
                     for solver in ("lbfgs", "levenberg_marquardt")]
        for solution in solutions:
            self.assertTrue(solution.used.all() and solution.converged)
            self.assertLess(np.median(solution.reprojection_error_px), 0.1)
            self.assertLess(sum(solution.costs.values()), 0.01 * sum(solution.initial_costs.values()))
        np.testing.assert_allclose(solutions[0].position, solutions[1].position, atol=0.05)
        held = kernels.solve_frame(self.camera, self.before, self.pixels(pose), pose, held=True)
        np.testing.assert_allclose(held.cam_from_world, pose)
        moved_by = np.linalg.norm(held.position - self.before, axis=1)
        middle = len(moved_by) // 2
        self.assertGreater(moved_by[middle], 0.7 * 1.5)
        self.assertLess(moved_by[0], 0.2 * moved_by[middle])

    def test_wrong_input_is_one_sentence(self):
        with self.assertRaises(pliant.Error) as caught:
            kernels.solve_frame(self.camera, self.before, self.pixels(np.eye(4))[:-1], np.eye(4))
        self.assertEqual(caught.exception.code, "mismatch")
        for call in (lambda: kernels.solve_frame(self.camera, self.before * np.nan, self.before[:, :2], np.eye(4)),
                     lambda: kernels.solve_frame(self.camera, self.before, self.before[:, :2], 2 * np.eye(4)),
                     lambda: kernels.solve_frame(self.camera, self.before, self.before[:, :2], np.eye(4),
                                                 options={"Optimization.none": 1})):
            with self.assertRaises(ValueError) as raised:
                call()
            sentence(self, raised.exception)


class Window(TestCase):
    """A camera that goes sideways before a surface, in ten views."""

    points = Frame.before
    times = np.arange(10.0)

    def start(self, wave):
        poses = np.tile(np.eye(4), (len(self.times), 1, 1))
        poses[:, 0, 3] = -0.7 * self.times
        poses[:, 1, 3] = -0.2 * self.times
        rays, view_idx, point_idx = [], [], []
        for view, pose in enumerate(poses):
            lift = wave * np.sin(2 * np.pi * view / 9) * np.exp(-(Frame.grid ** 2).sum(axis=1) / 200)
            positions = self.points + lift[:, None] * [0, 0, 1]
            rays.append(unit(positions @ pose[:3, :3].T + pose[:3, 3]))
            view_idx += [view] * len(positions)
            point_idx += range(len(positions))
        return poses, np.concatenate(rays), view_idx, point_idx

    def test_a_rigid_window_is_recovered(self):
        poses, rays, view_idx, point_idx = self.start(0)
        noisy = self.points * np.random.default_rng(1).normal(1, 0.03, (len(self.points), 1))
        solution = kernels.solve_window(self.times, poses, noisy, rays, view_idx, point_idx, 500, deforming=False)
        scale = np.median(np.linalg.norm(self.points, axis=1)) / np.median(np.linalg.norm(solution.points, axis=1))
        np.testing.assert_allclose(scale * solution.points, self.points, rtol=1e-3, atol=0.05)
        self.assertEqual(solution.coefficients.shape, (0, 10))
        self.assertEqual(solution.shapes.shape, (len(self.points), 3, 0))

    def test_a_deforming_window_has_shapes_and_coefficients(self):
        poses, rays, view_idx, point_idx = self.start(2.0)
        arguments = (self.times, poses, self.points, rays, view_idx, point_idx, 500)
        rigid = kernels.solve_window(*arguments, deforming=False)
        solution = kernels.solve_window(*arguments, options={"Window.rank": 2})
        self.assertEqual(solution.shapes.shape[2], len(solution.coefficients))
        self.assertGreater(len(solution.coefficients), 0)
        np.testing.assert_array_equal(solution.coefficients[:, 0], 0)
        self.assertGreater(rigid.residual_correlation, 0.5)
        self.assertLess(solution.cost, 0.5 * rigid.cost)

    def test_wrong_input_is_one_sentence(self):
        poses, rays, view_idx, point_idx = self.start(0)
        for change in ({"view_idx": [99] * len(rays)}, {"point_idx": point_idx[:-1]}, {"focal_px": 0},
                       {"cams_from_world": poses[:-1]}, {"cams_from_world": 2 * poses}):
            arguments = {"times": self.times, "cams_from_world": poses, "points": self.points, "rays": rays,
                         "view_idx": view_idx, "point_idx": point_idx, "focal_px": 500, **change}
            with self.subTest(list(change)), self.assertRaises(ValueError) as raised:
                kernels.solve_window(**arguments)
            sentence(self, raised.exception)
        with self.assertRaises(pliant.Error) as caught:
            kernels.solve_window(self.times[:2], poses[:2], self.points, rays[:126], view_idx[:126], point_idx[:126],
                                 500)
        self.assertEqual(caught.exception.code, "insufficient")


if __name__ == "__main__":
    unittest.main()
