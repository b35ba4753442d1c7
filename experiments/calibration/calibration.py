#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far calibrations of simulated cameras are off.

    calibration.py --program build/release/pliant --output_path RESULTS [--only "NAME;..."] [--seed N]

Renders a chessboard from 24 sides through lenses of every camera model, clean and as an endoscope records it,
calibrates with and without knowledge of the model, and prints a table. What is there already is kept.
"""
import math
import re
import sys
from pathlib import Path

import matplotlib.image
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from scenes import call, scene_arguments, slug  # noqa: E402

COLUMNS, ROWS, SQUARE_MM = 9, 6, 3.0  # inner corners
MARGIN = 1  # white, in squares, around the outer squares
TEXELS = 64  # a square
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
# A dull board before a clean lens that is held still.
SET_UP = ("--Light.specular 0 --Sensor.shutter_s 0 --Sensor.readout_s 0 --Sensor.drops 0 --Sensor.debris 0"
          " --Recording.lost_share 0 --Recording.video_qp 0")


def write_board(folder):
    """A flat mesh that carries the picture of a chessboard. World frame: the first inner corner at the origin."""
    columns, rows = COLUMNS + 1 + 2 * MARGIN, ROWS + 1 + 2 * MARGIN
    row, column = np.mgrid[:rows * TEXELS, :columns * TEXELS] // TEXELS - MARGIN
    dark = (row >= 0) & (row <= ROWS) & (column >= 0) & (column <= COLUMNS) & ((row + column) % 2 == 0)
    matplotlib.image.imsave(folder / "board.png", np.repeat(np.where(dark, 0.1, 0.8)[..., None], 3, 2))
    (folder / "board.mtl").write_text("newmtl board\nmap_Kd board.png\n")
    left, top = -(1 + MARGIN) * SQUARE_MM, -(1 + MARGIN) * SQUARE_MM
    right, bottom = left + columns * SQUARE_MM, top + rows * SQUARE_MM
    (folder / "board.obj").write_text(
        "mtllib board.mtl\nusemtl board\n"
        f"v {left} {top} 0\nv {right} {top} 0\nv {right} {bottom} 0\nv {left} {bottom} 0\n"
        "vt 0 1\nvt 1 1\nvt 1 0\nvt 0 0\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4\n")


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


def quaternion(matrix):
    """x, y, z, w; for rotations of less than half a turn."""
    w = 0.5 * math.sqrt(1 + np.trace(matrix))
    return [(matrix[2, 1] - matrix[1, 2]) / (4 * w), (matrix[0, 2] - matrix[2, 0]) / (4 * w),
            (matrix[1, 0] - matrix[0, 1]) / (4 * w), w]


def camera_from_board(model, params, random):
    """Views in which the whole board is in the image, tilted by 5 to 40 degrees, near its edges too."""
    corners = np.array([(x, y, 0) for y in range(ROWS) for x in range(COLUMNS)]) * SQUARE_MM
    center = corners.mean(0)
    poses = []
    while len(poses) < VIEWS:
        direction = random.uniform(0, 2 * math.pi)
        tilt = math.radians(random.uniform(5, 40))
        turned = rotation(tilt * np.array([math.cos(direction), math.sin(direction), 1e-9]))
        distance = random.uniform(0.8, 1.7) * COLUMNS * SQUARE_MM * params[0] / WIDTH
        place = distance * np.array([random.uniform(-0.45, 0.45) * WIDTH / params[0],
                                     random.uniform(-0.45, 0.45) * HEIGHT / params[0], 1])
        in_camera = (corners - center) @ turned.T + place
        if in_camera[:, 2].min() < 5:
            continue
        pixels = project(model, params, in_camera)
        if (pixels > 12).all() and (pixels < np.array([WIDTH, HEIGHT]) - 12).all():
            poses.append((turned, place - turned @ center))
    return poses


def render(arguments, name, look):
    folder = arguments.output_path / "sequences" / f"{slug(name)}_{look}_{arguments.seed}"
    if (folder / "boards" / "simulation.yaml").exists():
        return folder / "boards"
    folder.mkdir(parents=True, exist_ok=True)
    write_board(folder)
    model, params = LENSES[name]
    lines = []
    for i, (turned, moved) in enumerate(camera_from_board(model, params, np.random.default_rng(arguments.seed))):
        place, turn = -turned.T @ moved, quaternion(turned.T)
        lines.append(" ".join(repr(float(number)) for number in (i / 30, *place, *turn)))
    (folder / "poses.txt").write_text("\n".join(lines) + "\n")
    call(arguments.program, "simulate", "--quiet", "--overwrite", "-o", folder / "boards", "--realism", look,
         "--Scene.kind", "mesh", "--Scene.mesh_path", folder / "board.obj", "--Scene.seed", arguments.seed,
         "--Trajectory.kind", "file", "--Trajectory.path", folder / "poses.txt", "--Trajectory.frames", VIEWS,
         "--Camera.model", model, "--Camera.params", ",".join(map(str, params)), *SET_UP.split()).check_returncode()
    return folder / "boards"


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


def main():
    arguments = scene_arguments(__doc__)
    print("| lens | images | model | images used | error, px | focal length | center, px | circle, px | corner, px |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, (model, params) in LENSES.items():
        if arguments.only and name not in arguments.only.split(";"):
            continue
        for look in LOOKS:
            boards = render(arguments, name, look)
            for choice in (model, "auto"):
                camera = boards.parent / f"camera_{choice}.yaml"
                said = boards.parent / f"calibrate_{choice}.txt"
                if not camera.exists():
                    done = call(arguments.program, "calibrate", "--image_path", boards, "--board",
                                f"chessboard:{COLUMNS}x{ROWS}:{SQUARE_MM}", "--Calibrate.model", choice,
                                "-o", camera, "--figure", camera.with_suffix(".png"))
                    if not camera.exists():
                        raise SystemExit(done.stderr)
                    said.write_text(done.stdout)
                found, estimated = read_camera(camera)
                text = said.read_text()
                used = re.search(r"(\d+) used", text)[1]
                rms = re.search(r"error +([\d.]+) px", text)[1]
                title = f"{model}, given" if choice != "auto" else f"{found}, chosen"
                print(f"| {name} | {look} | {title} | {used} of {VIEWS} | {rms} | "
                      + " | ".join(errors(model, params, found, estimated)) + " |", flush=True)


if __name__ == "__main__":
    main()
