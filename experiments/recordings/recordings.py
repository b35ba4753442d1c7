#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What default options give on the real recordings that are there, with truth and without.

    recordings.py --program build/release/pliant --output_path RUNS [--recordings DIR] [--only NAME,...]

Runs that are there already are kept. Prints two tables: the runs, and how far runs of one recording that were begun at
other frames, with another seed or another focal length, agree. Needs NumPy.
"""
import argparse
import csv
import json
import os
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

import numpy as np

HERE = Path(__file__).resolve().parent
RECORDINGS = Path(os.environ.get("PLIANT_RECORDINGS", HERE.parents[2] / "shared" / "data"))

# name: images, other arguments, frames between the first frames of the variants
CASES = {
    "nasal": ("nasal/images", "--camera {0}/nasal/camera.yaml --mask_path {0}/nasal/mask.png", 2),
    "laparoscopy": ("laparoscopy/endo.mp4", "", 20),
    "instruments": ("clips/instruments.mp4", "", 10),
    "gallbladder": ("clips/gallbladder.mp4", "", 50),
}
CALIBRATIONS = {"laparoscopy": "laparoscopy/camera.yaml"}
# Of the true depths around a point, px: the nearest one at most so far, and the third nearest.
NEAREST_PX, THIRD_PX = 20, 60
MAX_STEP = 0.15  # of true depths around a point; larger is an edge
MIN_POINTS = 8   # of a frame that is counted
SAME_PLACE = 0.01  # of the image's width: points of two runs that are nearer than that are compared


def rotation(x, y, z, w):
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


class Run:
    """A run folder: by frame the camera's center and the pixels and depths of its points."""

    def __init__(self, path):
        self.summary = json.loads((path / "run.json").read_text())
        with open(path / "frames.csv", newline="") as stream:
            self.rows = list(csv.DictReader(stream))
        self.tracked = [row for row in self.rows if row["state"] == "tracking"]
        lines = [[float(x) for x in line.split()] for line in (path / "trajectory.txt").read_text().splitlines()]
        poses = {int(row["frame"]): (np.array(v[1:4]), rotation(*v[4:8])) for row, v in zip(self.tracked, lines)}
        self.centers = {frame: center for frame, (center, _) in poses.items()}
        points = defaultdict(list)
        with open(path / "observations.csv", newline="") as stream:
            for row in csv.DictReader(stream):
                center, world_from_cam = poses[int(row["frame"])]
                position = np.array([float(row[axis]) for axis in "xyz"])
                depth = ((position - center) @ world_from_cam)[2]
                points[int(row["frame"])].append((float(row["u_px"]), float(row["v_px"]), depth))
        self.points = {frame: np.array(rows) for frame, rows in points.items()}


def spread(values):
    """Median relative deviation from the median: of depths that of one constant depth, the null."""
    return float(np.median(np.abs(np.log(values) - np.median(np.log(values)))))


def depth_error(run, truth_path):
    """Of the points' depths, one scale a frame, against points of structure from motion; and the null's."""
    truth = defaultdict(list)
    with open(truth_path, newline="") as stream:
        for row in csv.DictReader(stream):
            truth[int(row["frame"])].append([float(row[key]) for key in ("u_px", "v_px", "depth")])
    errors, nulls = [], []
    for frame, points in run.points.items():
        known = np.array(truth.get(frame, []))
        if len(known) < MIN_POINTS:
            continue
        pairs = []
        for u, v, depth in points:
            distances = np.hypot(known[:, 0] - u, known[:, 1] - v)
            near = np.argsort(distances)[:3]
            if distances[near[0]] > NEAREST_PX:
                continue
            if distances[near[2]] > THIRD_PX:
                near = near[:1]
            depths = known[near, 2]
            if np.ptp(depths) <= MAX_STEP * depths.mean():
                pairs.append((depth, np.average(depths, weights=1 / (distances[near] + 2))))
        if len(pairs) >= MIN_POINTS:
            pairs = np.array(pairs)
            errors.append(spread(pairs[:, 0] / pairs[:, 1]))
            nulls.append(spread(pairs[:, 1]))
    return (np.median(errors), np.median(nulls)) if errors else None


def ate(run, truth_path):
    """Root mean square of the camera's error after the best similarity, by the length of the true path."""
    lines = [line.split() for line in truth_path.read_text().splitlines() if line and not line.startswith("#")]
    truth = [np.array([float(x) for x in line[1:4]]) for line in lines]
    frames = [frame for frame in sorted(run.centers) if frame < len(truth)]
    if len(frames) < 3:
        return None
    ours, true = np.array([run.centers[f] for f in frames]), np.array([truth[f] for f in frames])
    x, y = ours - ours.mean(0), true - true.mean(0)
    u, d, vt = np.linalg.svd(y.T @ x)
    flip = np.diag([1, 1, np.sign(np.linalg.det(u @ vt))])
    scale = np.trace(np.diag(d) @ flip) / (x**2).sum()
    error = y - scale * x @ (u @ flip @ vt).T
    path = np.linalg.norm(np.diff(true, axis=0), axis=1).sum()
    return np.sqrt((error**2).sum(1).mean()) / path


def disagreement(a, b, radius_px):
    """Of the depths of two runs at the same pixels, one scale a frame; the spread of the depths; frames compared."""
    differences, spreads = [], []
    for frame in sorted(set(a.points) & set(b.points)):
        p, q = a.points[frame], b.points[frame]
        distances = np.linalg.norm(p[:, None, :2] - q[None, :, :2], axis=2)
        nearest = distances.argmin(1)
        same = distances[np.arange(len(p)), nearest] <= radius_px
        if same.sum() >= MIN_POINTS:
            differences.append(spread(p[same, 2] / q[nearest[same], 2]))
            spreads.append(spread(p[same, 2]))
    return (np.median(differences), np.median(spreads), len(differences)) if differences else None


def variants(name, images, step, folder):
    yield "as it is", ""
    for k in (1, 2, 3):
        yield f"begun at {k * step}", f"--start {k * step}"
    yield "seed 2", "--General.seed 2"
    if name not in CALIBRATIONS:
        return
    for percent in (-12, 12):
        path = folder / f"{name}_{percent}.yaml"
        lines = (images.parent / Path(CALIBRATIONS[name]).name).read_text().splitlines()
        for i, line in enumerate(lines):
            if line.startswith("params:"):
                values = [float(x) for x in line.split("[")[1].rstrip("] ").split(",")]
                values[:2] = [value * (1 + percent / 100) for value in values[:2]]
                lines[i] = f"params: {values}"
        path.write_text("\n".join(lines) + "\n")
        yield f"focal length {percent:+d} %", f"--camera {path}"


def percent(value):
    return "" if value is None else f"{100 * value:.1f} %"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--output_path", required=True, type=Path)
    parser.add_argument("--recordings", default=RECORDINGS, type=Path)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    arguments.output_path.mkdir(parents=True, exist_ok=True)
    rows, agreements = [], []
    for name, (images, options, step) in CASES.items():
        images = arguments.recordings / images
        if not images.exists() or (arguments.only and name not in arguments.only.split(",")):
            continue
        first = None
        for variant, change in variants(name, images, step, arguments.output_path):
            folder = arguments.output_path / f"{name}_{variant.replace(' ', '_')}"
            if not (folder / "run.json").exists():
                command = [arguments.program, "track", "--quiet", "--image_path", images, "--output_path", folder,
                           *options.format(arguments.recordings).split(), *change.split()]
                subprocess.run([str(part) for part in command], check=False, stderr=subprocess.DEVNULL)
            run = Run(folder)
            points = [int(row["optimized"]) for row in run.tracked]
            truth = arguments.recordings / name
            depth = depth_error(run, truth / "sfm_points.csv") if (truth / "sfm_points.csv").exists() else None
            path = ate(run, truth / "groundtruth.txt") if (truth / "groundtruth.txt").exists() else None
            working = run.summary["working_image"]
            rows.append([name, variant, f"{len(run.tracked)} of {len(run.rows)}",
                         run.tracked[0]["frame"] if run.tracked else "",
                         str(len({row["submap"] for row in run.tracked})), f"{np.median(points):.0f}" if points else "",
                         f"{working['scale']:.2f}, {working['smoothing_px']:.1f}",
                         percent(depth and depth[0]), percent(depth and depth[1]), percent(path)])
            first = first or run
            width = max(points[:, 0].max() for points in first.points.values()) if first.points else 0
            if run is not first and (agreed := disagreement(first, run, SAME_PLACE * width)):
                agreements.append([name, variant, str(agreed[2]), percent(agreed[0]), percent(agreed[1])])
    for head, body in ((["recording", "variant", "frames with a map", "first", "submaps", "points", "scale, smoothing",
                         "depth error", "null", "ATE"], rows),
                       (["recording", "compared with", "frames", "depths differ", "spread of the depths"], agreements)):
        print("\n| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
        for row in body:
            print("| " + " | ".join(row) + " |")
    return 0 if rows else 1


if __name__ == "__main__":
    sys.exit(main())
