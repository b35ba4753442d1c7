# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images that come one by one, and as many times."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

END = object()


class TimedImages:
    """The images of an iterable, by their numbers. Each is taken when it is asked for, and kept: tracking goes back."""

    def __init__(self, images: Iterable[Any], timestamps: int):
        """timestamps: how many there are. The images have to be as many, which is known at their end."""
        self._images = iter(images)
        self._timestamps = timestamps
        self._kept: list[Any] = []

    def __len__(self) -> int:
        return self._timestamps

    def __getitem__(self, idx: int) -> Any:
        while len(self._kept) <= idx:
            image = next(self._images, END)
            if image is END:
                raise ValueError(f"there are {self._timestamps} timestamps for {len(self._kept)} images; each image "
                                 "needs one")
            # The program may use its memory again.
            self._kept.append(image.copy() if isinstance(image, np.ndarray) else image)
            if len(self._kept) == self._timestamps and next(self._images, END) is not END:
                raise ValueError(f"there are {self._timestamps} timestamps, and more images; each image needs one")
        return self._kept[idx]


def timed(images: Any, timestamps: list[float]) -> Any:
    """The images with a length, where there are times and the images alone do not tell how many they are."""
    has_length = hasattr(images, "__len__") and hasattr(images, "__getitem__")
    if not timestamps or has_length or not isinstance(images, Iterable):
        return images
    return TimedImages(images, len(timestamps))
