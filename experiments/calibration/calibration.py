#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far calibrations of simulated cameras are off.

    calibration.py --program build/release/pliant --output_path RESULTS [--only "NAME;..."] [--seed N]

Photographs a chessboard from 24 sides through lenses of every camera model, clean and as an endoscope records it,
calibrates with and without knowledge of the model, and prints a table; then the same for pairs of cameras. What is
there already is kept.
"""
import math
import re
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from scenes import call, scene_arguments, slug  # noqa: E402

BOARD = "chessboard:9x6:3"
VIEWS = 24
WIDTH, HEIGHT = 640, 480
# name: model, parameters
LENSES = {
    "laparoscope": ("PINHOLE", (610.0, 608.0, 322.0, 236.0)),
    "simple": ("SIMPLE_RADIAL", (520.0, 316.0, 243.0, -0.18)),
    "radial": ("RADIAL", (480.0, 325.0, 238.0, -0.30, 0.09)),
    "colonoscope": ("OPENCV", (400.0, 398.0, 321.0, 244.0, -0.27, 0.07, 0.0008, -0.0006)),
    "fisheye": ("OPENCV_FISHEYE", (290.0, 291.0, 318.0, 241.0, -0.03, 0.006, -0.002, 0.0003)),
}
LOOKS = ("clean", "endoscope")
PAIRS = ("laparoscope", "radial", "colonoscope")  # both cameras have such a lens, the right one's a little different
RIGHT_CENTER_MM = np.array([4.3, 0.1, -0.05])  # in the left camera
RIGHT_TURN = np.radians([0.1, -0.6, 0.3])
# A clean lens that is held still.
SET_UP = ("--Sensor.shutter_s 0 --Sensor.readout_s 0 --Sensor.drops 0 --Sensor.debris 0"
          " --Recording.lost_share 0 --Recording.video_qp 0")


def project(model, params, points):
    """Pixels of points in the camera's frame, (N, 3) to (N, 2)."""
    x, y = points[:, 0] / points[:, 2], points[:, 1] / points[:, 2]
    shared = model in ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL")
    fx, fy, cx, cy = (params[0], *params[:3]) if shared else params[:4]
    k = list(params[3 if shared else 4:])
    if model == "OPENCV_FISHEYE":
        r = np.hypot(x, y)
        theta = np.arctan(r)
        distorted = theta * (1 + sum(c * theta ** (2 * i + 2) for i, c in enumerate(k)))
        scale = np.where(r > 1e-9, distorted / np.maximum(r, 1e-9), 1)
        xd, yd = x * scale, y * scale
    else:
        k1, k2, p1, p2 = k + [0.0] * (4 - len(k))
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * k2)
        xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
        yd = y * radial + 2 * p2 * x * y + p1 * (r2 + 2 * y * y)
    return np.stack([fx * xd + cx, fy * yd + cy], 1)


def rotation(axis_angle):
    angle = np.linalg.norm(axis_angle)
    x, y, z = axis_angle / angle
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def right_lens(name):
    """The model and the parameters of the right camera of a pair."""
    model, params = LENSES[name]
    shared = model in ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL")
    center = 1 if shared else 2
    changed = [1.005 * number for number in params[:center]] + [params[center] - 9, params[center + 1] + 5]
    return model, (*changed, *params[center + 2:])


def render_boards(arguments, boards, look, lens, *path):
    """A photograph a second of the board."""
    model, params = lens
    if not (boards / "simulation.yaml").exists():
        call(arguments.program, "simulate", "--quiet", "--overwrite", "-o", boards, "--realism", look,
             "--Scene.kind", "board", "--Scene.board", BOARD, "--Scene.seed", arguments.seed,
             "--Trajectory.fps", 1, "--Trajectory.frames", VIEWS, *(path or ("--Trajectory.kind", "board")),
             "--Camera.model", model, "--Camera.params", ",".join(map(str, params)), *SET_UP.split()).check_returncode()
    return boards


def folder_of(arguments, name, look):
    return arguments.output_path / "sequences" / f"{slug(name)}_{look}_{arguments.seed}"


def render(arguments, name, look):
    return render_boards(arguments, folder_of(arguments, name, look) / "boards", look, LENSES[name])


def matrix(x, y, z, w):
    """Of a quaternion of unit length."""
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def times(q, r):
    """The product of two quaternions (x, y, z, w)."""
    (a, b, c, d), (e, f, g, h) = q, r
    return [d * e + a * h + b * g - c * f, d * f - a * g + b * h + c * e, d * g + a * f - b * e + c * h,
            d * h - a * e - b * f - c * g]


def render_pair(arguments, name, look):
    """The left camera's views, and what the right one sees beside it: not always all of the board."""
    folder = folder_of(arguments, f"{name} pair", look)
    left = render_boards(arguments, folder / "left", look, LENSES[name])
    angle = np.linalg.norm(RIGHT_TURN)
    left_from_right = [*(-math.sin(angle / 2) / angle * RIGHT_TURN), math.cos(angle / 2)]
    lines = []
    for line in (left / "groundtruth.txt").read_text().splitlines():
        if not line.startswith("#"):
            time, *pose = map(float, line.split())
            place = np.array(pose[:3]) + matrix(*pose[3:]) @ RIGHT_CENTER_MM
            lines.append(" ".join(repr(float(number)) for number in (time, *place, *times(pose[3:], left_from_right))))
    (folder / "right.txt").write_text("\n".join(lines) + "\n")
    render_boards(arguments, folder / "right", look, right_lens(name),
                  "--Trajectory.kind", "file", "--Trajectory.path", folder / "right.txt")
    return folder


def errors(true_model, true_params, model, params):
    """Focal length in per cent, center in px, and the largest difference on the image's inscribed circle and at its
    corners in px, where the true camera sees them."""
    shared = ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL")
    true_center = true_params[1:3] if true_model in shared else true_params[2:4]
    center = params[1:3] if model in shared else params[2:4]
    angles = np.radians(np.arange(0, 60.01, 0.1))
    at = {}
    for where, bearing, reach in (("circle", (0, 1), HEIGHT / 2 - 8),
                                  ("corner", (0.8, 0.6), math.hypot(WIDTH, HEIGHT) / 2 - 10)):
        worst = 0.0
        for turn in range(4):
            u, v = bearing[0] * (1, -1, 1, -1)[turn], bearing[1] * (1, 1, -1, -1)[turn]
            rays = np.stack([np.sin(angles) * u, np.sin(angles) * v, np.cos(angles)], 1)
            seen = project(true_model, true_params, rays)
            distances = np.hypot(*(seen - np.array([WIDTH, HEIGHT]) / 2).T)
            beyond = np.nonzero(distances > reach)[0]
            last = beyond[0] if len(beyond) else len(angles) - 1
            worst = max(worst, float(np.linalg.norm(project(model, params, rays[last:last + 1]) - seen[last])))
        at[where] = worst
    return [f"{100 * (params[0] / true_params[0] - 1):+.2f} %",
            f"{math.dist(true_center, center):.2f}", f"{at['circle']:.2f}", f"{at['corner']:.2f}"]


def read_camera(path):
    text = path.read_text()
    return (re.search(r"model: (\w+)", text)[1],
            tuple(float(number) for number in re.search(r"params: \[(.*)\]", text)[1].split(",")))


def print_cameras(arguments):
    print("| lens | images | model | images used | error, px | focal length | center, px | circle, px | corner, px |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, look in wanted(arguments, LENSES):
        model, params = LENSES[name]
        boards = render(arguments, name, look)
        for choice in (model, "auto"):
            camera = boards.parent / f"camera_{choice}.yaml"
            text = calibrated(arguments, camera, "--image_path", boards, "--Calibrate.model", choice)
            found, estimated = read_camera(camera)
            used = re.search(r"(\d+) used", text)[1]
            rms = re.search(r"error +([\d.]+) px", text)[1]
            title = f"{model}, given" if choice != "auto" else f"{found}, chosen"
            print(f"| {name} | {look} | {title} | {used} of {VIEWS} | {rms} | "
                  + " | ".join(errors(model, params, found, estimated)) + " |", flush=True)


def print_pairs(arguments):
    print("| lenses | images | pairs | error, px | baseline off by | it says | rotation off by, deg | it says |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, look in wanted(arguments, PAIRS):
        folder = render_pair(arguments, name, look)
        stereo = folder / "stereo.yaml"
        text = calibrated(arguments, stereo, "--image_path", folder / "left", "--right_path", folder / "right")
        read = stereo.read_text()
        turned, moved = (np.array([float(number) for number in re.search(rf"\n{key}: .*?data: \[(.*?)\]", read, re.S)[1]
                                   .split(",")]) for key in "RT")
        baseline, sigma = map(float, re.search(r"baseline +([\d.]+) mm \+- (\S+):", text).groups())
        assert math.isclose(baseline, np.linalg.norm(moved), rel_tol=1e-3)
        true_mm = np.linalg.norm(RIGHT_CENTER_MM)
        between = turned.reshape(3, 3) @ rotation(RIGHT_TURN).T
        angle = math.degrees(math.acos(min(1.0, (np.trace(between) - 1) / 2)))
        pairs, rms, angle_sigma = (re.search(pattern, text)[1] for pattern in (
            r"pairs +(.*)", r"([0-9.]+) px RMS in both", r"rotation .*?[+]- ([0-9.e-]+)"))
        print(f"| {name} | {look} | {pairs} | {rms} | {100 * (baseline / true_mm - 1):+.2f} % "
              f"| {100 * sigma / true_mm:.2f} % | {angle:.3f} | {angle_sigma} |", flush=True)


def wanted(arguments, names):
    for name in names:
        if not arguments.only or name in arguments.only.split(";"):
            for look in LOOKS:
                yield name, look


def calibrated(arguments, camera, *images):
    """What the calibration said; it is kept beside it."""
    said = camera.with_suffix(".txt")
    if not camera.exists():
        done = call(arguments.program, "calibrate", *images, "--board", BOARD,
                    "-o", camera, "--figure", camera.with_suffix(".png"))
        if not camera.exists():
            raise SystemExit(done.stderr)
        said.write_text(done.stdout)
    return said.read_text()


def main():
    arguments = scene_arguments(__doc__)
    print_cameras(arguments)
    print()
    print_pairs(arguments)


if __name__ == "__main__":
    main()
