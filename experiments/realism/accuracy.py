#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Pliant authors
# SPDX-License-Identifier: BSD-3-Clause
"""What do images as an endoscope records them cost?

    accuracy.py --program build/release/pliant --output_path RESULTS [--seed N] [--only NAME,...]

Simulates every scene as the presets `clean` and `endoscope` record it, tracks it with default options, and prints a
table. What is there already is kept.
"""
import argparse
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "common"))
from scenes import HOLD, SURFACE, call, depth_errors, frames_with_a_map, states_of  # noqa: E402

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


def result(program, folder, options, realism, seed):
    sequence, run = folder / "sequence", folder / "run"
    if not (sequence / "groundtruth.txt").exists():
        made = call(program, "simulate", "--quiet", "--overwrite", "-o", sequence, "--realism", realism, "--Scene.seed", seed,
                    *options.split())
        if made.returncode != 0:
            raise SystemExit(made.stderr)
    if not (run / "run.json").exists():
        call(program, "track", "--quiet", "-o", run, "--image_path", sequence)
    states = states_of(run)
    with_map = frames_with_a_map(states)
    text = f"{with_map} of {sum(states.values())}"
    if states["provisional"]:
        text += f" ({states['provisional']} provisional)"
    return [text, *(depth_errors(program, run, sequence) if with_map else ("", ""))]


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
