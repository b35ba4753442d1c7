# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Tracking of images as they come."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from . import _pliant
from . import arguments as given
from .extensions import Cost, Initializer, PointFollower, chosen, registered_tracks
from .track_arrays import are_recorded

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Tracker(_pliant.Tracker):
    """Tracks images as they come, without a run folder.

    Frames before the reference of the first map stay without a pose: pliant.track, which can read images again, tracks
    them back in time. Pixels of reports are those of the given images.
    """

    def __init__(self, camera: _pliant.Camera, options: Mapping[str, Any] | None = None, *, preset: str = "default",
                 examples: Iterable[NDArray[np.uint8]] = (), initializer: Initializer | str | None = None,
                 tracks: PointFollower | str | None = None, cost: Cost | str | None = None):
        """
        Args:
            camera: of the images.
            options, preset: as of pliant.track.
            examples: images that follow each other (16 are enough) as the camera will see them, by which the size and
                smoothing of the images that points are tracked in are chosen, as pliant.track does; without them the
                images are taken as they are, or as Image.scale and Image.smoothing_px say where Image.working is
                "fixed".
            initializer, tracks, cost: as of pliant.track, but for tracks of a file or of arrays. They are called in
                process() and finish(), in the thread that calls these. An exception in them is raised there, and the
                tracker is finished: it takes no more images.

        Raises:
            ValueError: options that need more than images (a start from depth, for example).
        """
        tracks = registered_tracks(tracks)
        if are_recorded(tracks):
            raise ValueError("tracks of a file or of arrays are of a sequence's frames; give them to pliant.track")
        if not isinstance(examples, Iterable):
            raise TypeError(f"examples is a {type(examples).__name__}; give a list of images")
        chosen_options, extensions = chosen(given.options(options), initializer, tracks, cost)
        self._extensions = extensions  # which the library calls as long as this lives
        super().__init__(given.camera(camera), chosen_options, given.text(preset, "preset"), examples, extensions)
