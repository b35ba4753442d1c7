# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Images that come one by one, and that something else counts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

END = object()


class CountedImages:
    """The images of an iterable, by their numbers. Each is taken when it is asked for, and kept: tracking goes back."""

    def __init__(self, images: Iterable[Any], count: int, what: str):
        """There are `count` of `what`, one an image. Whether that is right is known at the end of the images."""
        self._images = iter(images)
        self._count = count
        self._what = f"there are {count} {what}"
        self._kept: list[Any] = []

    def __len__(self) -> int:
        return self._count

    def __getitem__(self, idx: int) -> Any:
        while len(self._kept) <= idx:
            image = next(self._images, END)
            if image is END:
                raise ValueError(f"{self._what} for {len(self._kept)} images; each image needs one")
            # The program may use its memory again.
            self._kept.append(image.copy() if isinstance(image, np.ndarray) else image)
            if len(self._kept) == self._count and next(self._images, END) is not END:
                raise ValueError(f"{self._what}, and more images; each image needs one")
        return self._kept[idx]


def counted(images: Any, count: int, what: str) -> Any:
    """The images with a length, where they have none themselves. Raises ValueError where there are not as many."""
    if hasattr(images, "__len__") and hasattr(images, "__getitem__"):
        if len(images) not in (0, count):  # none at all are refused where they are read
            raise ValueError(f"there are {count} {what} for {len(images)} images; each image needs one")
        return images
    if count == 0:
        raise ValueError(f"there are 0 {what}; each image needs one")
    return CountedImages(images, count, what)
