# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Steps of the tracker by themselves, on arrays: two-view geometry, the graph of the deformation, the problem of a
frame and that of a window."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _pliant
from . import arguments as given
from .extensions import Cost, chosen_cost

if TYPE_CHECKING:
    from numpy.typing import NDArray


def triangulate(cam1_from_cam0: NDArray[Any], rays0: NDArray[Any], rays1: NDArray[Any],
                method: str = "idwm") -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The points at which the rays of two cameras meet.

    Args:
        cam1_from_cam0: (4, 4), a rigid motion; its translation decides the unit.
        rays0, rays1: (n, 3), directions in camera 0 and camera 1, of any length.
        method: idwm (inverse depth weighted midpoint), midpoint, linear or optimal_l2.

    Returns:
        (n, 3) float64, the points in camera 0, NaN where there is none; and (n,) bool, whether there is one (rays that
        are not numbers, run parallel, or meet behind a camera have none).
    """
    return _pliant.triangulate(cam1_from_cam0, rays0, rays1, given.text(method, "method"))


def relative_pose(rays0: NDArray[Any], rays1: NDArray[Any], focal_px: float, *, solver: str = "nister",
                  robust: str = "ransac", max_error_px: float = 1.5, max_iterations: int = 300,
                  seed: int = 1) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """The motion between two views of a rigid scene, against outliers.

    Args:
        rays0, rays1: (n, 3), matched unit rays (pliant.Camera.unproject), at least 8.
        focal_px: mean focal length, which turns max_error_px into an angle.
        solver: nister, stewenius, kneip, sevenpt, eightpt, eigensolver, opencv_usac, homography or rotation_only.
        robust: ransac, lmeds or local (LO-RANSAC).
        max_error_px: a match this far from the model, in a view, is an outlier.
        max_iterations: samples that are drawn at most.
        seed: decides the samples.

    Returns:
        cam1_from_cam0 (4, 4) float64, whose translation has length 1 (rotation_only: 0), not refined; and (n,) bool, the
        inliers.

    Raises:
        ValueError: rays that are not unit vectors, counts that differ, names that there are not.
        pliant.Error: too few matches or inliers (insufficient), or matches that do not determine the motion
            (degenerate).
    """
    return _pliant.relative_pose(rays0, rays1, given.number(focal_px, "focal_px"), {
        "solver": given.text(solver, "solver"), "robust": given.text(robust, "robust"),
        "max_error_px": given.number(max_error_px, "max_error_px"),
        "max_iterations": given.whole(max_iterations, "max_iterations", low=1),
        "seed": given.whole(seed, "seed", low=0, high=2**64 - 1)})


@dataclass(frozen=True, eq=False)
class DeformationGraph:
    """Edges between neighboring points, sorted, each pair once.

    Attributes:
        edges: (e, 2) int32, rows of the points, the smaller first.
        weight: (e,) float64, in (0, 1] (docs/method.md, D2).
        rest_length: (e,) float64, distance of the points undeformed, in the unit of the positions.
        multiplicity: (e,) int32, 2 where each point is among the other's nearest, else 1.
    """

    edges: NDArray[np.int32]
    weight: NDArray[np.float64]
    rest_length: NDArray[np.float64]
    multiplicity: NDArray[np.int32]


def deformation_graph(positions: NDArray[Any], rest_positions: NDArray[Any] | None = None,
                      options: Mapping[str, Any] | None = None) -> DeformationGraph:
    """The graph over which points regularize each other's motion.

    Args:
        positions: (n, 3), in any one frame, mm.
        rest_positions: (n, 3), the same points undeformed; None: rest lengths are the present ones.
        options: of the group Deformation, such as {"Deformation.neighbors": 8}.

    Raises ValueError for positions that are not finite, and pliant.Error for counts that differ.
    """
    return DeformationGraph(*_pliant.deformation_graph(positions, rest_positions, given.options(options)))


@dataclass(frozen=True, eq=False)
class FrameSolution:
    """One frame (docs/method.md, E5): the camera, and every point where it is now.

    Attributes:
        cam_from_world: (4, 4) float64.
        position: (n, 3) float64, world; of a point that is not used as it was.
        used: (n,) bool; False: the point does not project under the initial pose.
        reprojection_error_px: (n,) float64, infinite where it is not used.
        disagreement: (n,) float64, how much of a point's motion no neighbor shares, in the unit of the positions.
        costs, initial_costs: by name, at the solution and at the start.
        iterations, converged: of the solver.
    """

    cam_from_world: NDArray[np.float64]
    position: NDArray[np.float64]
    used: NDArray[np.bool_]
    reprojection_error_px: NDArray[np.float64]
    disagreement: NDArray[np.float64]
    costs: dict[str, float]
    initial_costs: dict[str, float]
    iterations: int
    converged: bool


def solve_frame(camera: _pliant.Camera, positions: NDArray[Any], pixels: NDArray[Any], cam_from_world: NDArray[Any], *,
                rest_positions: NDArray[Any] | None = None, held: bool = False,
                options: Mapping[str, Any] | None = None, cost: Cost | str | None = None) -> FrameSolution:
    """The joint problem of one frame: camera pose and a displacement of every point.

    Args:
        camera: of the image.
        positions: (n, 3), world, where the points were in the frame before, mm.
        pixels: (n, 2), where they are seen now.
        cam_from_world: (4, 4), where the search begins.
        rest_positions: (n, 3), the points undeformed; needed for edge lengths at rest and cut edges alone.
        held: the pose is known and stays.
        options: of the groups Optimization and Deformation, such as {"Optimization.solver": "levenberg_marquardt"}.
        cost: a term that is added, as of pliant.track.

    Raises ValueError for numbers that are not finite, what a cost raises, and pliant.Error: counts that differ
    (mismatch), too few points before the camera (insufficient), no usable solution (degenerate).
    """
    return FrameSolution(*_pliant.solve_frame(given.camera(camera), positions, pixels, cam_from_world, rest_positions,
                                              given.truth(held, "held"), given.options(options), chosen_cost(cost)))


@dataclass(frozen=True, eq=False)
class WindowSolution:
    """A window (docs/method.md, W1): the position of point i in view v is points[i] + shapes[i] @ coefficients[:, v].

    Attributes:
        cams_from_world: (v, 4, 4) float64; the first is the identity.
        points: (n, 3) float64, in the first view.
        coefficients: (r, v) float64; r is 0 of a rigid scene.
        shapes: (n, 3, r) float64.
        log_depth_sigma: (n,) float64, standard deviation of the logarithm of the distance; infinite: not known.
        cost: of the solution.
        residual_correlation: how much alike the errors of neighbors are: about 0 where all but noise is explained.
    """

    cams_from_world: NDArray[np.float64]
    points: NDArray[np.float64]
    coefficients: NDArray[np.float64]
    shapes: NDArray[np.float64]
    log_depth_sigma: NDArray[np.float64]
    cost: float
    residual_correlation: float


def solve_window(times: NDArray[Any], cams_from_world: NDArray[Any], points: NDArray[Any], rays: NDArray[Any],
                 view_idx: NDArray[Any], point_idx: NDArray[Any], focal_px: float, *, deforming: bool = True,
                 options: Mapping[str, Any] | None = None) -> WindowSolution:
    """Bundle adjustment of a window, in which the scene may deform.

    Args:
        times: (v,), of the views, in frames since the first one, which is 0.
        cams_from_world: (v, 4, 4), the poses of a rigid start; the first is the identity.
        points: (n, 3), the points of a rigid start, in the first view, any unit.
        rays: (m, 3), unit rays in their views' cameras, in any order.
        view_idx, point_idx: (m,), of which view and which point they are.
        focal_px: mean focal length, which turns pixels into angles.
        deforming: basis shapes and coefficients too; False: a rigid scene.
        options: of the group Window, such as {"Window.rank": 2}.

    Raises ValueError for what cannot be meant, and pliant.Error: too few views or points (insufficient), no usable step
    (degenerate).
    """
    start = {"times": given.numbers(times, "times"), "cams_from_world": np.asarray(cams_from_world),
             "points": points, "rays": rays, "view_idx": np.asarray(view_idx), "point_idx": np.asarray(point_idx)}
    return WindowSolution(*_pliant.solve_window(start, given.number(focal_px, "focal_px"),
                                                given.truth(deforming, "deforming"), given.options(options)))
