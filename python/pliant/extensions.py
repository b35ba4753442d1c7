# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""First maps and point tracks that are written in Python, for pliant.track and pliant.Tracker.

Pixels are those of the images that points are tracked in (run.json: working_image): the given ones, resized and
smoothed as they were measured to be tracked best in. {"Image.working": "fixed"} leaves them as they are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, NamedTuple, Protocol, Union

import numpy as np

from . import _pliant
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


_initializers: dict[str, Initializer] = {}


def register_initializer(name: str, initializer: Initializer) -> None:
    """Makes {"Init.method": name} in the options of pliant.track and pliant.Tracker stand for this function.

    Raises ValueError for the name of a method that Pliant has.
    """
    if not callable(initializer):
        raise TypeError(f"the initializer {name!r} cannot be called; give a function of frames, camera and is_last")
    if name in options("track").unit["Init.method"].split(" | "):
        raise ValueError(f"{name!r} is a method of Pliant; give your initializer another name")
    _initializers[name] = initializer


def asker(initializer: Initializer) -> Callable[[list[Any], _pliant.Camera, bool], dict[str, Any]]:
    """What the library calls: tuples in, a dictionary out."""

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
    follow = getattr(tracks, "follow", None)
    if not callable(follow):
        raise TypeError(f"tracks is a {type(tracks).__name__}; give an object with a method follow, or the path of a "
                        "file")

    def call(previous: Any, image: Any, pixel: Any, predicted: Any) -> tuple[NDArray[Any], NDArray[Any]]:
        pixels, seen = follow(TrackedImage(*previous), TrackedImage(*image), pixel, predicted)
        return np.asarray(pixels), np.asarray(seen)

    return call


def chosen(options: Any, initializer: Initializer | None, tracks: Any) -> tuple[Any, dict[str, Any]]:
    """The options without a name that is registered, and what the library calls."""
    name = "python"
    method = options.get("Init.method") if isinstance(options, dict) else None
    if isinstance(method, str) and method in _initializers:
        if initializer is not None:
            raise ValueError("there is an initializer, and Init.method names another one; give one of them")
        options = {key: value for key, value in options.items() if key != "Init.method"}
        name, initializer = method, _initializers[method]
    return options, {"initializer": None if initializer is None else asker(initializer), "initializer_name": name,
                     "tracks": None if tracks is None else follower(tracks)}
