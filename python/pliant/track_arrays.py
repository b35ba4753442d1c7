# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracks of another program as arrays, for what reads them from a file."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any, Union

import numpy as np

from . import _pliant
from . import arguments as given

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

TrackArrays = Union["Sequence[ArrayLike]", "Mapping[str, ArrayLike]"]  # of two: tracks and visibility
ARRAYS = ("tracks", "visibility", "sigma_px", "track_id")
WANTED = "give a pair (tracks, visibility), (frames, points, 2) and (frames, points)"
FILE_NAME = "given_arrays.npz"  # run.json and config.yaml name it
# What sentences say of the file, in place of its path.
WORDS = (("the tracks in {}", "the given tracks"), ("the arrays in {}", "the given arrays"), ("{}", "the given arrays"))


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
        unknown = [str(name) for name in tracks if name not in ARRAYS]
        if unknown and not isinstance(tracks, np.lib.npyio.NpzFile):  # whose other arrays are passed over, as of a path
            raise ValueError(f"the tracks have an array {unknown[0]!r}, which is not known; the names are "
                             f"{', '.join(ARRAYS)}")
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
        kind = f"of {array.dtype}" if isinstance(value, np.ndarray) else f"a {type(value).__name__}"
        raise TypeError(f"the array {name!r} is {kind}, not of real numbers; {WANTED}")
    if isinstance(value, np.ma.MaskedArray) and np.any(value.mask):
        raise ValueError(f"the array {name!r} has masked entries, which a file of tracks has not; give a plain array, and "
                         "set visibility to False there")
    return array


def _refuse_empty(arrays: Mapping[str, Any]) -> None:
    shape = arrays["tracks"].shape
    reason = ""
    if len(shape) > 2 and shape[-1] == 2 and 0 in shape:
        reason = f"tracks has the shape {shape}"
    elif arrays["visibility"].size and not arrays["visibility"].any():
        reason = "all of visibility is False"
    if reason:
        raise given.error("insufficient", f"the given arrays have no point that is seen in a frame: {reason}")


def frames_of(tracks: Any) -> int:
    """How many frames arrays have; 0 of anything else, and of arrays of another shape."""
    if not are_arrays(tracks):
        return 0
    shape = _array(_named(tracks)["tracks"], "tracks").shape
    return int(shape[-3]) if len(shape) > 2 else 0


def without_path(text: str, path: str) -> str:
    """A sentence that names the arrays in place of their file."""
    for words, said in WORDS:
        text = text.replace(words.format(f"'{path}'"), said).replace(words.format(path), said)
    return text


@contextmanager
def file_of(tracks: Any) -> Iterator[str]:
    """The path of a file of tracks, also of arrays: theirs is there as long as the block, and exceptions in it do not
    name it. "" for None."""
    if not are_arrays(tracks):
        if tracks is not None and not isinstance(tracks, (str, os.PathLike)):
            raise given.wrong(tracks, "tracks", "the path of a file, or arrays as a pair (tracks, visibility)")
        yield given.optional_path(tracks, "tracks")
        return
    arrays = {name: _array(value, name) for name, value in _named(tracks).items()}
    _refuse_empty(arrays)
    with tempfile.TemporaryDirectory(prefix="pliant_") as folder:
        path = os.path.join(folder, FILE_NAME)
        np.savez(path, **arrays)
        try:
            yield path
        except (_pliant.Error, ValueError, UserWarning) as error:
            error.args = tuple(without_path(part, path) if isinstance(part, str) else part for part in error.args)
            raise
