# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""The error of the camera in short windows, as self-supervised networks report it on SCARED. Python's standard library
only.

A window is the motions T between five consecutive frames, camera of the later from camera of the earlier one. Its
points are the translations of 1, T1, T1 T2, T1 T2 T3, ...: the published evaluation multiplies in this order. The
estimate is scaled once by least squares. The error is the root of the sum of the squares divided by the number of
points, and the figure is the mean over all windows; those at the end are shorter.
"""

import csv
import json
import math
import pathlib
import statistics

MOTIONS = 4
IDENTITY = [[float(i == j) for j in range(4)] for i in range(4)]


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(m):
    """Of a rotation and a translation."""
    turned = [[m[j][i] for j in range(3)] for i in range(3)]
    return [[*turned[i], -sum(turned[i][k] * m[k][3] for k in range(3))] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def rotation(m):
    return [[*m[i][:3], 0.0] for i in range(3)] + [[0.0, 0.0, 0.0, 1.0]]


def pose_of(words):
    """The matrix of a TUM line's `tx ty tz qx qy qz qw`."""
    tx, ty, tz, x, y, z, w = map(float, words)
    n = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / n, y / n, z / n, w / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), tx],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), ty],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), tz], [0.0, 0.0, 0.0, 1.0]]


def motions(poses):
    """{frame: camera of this frame from camera of the frame before} of {frame: world_from_camera}."""
    return {frame: product(inverse(pose), poses[frame - 1]) for frame, pose in poses.items() if frame - 1 in poses}


def error(estimate, truth):
    """Of one window, in the unit of the truth."""
    def points(chain):
        total, found = IDENTITY, [[0.0, 0.0, 0.0]]
        for motion in chain:
            total = product(total, motion)
            found.append([row[3] for row in total[:3]])
        return found

    ours, true = points(estimate), points(truth)
    square = sum(a * a for point in ours for a in point)
    scale = sum(a * b for p, q in zip(ours, true) for a, b in zip(p, q)) / square if square > 0 else 0.0
    return math.sqrt(sum((scale * a - b) ** 2 for p, q in zip(ours, true) for a, b in zip(p, q))) / len(true)


def figures(estimate, truth):
    """Of {frame: world_from_camera}: windows in which a frame has no estimate are left out and counted."""
    ours, true = motions(estimate), motions(truth)
    frames = sorted(true)
    windows = [frames[i:i + MOTIONS] for i in range(len(frames) - 1)]
    errors = [error([ours[f] for f in window], [true[f] for f in window]) for window in windows
              if all(f in ours for f in window)]
    return {"windows": len(windows), "windows_compared": len(errors),
            "mean_mm": statistics.fmean(errors) if errors else None,
            "std_mm": statistics.pstdev(errors) if errors else None}


def poses_of_run(run):
    """{frame: world_from_camera}."""
    run = pathlib.Path(run)
    with open(run / "frames.csv", newline="", encoding="utf-8") as file:
        frames = {row["timestamp"]: int(row["frame"]) for row in csv.DictReader(file)}
    lines = [line.split() for line in (run / "trajectory.txt").read_text(encoding="utf-8").splitlines()]
    return {frames[words[0]]: pose_of(words[1:]) for words in lines if words and words[0] != "#"}


def true_poses(recording, first_pose, first, end):
    """{frame: world_from_camera} of a recording of SCARED. Its poses are those of the left camera as built;
    `first_pose` is that of the rectified one in frame `first`, which is turned by the same rotation in every frame."""
    data = pathlib.Path(recording) / "data"
    files = {}
    for folder in (data, data / "frame_data"):
        files |= {int(path.stem[-6:]): path for path in folder.glob("frame_data??????.json")}
    built = {frame: inverse(json.loads(files[frame].read_text(encoding="utf-8"))["camera-pose"])
             for frame in range(first, end) if frame in files}
    if first not in built:
        return {}
    turn = rotation(product(inverse(built[first]), first_pose))
    return {frame: product(pose, turn) for frame, pose in built.items()}
