# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What is done to recordings, and to the points that their depths are compared with.

usage: changed_recordings_test.py changed_pixels|changed_orders PLIANT
"""

import sys

from support import SKIPPED, experiment_modules, main

try:
    import cv2  # noqa: F401
    import numpy as np
except ImportError:
    print("skipped: cv2 and numpy not found")
    sys.exit(SKIPPED)

experiment_modules("recordings")

SIZE = (80, 120)  # rows, columns
FRAMES = 12
MOST_PX = 0.2
# Those that show something else than the same scene in the same frame, or in frames that are named by their order.
ORDERS = ("backwards", "every frame twice", "a tenth of the frames lost", "interlaced")
HIDDEN = ("ten black frames",)


def recording():
    """One white square of 7 by 7 pixels a frame, which moves; its depth is 1 more than the number of its frame."""
    from changes import Recording

    points = np.array([(frame, 40 + 2 * frame, 30 + frame, frame + 1) for frame in range(FRAMES)], float)

    def image(frame):
        drawn = np.full((*SIZE, 3), 40, np.uint8)
        u, v = points[frame, 1:3].astype(int)
        drawn[v - 3:v + 4, u - 3:u + 4] = 230
        return drawn

    return Recording(image, FRAMES, (100.0, 110.0, 61.0, 42.0), 25.0, None, points)


def brightest_near(image, pixel):
    """Center of what is brighter than the background within 8 pixels."""
    gray = image.astype(float).mean(axis=2)
    rows, columns = np.indices(gray.shape)
    near = (abs(columns - pixel[0]) <= 8) & (abs(rows - pixel[1]) <= 8)
    weights = np.where(near, gray - np.median(gray[near]), 0)
    return np.array([(weights * columns).sum(), (weights * rows).sum()]) / weights.sum()


def changed_pixels(_):
    """Points stay on the square, and rays through it keep their angle to the axis, whatever is done to the images."""
    from changes import CHANGES

    original = recording()
    for name, change in CHANGES.items():
        if name in ORDERS + HIDDEN or name == "text and a box burned in":  # which is brighter
            continue
        changed = change(original)
        assert len(changed.points) >= FRAMES // 2, name
        for frame, u, v, depth in changed.points:
            image = changed.image(int(frame))
            assert np.linalg.norm(brightest_near(image, (u, v)) - (u, v)) < MOST_PX, (name, frame)
            before = original.points[int(frame)]
            ray = (np.array((u, v)) - changed.params[2:]) / changed.params[:2]
            ray_before = (before[1:3] - original.params[2:]) / original.params[:2]
            assert abs(np.linalg.norm(ray) - np.linalg.norm(ray_before)) < 1e-9, (name, frame)
            assert depth == before[3], name


def changed_orders(_):
    """Frames that are moved take their points along; what is not shown has none."""
    from changes import CHANGES

    original = recording()
    counts = {"backwards": FRAMES, "every frame twice": 2 * FRAMES, "interlaced": FRAMES // 2}
    for name in ORDERS:
        changed = CHANGES[name](original)
        assert changed.frames == counts.get(name, changed.frames), name
        assert sorted({int(frame) for frame in changed.points[:, 0]}) == list(range(changed.frames)), name
        for frame, u, v, depth in changed.points:
            shown = int(depth) - 1  # the frame that it was
            image = changed.image(int(frame))
            even = image[::2], original.image(shown)[::2]
            assert np.array_equal(*even), (name, frame)
            assert tuple(original.points[shown, 1:3]) == (u, v), (name, frame)
    assert [int(depth) for depth in CHANGES["backwards"](original).points[:, 3]] == list(range(FRAMES, 0, -1))
    assert CHANGES["a tenth of the frames lost"](original).frames < FRAMES
    odd = CHANGES["interlaced"](original).image(2)[1::2]
    assert np.array_equal(odd, original.image(5)[1::2])
    black = [not CHANGES["ten black frames"](original).image(k).any() for k in range(FRAMES)]
    assert black == [k >= FRAMES // 2 for k in range(FRAMES)]


if __name__ == "__main__":
    main(changed_pixels, changed_orders)
