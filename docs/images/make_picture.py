# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Draws a frame of a run: the points' trails on the image, and beside it the points and the camera's path in space.

usage: make_picture.py --sequence SEQ --run RUN --output FILE.png [--frame N] [--trail N]
Needs Debian's python3-numpy and python3-matplotlib; nothing else of the project does.
"""

import argparse
import csv
import io
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from PIL import Image

# Without the darkest end, which is lost on tissue.
COLOURS = matplotlib.colors.ListedColormap(plt.get_cmap("turbo")(np.linspace(0.1, 0.95, 256)))
INK = "#222222"


def read_observations(run):
    """{frame: {point id: (pixel, position in space)}}"""
    frames = {}
    with open(run / "observations.csv", newline="") as file:
        for row in csv.DictReader(file):
            pixel = np.array([float(row["u_px"]), float(row["v_px"])])
            position = np.array([float(row["x"]), float(row["y"]), float(row["z"])])
            frames.setdefault(int(row["frame"]), {})[int(row["point_id"])] = (pixel, position)
    return frames


def rotation(q):
    x, y, z, w = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def read_poses(run, frames):
    """{frame: (rotation, centre)}, world from camera; the trajectory has one line a tracked frame."""
    lines = np.loadtxt(run / "trajectory.txt", ndmin=2)
    with open(run / "frames.csv", newline="") as file:
        frame_of = {round(float(row["timestamp"]), 4): int(row["frame"]) for row in csv.DictReader(file)}
    return {frame_of[round(line[0], 4)]: (rotation(line[4:8]), line[1:4]) for line in lines}


def depths_of(points, pose):
    turn, centre = pose
    return {key: float((turn.T @ (position - centre))[2]) for key, (_, position) in points.items()}


def draw_trails(axes, image, frames, frame, trail, depths, norm):
    axes.imshow(image)
    since = [f for f in sorted(frames) if frame - trail <= f <= frame]
    for key, depth in depths.items():
        track = np.array([frames[f][key][0] for f in since if key in frames[f]])
        if len(track) > 1:
            parts = np.stack([track[:-1], track[1:]], axis=1)
            alpha = np.linspace(0.15, 1, len(parts))
            rgba = np.tile(COLOURS(norm(depth)), (len(parts), 1))
            rgba[:, 3] = alpha
            axes.add_collection(LineCollection(parts, colors=rgba, linewidths=1.5, capstyle="round"))
    heads = np.array([frames[frame][key][0] for key in depths])
    axes.scatter(*heads.T, c=[COLOURS(norm(d)) for d in depths.values()], s=14, edgecolors="white", linewidths=0.6,
                 zorder=3)
    axes.set_xlim(-0.5, image.shape[1] - 0.5)
    axes.set_ylim(image.shape[0] - 0.5, -0.5)
    axes.axis("off")


def drawn(position):
    """World (x right, y down, z forward) as drawn: forward to the right, x into the picture, up."""
    x, y, z = np.asarray(position, float).T
    return z, x, -y


def draw_space(axes, frames, frame, poses, depths, norm):
    first = {}
    for f in sorted(frames):
        for key, (_, position) in frames[f].items():
            first.setdefault(key, position)
    now = np.array([frames[frame][key][1] for key in depths])
    rest = np.array([first[key] for key in depths])
    for a, b in zip(rest, now):
        axes.plot(*drawn(np.stack([a, b])), color="#888888", linewidth=0.8)
    axes.scatter(*drawn(now), c=[COLOURS(norm(d)) for d in depths.values()], s=13, edgecolors="black", linewidths=0.25,
                 depthshade=False)
    path = np.array([poses[f][1] for f in sorted(poses) if f <= frame])
    axes.plot(*drawn(path), color=INK, linewidth=2)
    turn, centre = poses[frame]
    size = 0.16 * np.median(list(depths.values()))
    corners = [centre + size * turn @ np.array([sx * 0.7, sy * 0.52, 1]) for sx, sy in
               ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for k in range(4):
        axes.plot(*drawn(np.stack([centre, corners[k]])), color=INK, linewidth=1)
        axes.plot(*drawn(np.stack([corners[k], corners[(k + 1) % 4]])), color=INK, linewidth=1)
    everything = np.array(drawn(np.concatenate([now, path, corners]))).T
    low, high = everything.min(axis=0), everything.max(axis=0)
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_zlim(low[2], high[2])
    axes.set_box_aspect(high - low, zoom=1.0)
    axes.view_init(elev=22, azim=-63)
    for axis, name in ((axes.xaxis, "forward"), (axes.yaxis, "right"), (axes.zaxis, "up")):
        axis.set_pane_color((0.97, 0.97, 0.97, 1))
        axis.set_major_locator(matplotlib.ticker.MaxNLocator(5 if name == "forward" else 3))
        axis.label.set_size(8)
        axis.set_label_text(f"{name}, mm")
    axes.tick_params(labelsize=7, pad=0)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sequence", type=pathlib.Path, required=True)
    parser.add_argument("--run", type=pathlib.Path, required=True)
    parser.add_argument("--output", type=pathlib.Path, required=True)
    parser.add_argument("--frame", type=int, help="the frame to draw; default: the last tracked one")
    parser.add_argument("--trail", type=int, default=25, help="frames that a trail reaches back")
    parser.add_argument("--dpi", type=int, default=100)
    arguments = parser.parse_args()

    frames = read_observations(arguments.run)
    poses = read_poses(arguments.run, frames)
    frame = arguments.frame if arguments.frame is not None else max(frames)
    depths = depths_of(frames[frame], poses[frame])
    low, high = np.quantile(list(depths.values()), [0.03, 0.97])
    norm = matplotlib.colors.Normalize(low, high)
    images = sorted((arguments.sequence / "images").iterdir())
    image = plt.imread(images[frame])
    if image.ndim == 2:
        image = np.repeat(image[..., None], 3, axis=2)

    figure = plt.figure(figsize=(12.4, 4.7), facecolor="white")
    left = figure.add_axes((0.0, 0.0, 0.5, 1.0))
    draw_trails(left, image, frames, frame, arguments.trail, depths, norm)
    right = figure.add_axes((0.52, 0.0, 0.385, 1.0), projection="3d")
    draw_space(right, frames, frame, poses, depths, norm)
    bar = figure.add_axes((0.955, 0.2, 0.01, 0.6))
    figure.colorbar(matplotlib.cm.ScalarMappable(norm, COLOURS), cax=bar)
    bar.tick_params(labelsize=8)
    bar.set_title("depth, mm", fontsize=8, pad=6)
    drawing = io.BytesIO()
    figure.savefig(drawing, dpi=arguments.dpi, format="png")
    Image.open(drawing).convert("RGB").quantize(256, Image.Quantize.LIBIMAGEQUANT).save(arguments.output, optimize=True)


if __name__ == "__main__":
    main()
