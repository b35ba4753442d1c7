# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""A recording, and what is done to it: other light, noise, order of frames, field of view."""
import dataclasses
from collections.abc import Callable, Sequence

import cv2
import numpy as np

LAST_LEVEL = 255
SEED = 1  # of noise and of frames that are lost


@dataclasses.dataclass(frozen=True)
class Recording:
    """Images in their order, with what belongs to their pixels. The camera is a pinhole; (0, 0) is the center of the
    first pixel. Points of structure from motion are rows of frame, u, v and depth."""

    image: Callable[[int], np.ndarray]
    frames: int
    params: tuple  # fx, fy, cx, cy
    fps: float
    mask: np.ndarray | None
    points: np.ndarray

    def with_images(self, change):
        """The same with every image changed; change takes the image and the number of its frame."""
        return dataclasses.replace(self, image=lambda frame: change(self.image(frame), frame))

    def in_order(self, order: Sequence[int], fps=None):
        """Its frames in another order, in which some may be missing or come again."""
        of_frame = {}
        for row in self.points:
            of_frame.setdefault(int(row[0]), []).append(row[1:])
        points = [(k, *row) for k, frame in enumerate(order) for row in of_frame.get(frame, ())]
        return dataclasses.replace(self, image=lambda k: self.image(order[k]), frames=len(order),
                                   fps=fps or self.fps, points=np.array(points).reshape(-1, 4))

    def with_pixels(self, change, u, v, params):
        """The same with every image and the mask warped by change; u and v are the new coordinates of its points."""
        points = np.column_stack((self.points[:, 0], u, v, self.points[:, 3]))
        mask = None if self.mask is None else change(self.mask)
        return dataclasses.replace(self, image=lambda frame: change(self.image(frame)), params=params, mask=mask,
                                   points=points)


def levels(values):
    return np.clip(np.rint(values), 0, LAST_LEVEL).astype(np.uint8)


def darker(image, gamma=1.8, share=0.6):
    return cv2.LUT(image, levels(LAST_LEVEL * share * np.linspace(0, 1, LAST_LEVEL + 1) ** gamma))


def noisy(image, frame, sigma=12.0):
    return levels(image + np.random.default_rng([SEED, frame]).normal(0, sigma, image.shape))


def worse_from_the_middle(recording):
    """The light is turned down and the gain up."""
    middle = recording.frames // 2
    return recording.with_images(
        lambda image, frame: noisy(darker(image, 1.0, 0.5), frame, 8.0) if frame >= middle else image)


def compressed(image, quality):
    return cv2.imdecode(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1], cv2.IMREAD_COLOR)


def hazy(image, _):
    return levels(0.55 * image + 0.45 * 190)


def flickering(image, frame):
    return levels(image * (1 + 0.25 * np.sin(2 * np.pi * frame / 7)))


def in_a_circle(image, _):
    height, width = image.shape[:2]
    inside = np.zeros((height, width), np.uint8)
    cv2.circle(inside, (width // 2, height // 2), int(0.48 * height), 1, -1)
    return image * inside[..., None]


def with_an_overlay(image, frame):
    """A box with text, a clock, and a line of text below."""
    changed = image.copy()
    height, width = image.shape[:2]
    size = width / 1000
    cv2.rectangle(changed, (0, 0), (width // 5, height // 5), (60, 40, 40), -1)
    for text, x, y in ((f"ID 4711  {frame // 25:02d}:{frame % 25:02d}", 0.01, 0.08),
                       ("GAIN +6 dB  ENH A3  SPECTRAL OFF", 0.3, 0.96)):
        cv2.putText(changed, text, (int(x * width), int(y * height)), cv2.FONT_HERSHEY_SIMPLEX, 0.7 * size,
                    (240, 240, 240), max(1, round(2 * size)), cv2.LINE_AA)
    return changed


def interlaced(recording):
    """Pairs of frames in one, the second in the odd rows."""
    def pair(image, k):
        changed = image.copy()
        changed[1::2] = recording.image(2 * k + 1)[1::2]
        return changed

    first = recording.in_order(range(0, recording.frames - 1, 2), recording.fps / 2)
    return first.with_images(pair)


def wiped(recording):
    """The lens is wiped: ten black frames in the middle."""
    middle = recording.frames // 2
    return recording.with_images(lambda image, frame: 0 * image if middle <= frame < middle + 10 else image)


def lost_frames(recording):
    kept = np.random.default_rng(SEED).random(recording.frames) > 0.1
    return recording.in_order([int(k) for k in np.flatnonzero(kept)])


def resized(recording, share):
    """A pixel is mapped with its center, so half of a pixel is not scaled."""
    fx, fy, cx, cy = recording.params
    return recording.with_pixels(
        lambda image: cv2.resize(image, None, fx=share, fy=share, interpolation=cv2.INTER_AREA),
        *(share * (recording.points[:, i] + 0.5) - 0.5 for i in (1, 2)),
        (share * fx, share * fy, share * (cx + 0.5) - 0.5, share * (cy + 0.5) - 0.5))


def cut(recording):
    """A quarter of its width and height is cut off, from the right and from below."""
    fx, fy, cx, cy = recording.params
    kept = recording.with_pixels(lambda image: image[:3 * image.shape[0] // 4, :3 * image.shape[1] // 4],
                                 recording.points[:, 1], recording.points[:, 2], (fx, fy, cx, cy))
    height, width = kept.image(0).shape[:2]
    inside = (kept.points[:, 1] < width - 0.5) & (kept.points[:, 2] < height - 0.5)
    return dataclasses.replace(kept, points=kept.points[inside])


def turned(recording):
    """By 90 degrees, clockwise."""
    fx, fy, cx, cy = recording.params
    last = recording.image(0).shape[0] - 1
    return recording.with_pixels(lambda image: np.ascontiguousarray(np.rot90(image, -1)),
                                 last - recording.points[:, 2], recording.points[:, 1], (fy, fx, last - cy, cx))


def with_bars(recording, bar=100):
    """Black to the left and to the right, as a 4:3 image in a 16:9 video has it."""
    fx, fy, cx, cy = recording.params
    return recording.with_pixels(
        lambda image: cv2.copyMakeBorder(image, 0, 0, bar, bar, cv2.BORDER_CONSTANT, value=0),
        recording.points[:, 1] + bar, recording.points[:, 2], (fx, fy, cx + bar, cy))


CHANGES = {
    "as it is": lambda recording: recording,
    "backwards": lambda recording: recording.in_order(range(recording.frames - 1, -1, -1)),
    "every frame twice": lambda recording: recording.in_order([k // 2 for k in range(2 * recording.frames)],
                                                              2 * recording.fps),
    "a tenth of the frames lost": lost_frames,
    "ten black frames": wiped,
    "interlaced": interlaced,
    "half of the size": lambda recording: resized(recording, 0.5),
    "three quarters of the view": cut,
    "turned by 90 degrees": turned,
    "black bars": with_bars,
    "round field of view": lambda recording: recording.with_images(in_a_circle),
    "text and a box burned in": lambda recording: recording.with_images(with_an_overlay),
    "gray": lambda recording: recording.with_images(
        lambda image, _: cv2.cvtColor(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), cv2.COLOR_GRAY2BGR)),
    "darker": lambda recording: recording.with_images(lambda image, _: darker(image)),
    "overexposed": lambda recording: recording.with_images(lambda image, _: levels(1.6 * image)),
    "haze": lambda recording: recording.with_images(hazy),
    "flickering light": lambda recording: recording.with_images(flickering),
    "sensor noise": lambda recording: recording.with_images(noisy),
    "worse from the middle on": worse_from_the_middle,
    "blurred by 1.5 px": lambda recording: recording.with_images(lambda image, _: cv2.GaussianBlur(image, (0, 0), 1.5)),
    "JPEG of quality 20": lambda recording: recording.with_images(lambda image, _: compressed(image, 20)),
}
