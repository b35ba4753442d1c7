#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What default options give on real recordings after changes that other endoscopes and other videos have.

    changed.py --program build/release/pliant --output_path RUNS [--recordings DIR] [--only NAME,...]
               [--changes NAME,...] [--colmap PROGRAM]

Every recording that has a truth (nasal), or that COLMAP reconstructs (laparoscopy), is changed in the ways of
changes.py: its light, noise and compression, the order and number of its frames, its field of view. The points that its
depths are compared with are changed alike. The recordings without truth are cut to parts of 100 frames, begun at every
30th frame, forwards and backwards. Runs that are there already are kept. Prints two tables.
"""
import csv
import json
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import yaml

from changes import CHANGES, Recording
from recordings import (chosen, depths, evaluated, first_map_cell, frames_of, parser_of, percent, print_table,
                        provisional_of, structure_from_motion, working_cell)

PART, STEP = 100, 30  # frames of a part, and between the beginnings of two
MIN_PART = 50  # frames of a part at the end of a recording


def video_images(path):
    video = cv2.VideoCapture(str(path))
    images = []
    while True:
        read, image = video.read()
        if not read:
            return images
        images.append(image)


def model_points(program, model):
    """Rows of frame, u, v and depth of a model of COLMAP whose images are named after their frames."""
    folder = model.parent.parent / "text"
    subprocess.run([program, "model", "convert", "--quiet", "--input_path", str(model), "--output_path", str(folder),
                    "--format", "text"], check=True)

    def lines(name):
        return [line.split() for line in (folder / name).read_text().splitlines() if not line.startswith("#")]

    position = {line[0]: np.array(line[1:4], float) for line in lines("points3D.txt") if line}
    rows, images = [], lines("images.txt")
    for image, points in zip(images[::2], images[1::2]):
        w, x, y, z = map(float, image[1:5])
        axis = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)])
        rows += [(int(Path(image[9]).stem), float(u) - 0.5, float(v) - 0.5,
                  axis @ position[point] + float(image[7]))
                 for u, v, point in zip(points[::3], points[1::3], points[2::3]) if point in position]
    return np.array(rows)


def opened(name, path, arguments):
    """A recording with the points that its depths are compared with; none where it has no such points."""
    camera = yaml.safe_load((path.parent / "camera.yaml").read_text())
    mask, points = None, np.empty((0, 4))
    if path.is_dir():
        images = [cv2.imread(str(image)) for image in sorted(path.iterdir())]
        mask = cv2.imread(str(path.parent / "mask.png"), cv2.IMREAD_GRAYSCALE)
        with open(path.parent / "sfm_points.csv", newline="", encoding="utf-8") as stream:
            points = np.array([[float(row[of]) for of in ("frame", "u_px", "v_px", "depth")]
                               for row in csv.DictReader(stream)])
    else:
        images = video_images(path)
        if name == "laparoscopy":
            folder = arguments.output_path / f"{name}_colmap"
            model = structure_from_motion(arguments.colmap, path, path.parent / "camera.yaml", folder)
            points = model_points(arguments.program, model) if model else points
    return Recording(images.__getitem__, len(images), tuple(camera["params"]), camera["fps"], mask, points)


def tracked(program, recording, folder):
    """Writes a recording and tracks it by default options, unless its run is there; its images are deleted again."""
    if (folder / "run.json").exists():
        return
    images = folder.with_name(f"{folder.name}_images")
    images.mkdir(parents=True, exist_ok=True)
    for k in range(recording.frames):
        cv2.imwrite(str(images / f"{k:06d}.png"), recording.image(k), [cv2.IMWRITE_PNG_COMPRESSION, 1])
    height, width = recording.image(0).shape[:2]
    camera = folder.with_name(f"{folder.name}_camera.yaml")
    camera.write_text(yaml.safe_dump({"model": "PINHOLE", "width": width, "height": height,
                                      "params": [float(value) for value in recording.params], "fps": recording.fps}))
    command = [program, "track", "--quiet", "--image_path", images, "--output_path", folder, "--camera", camera]
    if recording.mask is not None:
        mask = folder.with_name(f"{folder.name}_mask.png")
        cv2.imwrite(str(mask), recording.mask)
        command += ["--mask_path", mask]
    subprocess.run([str(part) for part in command], check=False, stderr=subprocess.DEVNULL)
    shutil.rmtree(images)


def changed_row(program, name, change, recording, folder):
    run = folder / f"{name}_{change.replace(' ', '_')}"
    tracked(program, recording, run)
    frames, mapped = frames_of(run)
    error = None
    if mapped:
        points = run.with_name(f"{run.name}_points.csv")
        np.savetxt(points, recording.points, "%d,%.4f,%.4f,%.7g", header="frame,u_px,v_px,depth", comments="")
        judged = evaluated(program, run, folder / "evaluations" / run.name, "--sfm_path", points)
        error = depths(judged.get("sfm"))
    summary = json.loads((run / "run.json").read_text())
    return [name, change, f"{len(mapped)} of {len(frames)}", str(provisional_of(frames)),
            mapped[0]["frame"] if mapped else "", working_cell(summary["working_image"]),
            first_map_cell(summary["first_map"]), percent(error and error[0]), percent(error and error[1])]


def parts(program, name, recording, folder):
    """A row of frames with a map in each part, forwards and backwards."""
    for direction, whole in (("forwards", recording), ("backwards", CHANGES["backwards"](recording))):
        counts = []  # frames, and those with a map, of each part
        for begin in range(0, whole.frames - MIN_PART + 1, STEP):
            run = folder / f"{name}_{direction}_{begin}"
            part = whole.in_order(range(begin, min(begin + PART, whole.frames)))
            tracked(program, part, run)
            counts.append([len(rows) for rows in frames_of(run)])
        frames, mapped = map(sum, zip(*counts))
        yield [name, direction, *(f"{of} of {all_of}" for all_of, of in counts), percent(mapped / frames, 0)]


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--changes", default=",".join(CHANGES))
    arguments = parser.parse_args()
    folder = arguments.output_path
    folder.mkdir(parents=True, exist_ok=True)
    rows, part_rows = [], []
    for name, path, _ in chosen(arguments):
        recording = opened(name, path, arguments)
        if len(recording.points) == 0:
            part_rows += parts(arguments.program, name, recording, folder)
            continue
        for change in arguments.changes.split(","):
            rows.append(changed_row(arguments.program, name, change, CHANGES[change](recording), folder))
            print(" ".join(rows[-1]), file=sys.stderr)
    if rows:
        print_table(["recording", "change", "frames with a map", "provisional", "first", "scale, smoothing, patch",
                     "first map: sigma of spread", "depth error", "null"], rows)
        found = [float(row[-2].split()[0]) for row in rows if row[-2]]
        if found:
            print(f"\nMedian of {len(found)} depth errors: {statistics.median(found):.1f} %.")
    if part_rows:
        begins = range(0, STEP * (len(part_rows[0]) - 3), STEP)
        print_table(["recording", "direction", *(f"from {begin}" for begin in begins), "all"], part_rows)
    return 0 if rows or part_rows else 1


if __name__ == "__main__":
    sys.exit(main())
