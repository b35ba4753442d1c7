#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What do images as an endoscope records them cost?

    accuracy.py --program build/release/pliant --output_path RESULTS [--seed N] [--only NAME,...]

Simulates every scene as the presets `clean` and `endoscope` record it, tracks it with default options, and prints a
table. What is there already is kept.
"""
import argparse
import csv
import json
import subprocess
from collections import Counter
from pathlib import Path

SURFACE = "--Scene.kind surface"
HOLD = "--Trajectory.kind hold --Trajectory.tremor_mm 0 --Trajectory.tremor_deg 0"

# name: options of pliant simulate
SCENES = {
    "colon, rigid": "",
    "colon, A = 2.5, omega 2.5": "--Deformation.amplitude_mm 2.5",
    "colon, A = 5, omega 5": "--Deformation.amplitude_mm 5 --Deformation.omega_rad_s 5",
    "colon, wave of 105 mm, A = 2.5": "--Trajectory.speed_mm_s 8 --Deformation.amplitude_mm 2.5"
                                     " --Deformation.wavelength_mm 105",
    "colon, breath": "--Deformation.breathing_mm 2",
    "colon, 446 px, A = 5, omega 5": "--Camera.width 446 --Camera.height 446 --Deformation.amplitude_mm 5"
                                     " --Deformation.omega_rad_s 5",
    "surface, loop, breath": f"--Trajectory.kind loop {SURFACE} --Deformation.breathing_mm 2",
    "surface, sway, wave of 150 mm": f"--Trajectory.kind sway {SURFACE} --Deformation.amplitude_mm 3"
                                     " --Deformation.wavelength_mm 150",
    "lobes, sway": "--Trajectory.kind sway --Scene.kind lobes --Deformation.amplitude_mm 3",
    "still camera, surface, poke": f"{HOLD} {SURFACE} --Deformation.poke_mm 8",
    "still camera, colon, breath": f"{HOLD} --Deformation.breathing_mm 2 --Deformation.breathing_period_s 2",
    "still camera, surface, wave of 100 mm": f"{HOLD} {SURFACE} --Deformation.amplitude_mm 3"
                                             " --Deformation.wavelength_mm 100",
}


def call(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True)


def result(program, folder, options, realism, seed):
    sequence, run, evaluation = folder / "sequence", folder / "run", folder / "evaluation"
    if not (sequence / "groundtruth.txt").exists():
        made = call(program, "simulate", "--quiet", "-o", sequence, "--realism", realism, "--Scene.seed", seed,
                    *options.split())
        if made.returncode != 0:
            raise SystemExit(made.stderr)
    if not (run / "run.json").exists():
        call(program, "track", "--quiet", "-o", run, "--image_path", sequence)
    with open(run / "frames.csv", encoding="utf-8") as file:
        states = Counter(row["state"] for row in csv.DictReader(file))
    with_map = states["tracking"] + states["provisional"]
    text = f"{with_map} of {sum(states.values())}"
    if states["provisional"]:
        text += f" ({states['provisional']} provisional)"
    if with_map == 0:
        return [text, "", ""]
    if not (evaluation / "evaluation.json").exists():
        call(program, "evaluate", "--run", run, "--sequence", sequence, "-o", evaluation)
    with open(evaluation / "evaluation.json", encoding="utf-8") as file:
        surface = json.load(file)["surface"]
    estimate, null = (100 * surface[who]["median_relative_depth"] for who in ("estimate", "null"))
    return [text, f"{estimate:.1f} %", f"{null:.1f} %"]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", type=Path, required=True)
    parser.add_argument("--output_path", type=Path, required=True)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    only = [name for name in arguments.only.split(",") if name]
    print("| scene | clean: frames with a map | depth error | null | endoscope: frames with a map | depth error | null |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    for number, (name, options) in enumerate(SCENES.items()):
        if only and not any(part in name for part in only):
            continue
        row = [name]
        for realism in ("clean", "endoscope"):
            folder = arguments.output_path / f"seed{arguments.seed}" / f"{number}_{realism}"
            folder.mkdir(parents=True, exist_ok=True)
            row += result(arguments.program, folder, options, realism, arguments.seed)
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()
