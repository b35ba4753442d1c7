# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The labelled points of a sequence of STIR, as its loader has them (github.com/athaddius/STIRLoader, STIRLoader.py).

A label is the middle of the box around a patch of an image of labels. Its place in space is that of the middle of a
patch of the right eye's image, on almost the same row. Where several are near enough, the loader takes the one whose
infrared image correlates *least* with that of the left patch, and so does this module: the labels are to be the
challenge's, not better ones.
"""

import json
import pathlib

MAX_ROWS_APART = 10
DISPARITIES_PX = (8, 105)


def read(path):
    """The image, (H, W, 3); None where there is no file that is one."""
    import cv2
    return cv2.imread(str(path), cv2.IMREAD_COLOR) if pathlib.Path(path).is_file() else None


def boxes_of(image):
    """(x, y, width, height) around each patch of an image of labels."""
    import cv2
    contours = cv2.findContours(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY), cv2.RETR_TREE, cv2.CHAIN_APPROX_SIMPLE)[-2]
    return [cv2.boundingRect(contour) for contour in contours]


def middle(box):
    x, y, width, height = box
    return [x + width // 2, y + height // 2]


def pixels(path):
    """[[x, y], ...] of the labels in an image, px. None of an image that is not there."""
    image = read(path)
    return [] if image is None else sorted(middle(box) for box in boxes_of(image))


def right_of(folder):
    """The right eye's folder of a left sequence, DIR/left/seqNN."""
    return folder.parent.parent / folder.parent.name.replace("left", "right", 1) / folder.name


def correlation(a, b):
    """Of two patches of one size, all channels together: -1 to 1; 0 where one has no contrast."""
    deviations = a.std() * b.std()
    return 0.0 if deviations == 0 else ((a - a.mean()) * (b - b.mean())).mean() / deviations


def positions(folder, labels, infrared):
    """[[x, y, z], ...] of the labels that both eyes show, mm, in the frame of the left camera.

    labels: the image of labels in `folder`, a left sequence, and in the right eye's; infrared: a pattern for the name of
    the infrared image of the same moment, as "*_icgstart.png". None where an image of the two eyes is missing.
    """
    images = []
    for eye in (folder, right_of(folder)):
        of_infrared = sorted(eye.glob(infrared))
        images += [read(eye / labels), read(of_infrared[0]) if of_infrared else None]
    if any(image is None for image in images):
        return []
    left, left_infrared, right, right_infrared = (image / 255.0 if k % 2 else image for k, image in enumerate(images))
    calibration = json.loads((folder.parent.parent / "calib.json").read_text(encoding="utf-8"))
    (focal, _, cx), (_, _, cy) = calibration["leftcameramat"][:2]
    offset = calibration["rightcameramat"][0][2] - cx
    baseline_mm = -1000 * calibration["translation"][0]
    candidates = [middle(box) for box in boxes_of(right)]
    found = []
    for box in boxes_of(left):
        x, y, width, height = box
        u, v = middle(box)
        rows = slice(y, y + height)
        matches = []
        for u_right, v_right in candidates:
            disparity, start = u + offset - u_right, u_right - width // 2
            if (abs(v_right - v) > MAX_ROWS_APART or not DISPARITIES_PX[0] <= disparity <= DISPARITIES_PX[1] or
                    start < 0 or start + width > right.shape[1]):
                continue
            score = correlation(left_infrared[rows, x:x + width], right_infrared[rows, start:start + width])
            matches.append((score, disparity))
        if matches:
            disparity = min(matches, key=lambda match: match[0])[1]
            found.append([coordinate * baseline_mm / disparity for coordinate in (u - cx, v - cy, focal)])
    return found
