# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Run folders."""

from __future__ import annotations

import json
import os
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np

from . import _pliant
from . import arguments as given
from .tables import Frames, Observations, Points, Poses

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Run:
    """A run folder: what track, refine or import left, also of a run that was interrupted or killed, or another
    program's trajectory.txt and observations.csv. Made by pliant.open_run.

    Attributes:
        folder: its path.
        frames: pliant.Frames, every frame that was read; empty in another program's run.
        poses: pliant.Poses of the frames that have one.

    The rest is read when it is asked for the first time, and kept.
    """

    def __init__(self, path: str | os.PathLike[str]):
        self.folder = Path(given.path(path, "path"))
        self.frames: Frames
        self.poses: Poses
        self.frames, self.poses = _pliant.read_run(os.fspath(self.folder))

    def __repr__(self) -> str:
        return f"<pliant.Run {os.fspath(self.folder)}: {len(self.poses)} of {len(self.frames)} frames have a pose>"

    @cached_property
    def summary(self) -> dict[str, Any]:
        """run.json (docs/formats.md): status, note, counts, times; empty in another program's run."""
        file = self.folder / "run.json"
        return json.loads(file.read_text(encoding="utf-8")) if file.exists() else {}

    @cached_property
    def observations(self) -> Observations:
        """Every point in every frame."""
        return _pliant.read_observations(os.fspath(self.folder))

    @cached_property
    def pose_covariance(self) -> NDArray[np.float64] | None:
        """How certain the poses are: (P, 6, 6) float64, a pose of `poses` each, of the camera's center (world frame, map
        units) and its rotation (rad, camera frame); of a refined run, else None. The first pose of a map is its world
        and has zeros."""
        file = self.folder / "pose_covariance.csv"
        if not file.exists():
            return None
        try:
            rows = np.loadtxt(file, delimiter=",", skiprows=1, ndmin=2)
        except ValueError as error:
            raise given.error("unreadable", f"{file} has a row that is not numbers alone: {error}") from None
        row_idx, column_idx = np.triu_indices(6)
        if rows.shape[1:] != (1 + len(row_idx),) or not np.array_equal(rows[:, 0], self.poses.frame_idx):
            raise given.error("mismatch", f"{file} does not have a row of 22 numbers for every pose of trajectory.txt")
        covariance = np.empty((len(rows), 6, 6))
        covariance[:, row_idx, column_idx] = covariance[:, column_idx, row_idx] = rows[:, 1:]
        return covariance

    @cached_property
    def _map(self) -> tuple[_pliant.Camera | None, dict[int, str], Points]:
        try:
            return _pliant.read_map(os.fspath(self.folder))
        except _pliant.Error as error:
            if error.code != "not_found" or self.summary.get("input"):
                raise
            return None, {}, Points(np.empty(0, np.int64), np.empty((0, 3)), np.empty((0, 3), np.uint8))

    @property
    def camera(self) -> _pliant.Camera | None:
        """The camera of the images; None in another program's run, which does not say which images it is of."""
        return self._map[0]

    @property
    def names(self) -> dict[int, str]:
        """The names of the images, by the frame's number; none where they are not known, as the camera."""
        return self._map[1]

    @property
    def points(self) -> Points:
        """The undeformed map; empty where a killed run, or another program's, has none."""
        return self._map[2]

    def frame(self, frame_idx: SupportsIndex) -> Observations:
        """The points of the frame with this number, sorted by point_id; views, not copies; none where
        it has none."""
        column, wanted = self.observations.frame_idx, given.whole(frame_idx, "frame_idx", -2**62, 2**62)
        if not 0 <= wanted < np.iinfo(column.dtype).max:
            return self.observations[:0]
        first, last = np.searchsorted(column, np.array([wanted, wanted + 1], column.dtype))  # no copy of it
        return self.observations[first:last]

    def path(self, point_id: SupportsIndex) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """The way of a point: numbers of the frames that have it (n,), and its positions in them (n, 3), world frame of
        each frame's map, map units; views, of one copy of these columns in the order of the points."""
        ids, frame_idx, position = self._by_point
        wanted = given.whole(point_id, "point_id", -2**62, 2**62)
        first, last = np.searchsorted(ids, [wanted, wanted + 1])
        return frame_idx[first:last], position[first:last]

    @cached_property
    def _by_point(self) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.float64]]:
        """Points, frames and positions of the observations in the order of the points."""
        order = np.argsort(self.observations.point_id, kind="stable")
        return self.observations.point_id[order], self.observations.frame_idx[order], self.observations.position[order]


def open_run(path: str | os.PathLike[str]) -> Run:
    """Opens a run folder.

    Raises pliant.Error with the code not_found (no folder, or no run in it), unreadable (file and line) or mismatch.
    """
    return Run(path)
