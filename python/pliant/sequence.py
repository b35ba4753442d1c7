# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The images of a folder, a video or a data set, with their truth where there is truth."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsIndex

import numpy as np

from . import _pliant
from . import arguments as given

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .jobs import StrPath


class SequenceFrame(NamedTuple):
    """One frame of a sequence."""

    frame_idx: int
    name: str
    timestamp: float                     # seconds
    image: NDArray[np.uint8]             # (height, width), or (height, width, 3) in the order blue, green, red
    mask: NDArray[np.uint8] | None       # (height, width), 0: ignore this pixel; None: no mask
    right: NDArray[np.uint8] | None      # right image of a rectified pair


class Sequence:
    """A sequence that can be iterated over, again and again: every iteration reads it from its first frame. It can be
    given to pliant.track.

    Attributes:
        path: where it is.
        camera: its pliant.Camera.
        baseline_mm: distance of the cameras of a rectified pair; None: there are no pairs.
    """

    def __init__(self, path: str, request: dict[str, Any]):
        self.path = path
        self.request = request
        self._source = _pliant.SequenceSource({"image_path": path, **request})
        self.camera: _pliant.Camera = self._source.camera
        self.baseline_mm: float | None = self._source.baseline_mm

    def __repr__(self) -> str:
        return f"<pliant.Sequence {self.path}: {len(self)} frames of {self.camera.width}x{self.camera.height} pixels>"

    def __reduce__(self) -> tuple[Any, ...]:
        """A copy, also one in another process, opens the sequence again."""
        return type(self), (self.path, self.request)

    def __len__(self) -> int:
        """How many frames there are; of a video what its container says."""
        return self._source.size

    def __iter__(self) -> Iterator[SequenceFrame]:
        reader = self._source.begin()
        while (frame := reader.next()) is not None:
            yield SequenceFrame(*frame)

    def depth(self, frame_idx: SupportsIndex) -> NDArray[np.float32] | None:
        """(height, width), z along the optical axis in mm, 0: none there; None where the sequence has no depth."""
        return self._source.depth(given.whole(frame_idx, "frame_idx"))

    def world_from_cam(self, frame_idx: SupportsIndex) -> NDArray[np.float64] | None:
        """(4, 4), the true pose; None where the sequence has none."""
        return self._source.world_from_cam(given.whole(frame_idx, "frame_idx"))


def sequence_request(mask_path: StrPath | None, start: SupportsIndex, end: SupportsIndex | None,
                     stride: SupportsIndex) -> dict[str, Any]:
    """What the library is asked for beside the images and their camera."""
    first, last = given.whole(start, "start"), None if end is None else given.whole(end, "end")
    if last is not None and last <= first:
        raise ValueError(f"end is {last} and start is {first}; end is one past the last frame, or None for all")
    return {"start": first, "end": -1 if last is None else last, "stride": given.whole(stride, "stride"),
            **given.files(mask=mask_path)}


def open_sequence(path: StrPath, *, camera: StrPath | None = None, mask_path: StrPath | None = None,
                  start: SupportsIndex = 0, end: SupportsIndex | None = None,
                  stride: SupportsIndex = 1) -> Sequence:
    """A folder of images, a video or a data set (docs/datasets.md), read as pliant.track reads it.

    Args:
        path: where it is.
        camera: calibration file; None: the one that belongs to the images.
        mask_path: folder of masks, or one image for all frames.
        start, end, stride: the first frame, one past the last one (None: to the end), and every which frame.

    Raises pliant.Error where it cannot be read, also while it is iterated over.
    """
    return Sequence(given.path(path, "path"),
                    {"camera_path": given.camera_path(camera), **sequence_request(mask_path, start, end, stride)})
