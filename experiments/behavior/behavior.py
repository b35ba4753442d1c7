#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""Shows that a change of the code changes no result: runs of two programs, compared byte for byte.

    behavior.py record  --program PROGRAM --sequences DIR --output_path RUNS [--cases NAME,...]
    behavior.py compare RUNS OTHER_RUNS

`record` renders the sequences that are not there yet (always with the program that is given first, so record the old
program first) and tracks them with --General.timings none. `compare` exits with 1 where any file differs. Names that
were changed on purpose (options, columns, states, losses) are mapped by renames.yaml; notes are sentences, and the
program's version and command line are not results: these are not compared.
"""
import argparse
import csv
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import yaml

HERE = Path(__file__).resolve().parent
RECORDINGS = Path(os.environ.get("PLIANT_RECORDINGS", HERE.parents[2] / "shared" / "data"))

INTERRUPTED = "--Interruption.blackout_period_s 4 --Interruption.tool_period_s 6.3 --Interruption.blur_period_s 2.9"
SEQUENCES = {
    "demo": "--Trajectory.frames 60 --Deformation.amplitude_mm 2",
    "insertion": f"--Trajectory.frames 600 --Deformation.amplitude_mm 2.5 {INTERRUPTED}",
    "passage": "--Trajectory.frames 200 --Trajectory.speed_mm_s 24",
    "stereo": "--Trajectory.frames 40 --Deformation.amplitude_mm 2.5 --Camera.baseline_mm 4",
    "fisheye": "--Trajectory.frames 80 --Deformation.amplitude_mm 2.5 --Camera.model OPENCV_FISHEYE",
}

# A camera that goes forward, is suddenly elsewhere, and comes back: maps that are left, begun and joined.
FORWARD_THEN_BACK = list(range(0, 50)) + list(range(130, -1, -1))

# name: sequence, options of `pliant track`
CASES = {
    "demo": ("demo", ""),
    "insertion": ("insertion", ""),
    "joined": ("joined", ""),
    "stereo": ("stereo", "--Init.method stereo"),
    "depth": ("stereo", "--Init.method depth"),
    "fisheye": ("fisheye", ""),
    "gated": ("passage", "--Init.method gated --end 90"),
    "paper": ("demo", "--preset paper"),
    "colmap_model": ("demo", "--Init.method colmap_model --Init.model_path demo/sparse"),  # of the case above
    "window": ("passage", "--Init.method window --end 90"),
    "late_start": ("passage", "--start 30 --end 90 --Tracking.camera_motion free"),
    "laparoscopy": (RECORDINGS / "laparoscopy" / "endo.mp4", ""),
}


def run(command, folder=None):
    print(" ".join(str(part) for part in command), flush=True)
    subprocess.run([str(part) for part in command], check=True, cwd=folder)


def render(program, folder, name):
    sequence = folder / name
    if (sequence / "done").exists():
        return sequence
    if name == "joined":
        rearrange(render(program, folder, "passage"), sequence)
    else:
        run([program, "simulate", "--quiet", "--output_path", sequence, *SEQUENCES[name].split()])
    (sequence / "done").touch()
    return sequence


def rearrange(source, sequence):
    (sequence / "images").mkdir(parents=True, exist_ok=True)
    shutil.copy(source / "camera.yaml", sequence)
    for idx, frame in enumerate(FORWARD_THEN_BACK):
        shutil.copy(source / "images" / f"{frame:06d}.png", sequence / "images" / f"{idx:06d}.png")


def record(arguments):
    program, sequences, output = (Path(path).resolve() for path in
                                  (arguments.program, arguments.sequences, arguments.output_path))
    output.mkdir(parents=True, exist_ok=True)
    wanted = arguments.cases.split(",") if arguments.cases else list(CASES)
    for name in wanted:
        source, options = CASES[name]
        if isinstance(source, Path):
            if not source.exists():
                print(f"{name}: there is no {source}: left out")
                continue
            path = source
        else:
            path = render(program, sequences, source)
        run([program, "track", "--quiet", "--image_path", path, "--output_path", name, "--General.timings", "none",
             *options.split()], output)


def renamed(names, name):
    return names.get(name, name)


def normalized_config(path, names):
    groups = yaml.safe_load(path.read_text())
    options = {f"{group}.{key}": value for group, keys in groups.items() for key, value in (keys or {}).items()}
    return {renamed(names["options"], key): renamed(names["values"], value) if isinstance(value, str) else value
            for key, value in options.items()}


def normalized_summary(path, names):
    summary = json.loads(path.read_text())
    for key in ("version", "command_line", "note"):
        summary.pop(key, None)
    losses = summary["counts"].get("losses", {})
    summary["counts"]["losses"] = {renamed(names["losses"], key): count for key, count in losses.items()}
    stages = summary.get("timings", {}).get("mean_ms", {})
    if stages:
        summary["timings"]["mean_ms"] = {renamed(names["columns"], f"ms_{key}"): ms for key, ms in stages.items()}
        summary["timings"]["mean_ms"] = {key.removeprefix("ms_"): ms
                                         for key, ms in summary["timings"]["mean_ms"].items()}
    return summary


def normalized_frames(path, names):
    with open(path, newline="") as stream:
        rows = list(csv.reader(stream))
    rows[0] = [renamed(names["columns"], column) for column in rows[0]]
    state = rows[0].index("state")
    for row in rows[1:]:
        row[state] = renamed(names["states"], row[state])
    return rows


NORMALIZED = {"config.yaml": normalized_config, "run.json": normalized_summary, "frames.csv": normalized_frames}


def contents(path, names):
    return NORMALIZED[path.name](path, names) if path.name in NORMALIZED else path.read_bytes()


def compare(arguments):
    old, new = Path(arguments.old), Path(arguments.new)
    names = {key: value or {} for key, value in yaml.safe_load((HERE / "renames.yaml").read_text()).items()}
    relative = {path.relative_to(old) for path in old.rglob("*") if path.is_file()}
    cases = {path.parts[0] for path in relative}
    relative |= {path.relative_to(new) for path in new.rglob("*")
                 if path.is_file() and path.relative_to(new).parts[0] in cases}
    differing = []
    for path in sorted(relative):
        if not (old / path).exists() or not (new / path).exists():
            differing.append(f"{path}: only in one of the two")
        elif contents(old / path, names) != contents(new / path, names):
            differing.append(str(path))
    for line in differing:
        print(line)
    print(f"{len(relative)} files of {len(cases)} runs compared, {len(differing)} differ")
    return 1 if differing or not relative else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    recorder = commands.add_parser("record")
    recorder.add_argument("--program", required=True)
    recorder.add_argument("--sequences", required=True)
    recorder.add_argument("--output_path", required=True)
    recorder.add_argument("--cases", default="")
    comparer = commands.add_parser("compare")
    comparer.add_argument("old")
    comparer.add_argument("new")
    arguments = parser.parse_args()
    return record(arguments) if arguments.command == "record" else compare(arguments)


if __name__ == "__main__":
    sys.exit(main())
