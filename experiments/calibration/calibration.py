#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""How far calibrations of simulated cameras are off.

    calibration.py --program build/release/pliant --output_path RESULTS [--only "NAME;..."] [--seed N]

Renders a chessboard from 24 sides through lenses of every camera model, clean and as an endoscope records it,
calibrates with and without knowledge of the model, and prints a table; then the same for pairs of cameras. What is
there already is kept.
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
PAIRS = ("laparoscope", "radial", "colonoscope")  # both cameras have such a lens, the right one's a little different
RIGHT_CENTER_MM = np.array([4.3, 0.1, -0.05])  # in the left camera
RIGHT_TURN = np.radians([0.1, -0.6, 0.3])
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


def camera_from_board(model, params, random, right=None):
    """Views in which the whole board is in the image, tilted by 5 to 40 degrees, near its edges too; with the
    parameters of a right camera in its image too."""
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
        if right:
            seen_right = project(model, right, (in_camera - RIGHT_CENTER_MM) @ rotation(RIGHT_TURN).T)
            pixels = np.concatenate([pixels, seen_right])
        if (pixels > 12).all() and (pixels < np.array([WIDTH, HEIGHT]) - 12).all():
            poses.append((turned, place - turned @ center))
    return poses


def right_lens(name):
    """The model and the parameters of the right camera of a pair."""
    model, params = LENSES[name]
    shared = model in ("SIMPLE_PINHOLE", "SIMPLE_RADIAL", "RADIAL")
    center = 1 if shared else 2
    changed = [1.005 * number for number in params[:center]] + [params[center] - 9, params[center + 1] + 5]
    return model, (*changed, *params[center + 2:])


def render_boards(arguments, folder, boards, look, lens, poses):
    """The images of a camera that stands at these poses before the board."""
    model, params = lens
    lines = []
    for i, (turned, moved) in enumerate(poses):
        place, turn = -turned.T @ moved, quaternion(turned.T)
        lines.append(" ".join(repr(float(number)) for number in (i / 30, *place, *turn)))
    (folder / f"{boards}.txt").write_text("\n".join(lines) + "\n")
    call(arguments.program, "simulate", "--quiet", "--overwrite", "-o", folder / boards, "--realism", look,
         "--Scene.kind", "mesh", "--Scene.mesh_path", folder / "board.obj", "--Scene.seed", arguments.seed,
         "--Trajectory.kind", "file", "--Trajectory.path", folder / f"{boards}.txt", "--Trajectory.frames", VIEWS,
         "--Camera.model", model, "--Camera.params", ",".join(map(str, params)), *SET_UP.split()).check_returncode()


def render(arguments, name, look):
    folder = arguments.output_path / "sequences" / f"{slug(name)}_{look}_{arguments.seed}"
    if (folder / "boards" / "simulation.yaml").exists():
        return folder / "boards"
    folder.mkdir(parents=True, exist_ok=True)
    write_board(folder)
    poses = camera_from_board(*LENSES[name], np.random.default_rng(arguments.seed))
    render_boards(arguments, folder, "boards", look, LENSES[name], poses)
    return folder / "boards"


def render_pair(arguments, name, look):
    folder = arguments.output_path / "sequences" / f"{slug(name)}_pair_{look}_{arguments.seed}"
    if (folder / "right" / "simulation.yaml").exists():
        return folder
    folder.mkdir(parents=True, exist_ok=True)
    write_board(folder)
    right = right_lens(name)
    poses = camera_from_board(*LENSES[name], np.random.default_rng(arguments.seed), right[1])
    mount = rotation(RIGHT_TURN)
    render_boards(arguments, folder, "left", look, LENSES[name], poses)
    render_boards(arguments, folder, "right", look, right,
                  [(mount @ turned, mount @ (moved - RIGHT_CENTER_MM)) for turned, moved in poses])
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
        done = call(arguments.program, "calibrate", *images, "--board", f"chessboard:{COLUMNS}x{ROWS}:{SQUARE_MM}",
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
