# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Steps of the tracker by themselves, on arrays: two-view geometry and the graph of the deformation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from . import _pliant

if TYPE_CHECKING:
    import numpy as np
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
    return _pliant.triangulate(cam1_from_cam0, rays0, rays1, method)


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
    return _pliant.relative_pose(rays0, rays1, focal_px, {
        "solver": solver, "robust": robust, "max_error_px": max_error_px, "max_iterations": max_iterations,
        "seed": seed})


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
    return DeformationGraph(*_pliant.deformation_graph(positions, rest_positions,
                                                       None if options is None else dict(options)))
