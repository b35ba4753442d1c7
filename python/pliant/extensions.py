# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""First maps, point tracks and cost terms that are written in Python, for pliant.track and pliant.Tracker.

Pixels are those of the images that points are tracked in (run.json: working_image): the given ones, resized and
smoothed as they were measured to be tracked best in. {"Image.working": "fixed"} leaves them as they are.
"""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Protocol, Union

import numpy as np

from . import _pliant
from . import arguments as given
from .options import options

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray


class FollowedFrame(NamedTuple):
    """A frame since the reference, and the points that are seen in it."""

    frame_idx: int
    point_id: NDArray[np.int64]  # (N,), ascending
    pixel: NDArray[np.float64]   # (N, 2)


class TrackedImage(NamedTuple):
    """An image that points are followed in."""

    frame_idx: int
    timestamp: float       # seconds
    gray: NDArray[np.uint8]  # (height, width)


@dataclass
class Wait:
    """No map yet: more frames are needed. `reason` is a sentence, for the frame's note."""

    reason: str = "the initializer waits"


@dataclass
class NewReference:
    """No map from this reference: the present frame becomes the next one."""

    reason: str = "the initializer wants another reference"


@dataclass
class FirstMap:
    """A map: its points stand still in the frames since the reference.

    It is scaled, once, so that the median depth in the reference is Init.nominal_depth_mm. Points that were followed
    and are not in it may join it later.
    """

    point_id: ArrayLike         # (M,)
    position: ArrayLike         # (M, 3), in the world, which is the camera of the reference
    # (F, 4, 4), of every frame since the reference; the first is the identity. Frames between the first and the last
    # may be NaN: their poses are then estimated by the points.
    cam_from_world: ArrayLike
    sigma: ArrayLike | None = None  # (M,), standard deviation of the depth, in the unit of position; None: not known
    provisional: bool = False   # its frames get the state provisional
    reason: str = ""            # a sentence, for the note


Answer = Union[FirstMap, Wait, NewReference, None]
# Called in every frame with all frames since the reference (the first of the list; the last is the present one), their
# camera, and whether no frame follows. None: wait.
Initializer = Callable[["list[FollowedFrame]", _pliant.Camera, bool], Answer]


class PointFollower(Protocol):
    """Where points are in the next image."""

    def follow(self, previous: TrackedImage, image: TrackedImage, pixel: NDArray[np.float64],
               predicted: NDArray[np.float64]) -> tuple[ArrayLike, ArrayLike]:
        """
        Args:
            previous, image: from one image into another one; they need not follow each other.
            pixel: (N, 2), of points in `previous`.
            predicted: (N, 2), where the map expects them in `image`.

        Returns:
            Their pixels in `image`, (N, 2), and whether they are seen there, (N,).
        """


class CostFrame(NamedTuple):
    """What a cost term is asked about: the points of one frame, and where they are tried.

    Points that do not project under the initial pose are not in it. All is in the world of the frame's map, in map
    units (millimeters after a metric start).
    """

    frame_idx: int
    point_id: NDArray[np.int64]     # (N,), ascending; in pliant.kernels.solve_frame the rows of `positions`
    position: NDArray[np.float64]   # (N, 3), where they are tried
    previous: NDArray[np.float64]   # (N, 3), in the frame before
    pixel: NDArray[np.float64]      # (N, 2), where they are seen, of the images that points are tracked in
    edges: NDArray[np.int32]        # (E, 2), of the deformation graph: rows of the columns above, the smaller one first
    weight: NDArray[np.float64]     # (E,), of the edges, 0 to 1
    rest_length: NDArray[np.float64]  # (E,), of the edges in the undeformed map
    cam_from_world: NDArray[np.float64]  # (4, 4), where the search for the pose starts


class Cost(Protocol):
    """A term that is added to the joint problem of every frame: half the sum of squares of its residuals.

    docs/method.md, E5. It depends on the camera's pose only through the points.
    """

    def evaluate(self, frame: CostFrame) -> tuple[ArrayLike, Any]:
        """The residuals and their derivatives; called again and again while a frame is solved.

        The residuals are (R,), finite, in units of their standard deviations; R is the same in all calls of a frame.
        Their derivatives by frame.position.reshape(-1) are (R, 3N): an array, a sparse matrix of SciPy, or a tuple
        (row, column, value) of three arrays (K,), whose entries of the same place add up.
        """


_initializers: dict[str, Initializer] = {}
_tracks: dict[str, Callable[[], PointFollower]] = {}
_costs: dict[str, Cost] = {}


def register_initializer(name: str, initializer: Initializer) -> None:
    """Makes {"Init.method": name} in the options of pliant.track and pliant.Tracker stand for this function.

    Raises ValueError for the name of a method that Pliant has.
    """
    if not callable(initializer):
        raise TypeError(f"the initializer {name!r} cannot be called; give a function of frames, camera and is_last")
    if name in options("track").unit["Init.method"].split(" | "):
        raise ValueError(f"{name!r} is a method of Pliant; give your initializer another name")
    _initializers[name] = initializer


def register_tracks(name: str, make: Callable[[], PointFollower]) -> None:
    """Makes tracks=name of pliant.track and pliant.Tracker stand for what this function makes, anew for every run.

    A class will do. A file of tracks whose path is the name is given as a pathlib.Path then.
    """
    if not callable(make):
        raise TypeError(f"the tracks {name!r} cannot be made; give a function without arguments, or a class, which "
                        "makes an object with a method follow")
    _tracks[name] = make


def registered_tracks(tracks: Any) -> Any:
    """What the function that is registered under a name makes; anything else as it is."""
    if not isinstance(tracks, str):
        return tracks
    if tracks not in _tracks:
        if _tracks and not os.path.exists(tracks):
            raise ValueError(f"there is no file of tracks at {tracks!r}, and no tracks of that name (registered: "
                             f"{', '.join(sorted(_tracks))}); pliant.register_tracks gives them theirs")
        return tracks
    made = _tracks[tracks]()
    if not callable(getattr(made, "follow", None)):
        raise TypeError(f"what is registered as the tracks {tracks!r} made a {type(made).__name__}; give a function that "
                        "makes an object with a method follow")
    return made


def register_cost(name: str, cost: Cost) -> None:
    """Makes cost=name of pliant.track and pliant.Tracker stand for this object.

    The term's value is the column cost_<name> of frames.csv. Raises ValueError for a name that is not made of letters,
    digits and underscores, or that a term of Pliant has.
    """
    _coster(cost)
    if not re.fullmatch(r"[A-Za-z0-9_]+", name):
        raise ValueError(f"{name!r} names a column of frames.csv; give your cost a name of letters, digits and _")
    if name in _pliant.cost_names():
        raise ValueError(f"{name!r} is a term of Pliant; give your cost another name")
    _costs[name] = cost


def _real(values: Any, what: str) -> NDArray[Any]:
    """As floats; the imaginary part of complex numbers would be lost."""
    array = np.asarray(values)
    if array.dtype.kind == "c":
        raise TypeError(f"a cost returned complex numbers as its {what}; give real ones")
    return np.asarray(array, dtype=float)


def _triplets(jacobian: Any, rows: int, columns: int) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """The entries (row, column, value) of a Jacobian, checked."""
    if isinstance(jacobian, tuple):
        if len(jacobian) != 3:
            raise ValueError(f"the jacobian of a cost is a tuple of {len(jacobian)}; give (row, column, value)")
        row, column, value = (np.asarray(part) for part in jacobian)
        if not row.shape == column.shape == value.shape or row.ndim != 1:
            raise ValueError("row, column and value of the jacobian of a cost have to be three arrays (K,) of one "
                             f"length; these are {row.shape}, {column.shape} and {value.shape}")
        if row.size and (row.dtype.kind not in "iu" or column.dtype.kind not in "iu"):
            raise TypeError("row and column of the jacobian of a cost are whole numbers; these are "
                            f"{row.dtype} and {column.dtype}")
        if row.size and (min(row.min(), column.min()) < 0 or row.max() >= rows or column.max() >= columns):
            raise ValueError(f"the jacobian of a cost has entries outside of its shape ({rows}, {columns})")
    else:
        sparse = callable(getattr(jacobian, "tocoo", None))
        whole = jacobian if sparse else _real(jacobian, "jacobian")
        if whole.shape != (rows, columns):
            raise ValueError(f"the jacobian of a cost has the shape {whole.shape}, and {rows} residuals of "
                             f"{columns // 3} points need ({rows}, {columns})")
        if sparse:
            entries = whole.tocoo()
            row, column, value = entries.row, entries.col, entries.data
        else:
            row, column = np.nonzero(whole)
            value = whole[row, column]
    return row.astype(np.int32), column.astype(np.int32), _real(value, "jacobian")


def _coster(cost: Cost) -> Callable[..., tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]]:
    """What the library calls."""
    evaluate: Any = getattr(cost, "evaluate", None)
    if not callable(evaluate):
        raise TypeError(f"a cost is a {type(cost).__name__}; give an object with a method evaluate, or the name of a "
                        "registered one")

    last: dict[bytes, int] = {}  # of the present frame, how many residuals it has

    def call(*columns: Any) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any], NDArray[Any]]:
        frame = CostFrame(*columns)
        answer = evaluate(frame)
        if not isinstance(answer, tuple) or len(answer) != 2:
            raise TypeError(f"evaluate of a cost returns (residuals, jacobian); this one returned "
                            f"{type(answer).__name__}")
        residuals = _real(answer[0], "residuals")
        if residuals.ndim != 1:
            raise ValueError(f"the residuals of a cost have the shape {residuals.shape}; give (R,)")
        problem = frame.point_id.tobytes() + frame.cam_from_world.tobytes()
        if last.get(problem, len(residuals)) != len(residuals):
            raise ValueError(f"a cost returned {last[problem]} residuals and then {len(residuals)} in the same frame; the "
                             "number is the same in all calls of a frame")
        last.clear()
        last[problem] = len(residuals)
        row, column, value = _triplets(answer[1], len(residuals), 3 * len(frame.position))
        if not np.all(np.isfinite(residuals)) or not np.all(np.isfinite(value)):
            raise ValueError("a cost returned a residual or a derivative that is not a finite number")
        return residuals, row, column, value

    return call


def chosen_cost(cost: Cost | str | None) -> dict[str, Any]:
    """What the library calls, and its name."""
    if cost is None:
        return {"cost": None, "cost_name": ""}
    if not isinstance(cost, str):
        return {"cost": _coster(cost), "cost_name": "python"}
    if cost not in _costs:
        known = ", ".join(sorted(_costs)) or "none"
        raise ValueError(f"there is no cost {cost!r} (registered: {known}); pliant.register_cost gives it its name")
    return {"cost": _coster(_costs[cost]), "cost_name": cost}


def asker(initializer: Initializer) -> Callable[[list[Any], _pliant.Camera, bool], dict[str, Any]]:
    """What the library calls: tuples in, a dictionary out."""

    if not callable(initializer):
        raise TypeError(f"initializer is a {type(initializer).__name__}; give a function of frames, camera and is_last, "
                        "or the name of a registered one")

    def ask(frames: list[Any], camera: _pliant.Camera, is_last: bool) -> dict[str, Any]:
        answer = initializer([FollowedFrame(*frame) for frame in frames], camera, is_last)
        if answer is None:
            answer = Wait()
        if isinstance(answer, (Wait, NewReference)):
            decision = "wait" if isinstance(answer, Wait) else "new_reference"
            return {"decision": decision, "reason": str(answer.reason)}
        if not isinstance(answer, FirstMap):
            raise TypeError("an initializer returns pliant.FirstMap, pliant.Wait, pliant.NewReference or None; this "
                            f"one returned {type(answer).__name__}")
        point_id = np.asarray(answer.point_id)
        if point_id.size and point_id.dtype.kind not in "iu":
            raise TypeError(f"point_id of a map are whole numbers; these are {point_id.dtype}")
        sigma = None if answer.sigma is None else np.asarray(answer.sigma, dtype=float).reshape(-1)
        return {"decision": "map", "reason": str(answer.reason), "point_id": point_id,
                "position": np.asarray(answer.position), "cam_from_world": np.asarray(answer.cam_from_world),
                "sigma": sigma, "provisional": bool(answer.provisional)}

    return ask


def follower(tracks: PointFollower) -> Callable[[Any, Any, Any, Any], tuple[NDArray[Any], NDArray[Any]]]:
    """What the library calls."""
    follow: Any = getattr(tracks, "follow", None)
    if not callable(follow):
        raise TypeError(f"tracks is a {type(tracks).__name__}; give an object with a method follow, the path of a "
                        "file, or arrays as a pair (tracks, visibility)")

    def call(previous: Any, image: Any, pixel: Any, predicted: Any) -> tuple[NDArray[Any], NDArray[Any]]:
        answer = follow(TrackedImage(*previous), TrackedImage(*image), pixel, predicted)
        if not isinstance(answer, (tuple, list)) or len(answer) != 2:
            raise TypeError(f"follow returns (pixels, visible); this one returned {type(answer).__name__}"
                            f"{f' of {len(answer)}' if isinstance(answer, (tuple, list)) else ''}")
        seen = np.asarray(answer[1])
        if seen.dtype.kind not in "biu" or (seen.dtype.kind != "b" and not np.isin(seen, (0, 1)).all()):
            raise TypeError(f"follow returns visible as True and False; these are {seen.dtype}. Of scores say from which "
                            "on a point is seen")
        return np.asarray(answer[0]), seen.astype(bool)

    return call


def _initializer_named(name: str) -> Initializer:
    if name not in _initializers:
        known = ", ".join(sorted(_initializers)) or "none"
        raise ValueError(f"there is no initializer {name!r} (registered: {known}); pliant.register_initializer gives it "
                         "its name")
    return _initializers[name]


def chosen(values: Any, initializer: Initializer | str | None, tracks: Any,
           cost: Cost | str | None) -> tuple[Any, dict[str, Any]]:
    """The options without a name that is registered, and what the library calls."""
    name = "python"
    method = values.get("Init.method") if isinstance(values, dict) else None
    if isinstance(initializer, str):
        name, initializer = initializer, _initializer_named(initializer)
    known = options("track").unit["Init.method"]
    if isinstance(method, str) and method not in known.split(" | ") and _initializers:
        if method not in _initializers:
            raise ValueError(f"Init.method is {method!r}; give one of {known}, or one that is registered: "
                             f"{', '.join(sorted(_initializers))}")
        if initializer is not None:
            raise ValueError("there is an initializer, and Init.method names another one; give one of them")
        values = {key: value for key, value in values.items() if key != "Init.method"}
        name, initializer = method, _initializers[method]
    if tracks is not None and isinstance(values, dict) and values.get("TrackFile.path"):
        raise ValueError("there are tracks, and TrackFile.path names a file of others; give one of them")
    return values, {"initializer": None if initializer is None else asker(initializer), "initializer_name": name,
                    "tracks": None if tracks is None else follower(tracks), **chosen_cost(cost)}
