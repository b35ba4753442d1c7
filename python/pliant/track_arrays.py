# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of another program as arrays, for what reads them from a file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import arguments as given

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

TrackArrays = Union["tuple[ArrayLike, ArrayLike]", "Mapping[str, ArrayLike]"]
ARRAYS = ("tracks", "visibility", "sigma_px", "track_id")
WANTED = "give a pair (tracks, visibility), (frames, points, 2) and (frames, points)"


def are_arrays(tracks: Any) -> bool:
    """A pair (tracks, visibility), or arrays by name, such as np.load gives of an .npz."""
    return isinstance(tracks, (tuple, list, Mapping)) and not callable(getattr(tracks, "follow", None))


def are_recorded(tracks: Any) -> bool:
    """A file of tracks, or arrays."""
    return isinstance(tracks, (str, os.PathLike)) or are_arrays(tracks)


def _named(tracks: Any) -> dict[str, Any]:
    if isinstance(tracks, Mapping):
        if "tracks" not in tracks or "visibility" not in tracks:
            raise ValueError(f"the tracks have the arrays {', '.join(map(str, tracks)) or 'none'}; name them tracks "
                             "(frames, points, 2) and visibility (frames, points)")
        return {name: tracks[name] for name in ARRAYS if name in tracks}
    if len(tracks) != 2:
        raise ValueError(f"tracks is a {type(tracks).__name__} of {len(tracks)}; {WANTED}")
    return dict(zip(ARRAYS, tracks))


def _array(value: Any, name: str) -> Any:
    try:
        array = np.asarray(value)
    except ValueError:  # lists of several lengths
        array = np.asarray(None)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name} of the tracks is no array of numbers; {WANTED}")
    return array


def frames_of(tracks: Any) -> int:
    """How many frames arrays have; 0 of anything else, and of arrays of another shape."""
    if not are_arrays(tracks):
        return 0
    shape = _array(_named(tracks)["tracks"], "tracks").shape
    return int(shape[-3]) if len(shape) > 2 else 0


@contextmanager
def file_of(tracks: Any) -> Iterator[str]:
    """The path of a file of tracks, also of arrays: theirs is there as long as the block. "" for None."""
    if not are_arrays(tracks):
        yield given.optional_path(tracks, "tracks")
        return
    arrays = {name: _array(value, name) for name, value in _named(tracks).items()}
    with tempfile.TemporaryDirectory(prefix="pliant_") as folder:
        path = os.path.join(folder, "tracks.npz")
        np.savez(path, **arrays)
        yield path
