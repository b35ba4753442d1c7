#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What default options give on the real recordings that are there, with truth and without.

    recordings.py --program build/release/pliant --output_path RUNS [--recordings DIR] [--only NAME,...]
                  [--colmap PROGRAM --sfm NAME,...]

Runs that are there already are kept. For the recordings of --sfm, which have no truth, COLMAP reconstructs every fifth
frame, and its points are what depths are compared with. Prints three tables: the runs; how far runs of one recording
that were begun at other frames, at a lower frame rate, with half of the corners, another seed or another focal length,
agree; and the same of the runs begun at other frames after pliant refine. The figures are those of pliant evaluate.
"""
import argparse
import csv
import itertools
import json
import statistics
import subprocess
import sys
from pathlib import Path

import cv2
import yaml

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from clips import CLIPS, RECORDINGS  # noqa: E402

# frames between the first frames of the variants
STEPS = {"nasal": 2, "laparoscopy": 20, "instruments": 10, "gallbladder": 50}
AS_IT_IS = "as it is"  # the variant that the others are compared with
COVERAGES = ("coverage", "followed_coverage")  # of points of the map, and with those that are only followed
CALIBRATIONS = {"laparoscopy": "laparoscopy/camera.yaml"}


def evaluated(program, run, output_path, *arguments):
    """The evaluation.json that pliant evaluate leaves; empty where it cannot compare."""
    command = [program, "evaluate", "--quiet", "--run", run, "--output_path", output_path, *arguments]
    if subprocess.run([str(part) for part in command], check=False).returncode != 0:
        return {}
    return json.loads((output_path / "evaluation.json").read_text())


def depths(compared):
    """Difference, null and frames of depths that were compared, or nothing."""
    if not compared or "estimate" not in compared:
        return None
    return tuple(compared[side]["median_relative_depth"] for side in ("estimate", "null")) + (
        compared["frames_compared"],)


def path_error(evaluation):
    """Root mean square of the camera's error after the best similarity, by the length of the true path."""
    path = evaluation.get("trajectory")
    return path["ate_rmse_mm"] / path["true_path_length_mm"] if path else None


def variants(name, images, step, folder):
    yield AS_IT_IS, ""
    for k in (1, 2, 3):
        yield f"begun at {k * step}", f"--start {k * step}"
    yield "every 2nd frame", "--stride 2"
    yield "every 3rd frame", "--stride 3"
    yield "half of the corners", "--Corners.max_corners 250"
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


def percent(value, digits=1):
    return "" if value is None else f"{100 * value:.{digits}f} %"


def parser_of(documentation):
    """The options that the scripts of this folder share."""
    parser = argparse.ArgumentParser(description=documentation, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", required=True)
    parser.add_argument("--output_path", required=True, type=Path)
    parser.add_argument("--recordings", default=RECORDINGS, type=Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--colmap", default="colmap")
    return parser


def chosen(arguments):
    """Name, images and other arguments of pliant of each recording that is there and asked for."""
    for name, (images, options) in CLIPS.items():
        images = arguments.recordings / images
        if images.exists() and (not arguments.only or name in arguments.only.split(",")):
            yield name, images, options.format(arguments.recordings).split()


def frames_of(run):
    """The rows of frames.csv, and those of them that have a map."""
    with open(run / "frames.csv", newline="", encoding="utf-8") as stream:
        frames = list(csv.DictReader(stream))
    return frames, [row for row in frames if row["state"] in ("tracking", "provisional")]


def provisional_of(frames):
    return sum(row["state"] == "provisional" for row in frames)


def working_cell(working):
    return f"{working['scale']:.2f}, {working['smoothing_px']:.1f}, {working['patch_size']}"


def first_map_cell(first_map):
    if not first_map:
        return ""
    return f"{first_map['model']}, {percent(first_map['depth_sigma'])} of {percent(first_map['depth_spread'])}"


def print_table(head, rows):
    print("\n| " + " | ".join(head) + " |\n|" + " --- |" * len(head))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def refined(program, run):
    """The folder of the run after pliant refine with default options; none where it cannot be refined."""
    folder = run.with_name(f"{run.name}_refined")
    if not (folder / "run.json").exists():
        command = [program, "refine", "--quiet", "--run", run, "--output_path", folder]
        if subprocess.run([str(part) for part in command], check=False, stderr=subprocess.DEVNULL).returncode != 0:
            return None
    return folder


def structure_from_motion(colmap, video, calibration, folder):
    """The largest of COLMAP's models of every fifth frame of a video, with its calibration; none where it has none."""
    images, models = folder / "images", folder / "models"
    if not models.exists():
        images.mkdir(parents=True)
        models.mkdir()
        frames = cv2.VideoCapture(str(video))
        for number in itertools.takewhile(lambda _: frames.grab(), itertools.count()):
            if number % 5 == 0:
                cv2.imwrite(str(images / f"{number:06d}.png"), frames.retrieve()[1])
        camera = yaml.safe_load(calibration.read_text())
        database = ["--database_path", folder / "database.db"]
        held = [f"--Mapper.ba_refine_{what}=0" for what in ("focal_length", "principal_point", "extra_params")]
        for command in (["feature_extractor", *database, "--image_path", images, "--ImageReader.single_camera=1",
                         f"--ImageReader.camera_model={camera['model']}", "--SiftExtraction.use_gpu=0",
                         f"--ImageReader.camera_params={','.join(map(str, camera['params']))}"],
                        ["exhaustive_matcher", *database, "--SiftMatching.use_gpu=0"],
                        ["mapper", *database, "--image_path", images, "--output_path", models, *held]):
            with open(folder / f"{command[0]}.log", "w", encoding="utf-8") as log:
                subprocess.run([colmap, *map(str, command)], check=False, stdout=log, stderr=log)
    return max(models.iterdir(), key=lambda model: (model / "images.bin").stat().st_size, default=None)


def judgment(program, run, first, images, model, evaluations):
    """Depth error and ATE of a run against the truth or a model of COLMAP, and how far its depths are from those of
    another run."""
    judged, agreed = {}, None
    if run and model:
        judged = evaluated(program, run, evaluations / run.name, "--sequence", images, "--sfm_path", model)
    if run and (images.parent / "groundtruth.txt").exists():
        judged = evaluated(program, run, evaluations / run.name, "--sequence", images.parent)
    if run and first and run != first:
        compared = evaluated(program, first, evaluations / f"{run.name}_compared", "--other_run", run)
        agreed = depths(next(iter(compared.get("consistency", [])), None))
    return depths(judged.get("sfm")), path_error(judged), agreed


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--sfm", default="", help="recordings that COLMAP reconstructs")
    arguments = parser.parse_args()
    arguments.output_path.mkdir(parents=True, exist_ok=True)
    rows, agreements, refinements = [], [], []
    evaluations = arguments.output_path / "evaluations"
    for name, images, options in chosen(arguments):
        model = None
        if name in arguments.sfm.split(","):
            model = structure_from_motion(arguments.colmap, images, images.parent / "camera.yaml",
                                          arguments.output_path / f"{name}_colmap")
        first = first_after = None
        for variant, change in variants(name, images, STEPS[name], arguments.output_path):
            folder = arguments.output_path / f"{name}_{variant.replace(' ', '_')}"
            if not (folder / "run.json").exists():
                command = [arguments.program, "track", "--quiet", "--image_path", images, "--output_path", folder,
                           *options, *change.split()]
                subprocess.run([str(part) for part in command], check=False, stderr=subprocess.DEVNULL)
            frames, tracked = frames_of(folder)
            points = [int(row["optimized"]) for row in tracked]
            summary = json.loads((folder / "run.json").read_text())
            working = summary["working_image"]
            run = folder if tracked else None
            if variant == AS_IT_IS:
                first, first_after = run, None
            error, ate, agreed = judgment(arguments.program, run, first, images, model, evaluations)
            rows.append([name, variant, f"{len(tracked)} of {len(frames)}", str(provisional_of(frames)),
                         tracked[0]["frame"] if tracked else "", str(len({row["submap"] for row in tracked})),
                         f"{statistics.median(points):.0f}" if points else "",
                         *(percent(summary["medians"][of]) if tracked else "" for of in COVERAGES),
                         working_cell(working), f"{working['track_noise_px']:.2f} px",
                         first_map_cell(summary["first_map"]),
                         percent(error and error[0]), percent(error and error[1]), percent(ate)])
            if agreed:
                agreements.append([name, variant, str(agreed[2]), percent(agreed[0]), percent(agreed[1])])
            if not run or not (variant == AS_IT_IS or variant.startswith("begun at")):
                continue
            after = refined(arguments.program, run)
            if variant == AS_IT_IS:
                first_after = after
            error_after, ate_after, agreed_after = judgment(arguments.program, after, first_after, images, model,
                                                            evaluations)
            values = (error and error[0], error_after and error_after[0], ate, ate_after, agreed and agreed[0],
                      agreed_after and agreed_after[0])
            refinements.append([name, variant, *(percent(value, 2) for value in values)])
    for head, body in ((["recording", "variant", "frames with a map", "provisional", "first", "submaps", "points",
                         "coverage", "followed", "scale, smoothing, patch", "track noise", "first map: sigma of spread",
                         "depth error", "null", "ATE"], rows),
                       (["recording", "compared with", "frames", "depths differ", "spread of the depths"], agreements),
                       (["recording", "variant", "depth error", "refined", "ATE", "refined", "depths differ",
                         "refined"], refinements)):
        print_table(head, body)
    return 0 if rows else 1


if __name__ == "__main__":
    sys.exit(main())
