# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What a run holds, as columns: NumPy arrays with one row a frame, a pose, an observation or a point."""

from __future__ import annotations

import operator
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, TypeVar, cast

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


Table = TypeVar("Table", bound="_Table")


class _Table:
    """Columns of one length."""

    def columns(self) -> dict[str, NDArray[Any]]:
        """The same as columns of one number a row, by name."""
        raise NotImplementedError

    def to_pandas(self) -> Any:
        """columns() as a pandas.DataFrame; pandas has to be installed."""
        import pandas
        return pandas.DataFrame(self.columns())

    def __repr__(self) -> str:
        return f"<pliant.{type(self).__name__}: {len(self)} rows>"

    def __len__(self) -> int:
        raise NotImplementedError

    def __getitem__(self: Table, rows: Any) -> Table:
        """The rows that a slice, a mask, indices or one index name; of a slice or one index the columns are views."""
        if isinstance(rows, (int, np.integer)):
            idx = operator.index(rows)
            if not -len(self) <= idx < len(self):
                raise IndexError(f"there is no row {idx}; there are {len(self)}")
            rows = slice(idx % len(self), idx % len(self) + 1)
        columns = (getattr(self, field.name) for field in fields(cast(Any, self)))
        return type(self)(*({name: column[rows] for name, column in columns_.items()} if isinstance(columns_, dict)
                            else columns_[rows] for columns_ in columns))


@dataclass(frozen=True, repr=False, eq=False)
class Frames(_Table):
    """Every frame that was read, in order (frames.csv).

    Attributes:
        frame_idx: (F,) int32, number of the frame in its source.
        timestamp: (F,) float64, seconds.
        state: (F,) text: waiting_for_reference, initializing, ambiguous, tracking, provisional or lost. A frame has a
            pose and points in the states tracking and provisional.
        submap: (F,) int32, the map that the frame belongs to; each has a world of its own.
        tracked, optimized, lost, added: (F,) int32, points followed into the frame, of its solution, given up, new.
        median_reprojection_error_px: (F,) float64, pixels; 0 where there is no pose.
        costs: cost terms at the solution, (F,) float64 by name.
        stage_ms: wall time of a stage, ms, (F,) float64 by name.
        latency_ms: wall time from the frame's arrival until it was done, ms, (F,) float64; 0: not measured.
    """

    frame_idx: NDArray[np.int32]
    timestamp: NDArray[np.float64]
    state: NDArray[np.str_]
    submap: NDArray[np.int32]
    tracked: NDArray[np.int32]
    optimized: NDArray[np.int32]
    lost: NDArray[np.int32]
    added: NDArray[np.int32]
    median_reprojection_error_px: NDArray[np.float64]
    costs: dict[str, NDArray[np.float64]]
    stage_ms: dict[str, NDArray[np.float64]]
    latency_ms: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.frame_idx)

    @property
    def has_pose(self) -> NDArray[np.bool_]:
        """(F,) bool: the frames that have a pose and points."""
        return (self.state == "tracking") | (self.state == "provisional")

    def columns(self) -> dict[str, NDArray[Any]]:
        plain = {name: getattr(self, name) for name in (
            "frame_idx", "timestamp", "state", "submap", "tracked", "optimized", "lost", "added",
            "median_reprojection_error_px")}
        return {**plain, **{f"cost_{name}": values for name, values in self.costs.items()},
                **{f"ms_{name}": values for name, values in self.stage_ms.items()}, "latency_ms": self.latency_ms}


@dataclass(frozen=True, repr=False, eq=False)
class Poses(_Table):
    """The camera poses of the frames that have one, in order of time (trajectory.txt).

    Attributes:
        frame_idx: (P,) int32, number of the frame; -1 in another program's run, whose times tell the frame.
        timestamp: (P,) float64, seconds.
        world_from_cam: (P, 4, 4) float64: point_in_world = world_from_cam @ point_in_cam.
        cam_from_world: (P, 4, 4) float64, their inverses.
        submap: (P,) int32, the map whose world it is.
    """

    frame_idx: NDArray[np.int32]
    timestamp: NDArray[np.float64]
    world_from_cam: NDArray[np.float64]
    cam_from_world: NDArray[np.float64]
    submap: NDArray[np.int32]

    def __len__(self) -> int:
        return len(self.frame_idx)

    def columns(self) -> dict[str, NDArray[Any]]:
        columns: dict[str, NDArray[Any]] = {
            "frame_idx": self.frame_idx, "timestamp": self.timestamp, "submap": self.submap}
        for row in range(3):
            for column in range(4):
                columns[f"world_from_cam_{row}{column}"] = self.world_from_cam[:, row, column]
        return columns


@dataclass(frozen=True, repr=False, eq=False)
class Observations(_Table):
    """Points in frames, sorted by frame and point (observations.csv).

    Attributes:
        frame_idx: (N,) int32, number of the frame.
        point_id: (N,) int64, the point.
        pixel: (N, 2) float64, where it was measured, pixels.
        position: (N, 3) float64, where it was in this frame, world frame of the frame's map, map units.
        ssim: (N,) float64, similarity to the point's reference patch, at most 1; NaN: not known.
        sigma: (N,) float64, standard deviation of its distance from the camera, map units; 0: not known.
    """

    frame_idx: NDArray[np.int32]
    point_id: NDArray[np.int64]
    pixel: NDArray[np.float64]
    position: NDArray[np.float64]
    ssim: NDArray[np.float64]
    sigma: NDArray[np.float64]

    def __len__(self) -> int:
        return len(self.point_id)

    def columns(self) -> dict[str, NDArray[Any]]:
        return {"frame_idx": self.frame_idx, "point_id": self.point_id, "u_px": self.pixel[:, 0],
                "v_px": self.pixel[:, 1], "x": self.position[:, 0], "y": self.position[:, 1],
                "z": self.position[:, 2], "ssim": self.ssim, "sigma": self.sigma}


@dataclass(frozen=True, repr=False, eq=False)
class Points(_Table):
    """The undeformed map, as known at the end, of the points that two or more frames show (sparse/).

    Attributes:
        point_id: (M,) int64, growing.
        position: (M, 3) float64, world frame of its map, map units.
        rgb: (M, 3) uint8, red, green, blue.
    """

    point_id: NDArray[np.int64]
    position: NDArray[np.float64]
    rgb: NDArray[np.uint8]

    def __len__(self) -> int:
        return len(self.point_id)

    def columns(self) -> dict[str, NDArray[Any]]:
        return {"point_id": self.point_id, "x": self.position[:, 0], "y": self.position[:, 1],
                "z": self.position[:, 2], "red": self.rgb[:, 0], "green": self.rgb[:, 1], "blue": self.rgb[:, 2]}
