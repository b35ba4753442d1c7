# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Cost terms from Python: they move the solution, in every form of a Jacobian, and what is wrong is refused."""

import unittest

import numpy as np

import pliant
from support import SEQUENCE, TestCase, images, sentence

FRAMES = 30
FIXED = {"General.timings": "none", "Image.working": "fixed"}
SIGMA_MM = 0.05


class Isometry:
    """Holds edges to their length in the frame before."""

    def __init__(self, sigma=SIGMA_MM):
        self.sigma = sigma
        self.frames = set()
        self.points = set()

    def evaluate(self, frame):
        self.frames.add(frame.frame_idx)
        self.points.update(frame.point_id.tolist())
        i, j = frame.edges.T
        now, before = frame.position[i] - frame.position[j], frame.previous[i] - frame.previous[j]
        length = np.linalg.norm(now, axis=1)
        residuals = (length - np.linalg.norm(before, axis=1)) / self.sigma
        direction = now / length[:, None] / self.sigma
        row = np.repeat(np.arange(len(i)), 3)
        columns = [(3 * end[:, None] + np.arange(3)).ravel() for end in (i, j)]
        return residuals, (np.concatenate([row, row]), np.concatenate(columns),
                           np.concatenate([direction.ravel(), -direction.ravel()]))


class Answer:
    """Returns what a function makes of the frame."""

    def __init__(self, function):
        self.evaluate = function


class Sparse:
    """What a sparse matrix of SciPy has and is asked for."""

    def __init__(self, triplets, shape):
        self.row, self.col, self.data = triplets
        self.shape = shape

    def tocoo(self):
        return self


def stretch(run):
    """Mean change of the distances of points from frame to frame, mm."""
    changes = []
    for frame in run.poses.frame_idx[:-1]:
        before, now = run.frame(frame), run.frame(frame + 1)
        _, a, b = np.intersect1d(before.point_id, now.point_id, return_indices=True)
        p, q = before.position[a], now.position[b]
        i, j = np.triu_indices(len(a), 1)
        distance = np.linalg.norm(p[i] - p[j], axis=1)
        near = distance < 5
        changes.append(np.abs(np.linalg.norm(q[i] - q[j], axis=1) - distance)[near].mean())
    return np.mean(changes)


class InKernel(TestCase):
    """Of pliant.kernels.solve_frame, on points that move."""

    camera = pliant.Camera("PINHOLE", 640, 480, [500, 500, 319.5, 239.5])

    def setUp(self):
        super().setUp()
        random = np.random.default_rng(1)
        self.positions = np.column_stack([random.uniform(-25, 25, 40), random.uniform(-18, 18, 40),
                                          50 + random.uniform(-4, 4, 40)])
        moved = self.positions + random.normal(0, 0.5, (40, 3))
        self.positions[7] = [0, 0, -20]  # behind the camera
        self.pixels = self.camera.project(moved)

    def solve(self, cost=None, **options):
        tight = {"Optimization.function_tolerance": 1e-13, "Optimization.max_iterations": 2000}
        return pliant.kernels.solve_frame(self.camera, self.positions, self.pixels, np.eye(4), cost=cost,
                                          options={**tight, **options})

    def pull(self, frame):
        """1 mm to the right of where each point was, by its number in the input."""
        count = len(frame.position)
        rows = frame.point_id
        residuals = ((frame.position - self.positions[rows] - [1, 0, 0]) / 0.01).reshape(-1)
        return residuals, np.eye(3 * count) / 0.01

    def test_points_go_where_it_draws_them_with_either_solver(self):
        for solver in ("lbfgs", "levenberg_marquardt"):
            solution = self.solve(Answer(self.pull), **{"Optimization.solver": solver})
            used = solution.used
            self.assertEqual(used.sum(), 39)
            moved = (solution.position - self.positions)[used]
            np.testing.assert_allclose(moved, np.tile([1.0, 0, 0], (39, 1)), atol=0.05)
            self.assertLess(solution.costs["python"], solution.initial_costs["python"])
        self.assertNotIn("python", self.solve().costs)

    def test_all_forms_of_a_jacobian_are_the_same(self):
        whole = self.solve(Answer(self.pull)).position

        def triplets(frame):
            residuals, jacobian = self.pull(frame)
            return residuals, (*np.nonzero(jacobian), np.full(len(residuals), 100.0))

        def doubled(frame):
            residuals, (row, column, value) = triplets(frame)
            return residuals, (np.tile(row, 2), np.tile(column, 2), np.tile(value / 2, 2))

        def sparse(frame):
            residuals, entries = triplets(frame)
            return residuals, Sparse(entries, (len(residuals), len(residuals)))
        for form in (triplets, doubled, sparse):
            np.testing.assert_allclose(self.solve(Answer(form)).position, whole, atol=1e-6)

    def test_what_it_is_told_is_the_frame(self):
        told = []

        def look(frame):
            told.append(frame)
            return self.pull(frame)
        self.solve(Answer(look))
        frame = told[0]
        self.assertEqual(frame.point_id.tolist(), [i for i in range(40) if i != 7])
        np.testing.assert_array_equal(frame.previous, self.positions[frame.point_id])
        np.testing.assert_array_equal(frame.position, frame.previous)  # first where the search begins
        np.testing.assert_array_equal(frame.pixel, self.pixels[frame.point_id])
        np.testing.assert_array_equal(frame.cam_from_world, np.eye(4))
        graph = pliant.kernels.deformation_graph(self.positions)
        kept = [edge for edge in graph.edges.tolist() if 7 not in edge]
        self.assertEqual(frame.point_id[frame.edges].tolist(), kept)
        self.assertEqual([len(frame.weight), len(frame.rest_length)], [len(kept)] * 2)

    def test_what_it_returns_is_checked(self):
        n = 3 * 39
        good = np.zeros((2, n))
        for answer, kind, message in [
                (5, TypeError, "(residuals, jacobian)"),
                ((np.zeros((2, 1)), good), ValueError, "residuals of a cost have the shape (2, 1)"),
                ((np.zeros(3), good), ValueError, f"3 residuals of 39 points need (3, {n})"),
                (([0, np.nan], good), ValueError, "not a finite number"),
                ((np.zeros(2, complex), good), TypeError, "complex numbers as its residuals"),
                ((np.zeros(2), good + 1j), TypeError, "complex numbers as its jacobian"),
                ((np.zeros(2), ([0], [0], [1j])), TypeError, "complex numbers as its jacobian"),
                ((np.zeros(2), good + np.inf), ValueError, "not a finite number"),
                ((np.zeros(2), ([0], [0])), ValueError, "a tuple of 2"),
                ((np.zeros(2), ([0], [0], [1, 2])), ValueError, "one length"),
                ((np.zeros(2), ([0], [n], [1])), ValueError, "outside"),
                ((np.zeros(2), ([-1], [0], [1])), ValueError, "outside"),
                ((np.zeros(2), ([0.5], [0], [1])), TypeError, "whole numbers"),
                ((np.zeros(2), Sparse(([0], [0], [1]), (2, 2))), ValueError, "shape (2, 2)")]:
            with self.subTest(message), self.assertRaises(kind) as caught:
                self.solve(Answer(lambda frame, answer=answer: answer))
            self.assertIn(message, sentence(self, caught.exception))
        with self.assertRaises(TypeError) as caught:
            self.solve(object())
        self.assertIn("evaluate", sentence(self, caught.exception))


class InRuns(TestCase):
    def test_it_is_chosen_by_its_name_and_is_a_column_of_the_run(self):
        cost = Isometry()
        pliant.register_cost("isometry", cost)
        run = pliant.track(SEQUENCE, self.folder / "run", FIXED, end=FRAMES, cost="isometry")
        self.assertEqual(run.summary["extensions"], ["cost isometry"])
        self.assertGreater(run.frames.costs["isometry"][run.frames.has_pose].max(), 0)
        tracked = run.observations.frame_idx > run.summary["first_map"]["declared_frame"]
        ids, seen = np.unique(run.observations.point_id[tracked], return_counts=True)
        self.assertTrue(set(ids[seen > 1].tolist()) <= cost.points)  # a point is solved for from its second frame on
        self.assertTrue(set(run.observations.frame_idx[tracked].tolist()) <= cost.frames)
        without = pliant.track(SEQUENCE, self.folder / "without", FIXED, end=FRAMES)
        self.assertNotIn("isometry", without.frames.costs)
        self.assertLess(stretch(run), 0.9 * stretch(without))
        with self.assertRaises(ValueError) as caught:
            pliant.track(SEQUENCE, self.folder / "unknown", cost="no_such")
        self.assertIn("registered: isometry", sentence(self, caught.exception))

    def test_a_tracker_takes_it_too(self):
        options = {**FIXED, "General.max_frames_back": 0}
        run = pliant.track(SEQUENCE, self.folder / "run", options, end=FRAMES, cost=Isometry())
        tracker = pliant.Tracker(pliant.read_camera(SEQUENCE / "camera.yaml"), options, cost=Isometry())
        reports = []
        for image in images(FRAMES):
            reports += tracker.process(image)
        reports += tracker.finish()
        self.assertEqual(set(reports[-1].costs), set(run.frames.costs))
        np.testing.assert_allclose(reports[-1].observations.position, run.frame(FRAMES - 1).position, atol=1e-5)

    def test_an_exception_in_it_ends_the_run_and_is_raised(self):
        def broken(frame):
            raise LookupError("broken on purpose")
        with self.assertRaisesRegex(LookupError, "on purpose"):
            pliant.track(SEQUENCE, self.folder / "run", FIXED, end=FRAMES, cost=Answer(broken))
        self.assertEqual(pliant.open_run(self.folder / "run").summary["status"], "interrupted")

    def test_names_are_columns_of_their_own(self):
        for name, message in (("spatial", "a term of Pliant"), ("a,b", "letters, digits and _"), ("", "letters")):
            with self.assertRaises(ValueError) as caught:
                pliant.register_cost(name, Isometry())
            self.assertIn(message, sentence(self, caught.exception))
        with self.assertRaises(TypeError):
            pliant.register_cost("five", 5)


if __name__ == "__main__":
    unittest.main()
